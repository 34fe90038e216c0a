#include "render/film/race.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "formats/rollout/ending.h"
#include "libevo/base/error.h"
#include "render/figures/key.h"
#include "render/figures/label.h"
#include "render/scene/camera.h"
#include "render/scene/projection.h"

namespace evo::render {
namespace {

void check(const std::vector<Episode>& episodes) {
  constexpr std::size_t letters = 26;
  if (episodes.size() < 2 || episodes.size() > letters)
    throw error(Failure::usage, "a race needs 2 to {} episodes, but {} were given", letters,
                episodes.size());
  for (const Episode& episode : episodes)
    if (episode.rollout->task != episodes.front().rollout->task)
      throw error(Failure::usage,
                  "robots race in one world, but {} is of the task {}, {} of the task {}",
                  episodes.front().label, episodes.front().rollout->task, episode.label,
                  episode.rollout->task);
}

const Clip& longest(const std::vector<Clip>& clips) {
  return *std::ranges::max_element(clips, {}, &Clip::steps);
}

// At every step, around what the camera keeps in view of any of them.
std::vector<Bounds> boxes(const std::vector<Clip>& clips, const Camera& camera) {
  std::vector<Bounds> all(static_cast<std::size_t>(longest(clips).steps()) + 1);
  for (const Clip& clip : clips) {
    const std::vector<Bounds> own = clip.boxes(camera);
    for (std::size_t t = 0; t < all.size(); ++t) all[t].cover(own[std::min(t, own.size() - 1)]);
  }
  return all;
}

// Where the task ends an episode with a reward, x in voxels.
std::optional<double> finish_of(const Rollout& rollout) {
  const auto rules = task_value(rollout, "rules");
  if (!rules || !rules->is_sequence()) return std::nullopt;
  for (const Node& rule : rules->items()) {
    const auto reward = rule.find("reward");
    const auto when = rule.find("when");
    if (!reward || !when || !when->is_sequence() || !(reward->number() > 0)) continue;
    for (const Node& condition : when->items()) {
      const auto position = condition.find("position");
      const auto axis = position ? position->find("axis") : std::nullopt;
      const auto above = position ? position->find("above") : std::nullopt;
      if (axis && axis->string() == "x" && above) return above->number();
    }
  }
  return std::nullopt;
}

std::string place_name(int place) {
  constexpr std::array first{"1st", "2nd", "3rd"};
  return place <= 3 ? first[static_cast<std::size_t>(place - 1)] : fmt::format("{}th", place);
}

}  // namespace

double Race::Runner::so_far(double step) const {
  return returns[std::min(static_cast<std::size_t>(step), returns.size() - 1)];
}

Race::Race(const std::vector<Episode>& episodes, const RenderOptions& options) : options_(options) {
  check(episodes);
  task_ = episodes.front().rollout->task;
  heights_ = rewards_height(*episodes.front().rollout);
  const bool lanes = in_lanes(episodes.size());
  // A lane has room for a robot and a voxel below and above, not for the sky.
  constexpr double closer = 3.0;
  if (lanes) options_.camera.zoom *= closer;
  const double aspect = static_cast<double>(options.size.width) *
                        (lanes ? static_cast<double>(episodes.size()) : 1.0) /
                        static_cast<double>(options.size.height);
  for (const Episode& episode : episodes) {
    const Clip whole(episode, options_, aspect);  // says what is wrong with a file
    Runner runner{std::string(1, static_cast<char>('A' + runners_.size())),
                  runner_color(runners_.size()),
                  episode.label,
                  {},
                  {},
                  0};
    for (int step = 0; step <= whole.steps(); ++step) runner.returns.push_back(whole.score(step));
    runners_.push_back(std::move(runner));
    clips_.push_back(whole);
  }
  find_finish(episodes);
  rank();
  share_value_scale(clips_);
  views_ = camera_path(boxes(clips_, options_.camera), options_.camera, aspect);
}

// A runner has arrived once its robot's centre is there, which ends its episode.
void Race::find_finish(const std::vector<Episode>& episodes) {
  finish_ = finish_of(*episodes.front().rollout);
  if (!finish_) return;
  for (std::size_t k = 0; k < runners_.size(); ++k)
    if (clips_[k].over() && clips_[k].centre(clips_[k].steps()).x > *finish_ - 1)
      runners_[k].arrived = clips_[k].steps();
}

// Those that arrived first, the others by their returns; equals share a place.
void Race::rank() {
  std::vector<Runner*> order;
  for (Runner& runner : runners_) order.push_back(&runner);
  const auto better = [](const Runner* a, const Runner* b) {
    constexpr int never = std::numeric_limits<int>::max();
    const int first = a->arrived.value_or(never);
    const int second = b->arrived.value_or(never);
    if (first != second) return first < second;
    return !a->arrived && a->returns.back() > b->returns.back();
  };
  std::ranges::stable_sort(order, better);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool tied = k > 0 && !better(order[k - 1], order[k]);
    order[k]->place = tied ? order[k - 1]->place : static_cast<int>(k) + 1;
  }
}

// Side by side where they run along the ground and each lane is high enough to see a robot.
bool Race::in_lanes(std::size_t runners) const {
  constexpr int lowest = 60;  // pixels
  return !heights_ && options_.size.height / static_cast<int>(runners) >= lowest;
}

// The same part of the track for all: from left to right as far as the whole race is seen.
void Race::draw_lane(std::size_t k, double step, const Rect& lane, Typesetter& typesetter,
                     Drawing& drawing) const {
  const Theme& theme = theme_by_name(options_.theme);
  const Runner& runner = runners_[k];
  Scene scene = clips_[k].scene(step);
  const ViewRect track = view_at(views_, step);
  // From where the lane's own camera, which follows the robot up stairs and hills, begins.
  const double low = scene.view.centre_y - scene.view.height / 2;
  scene.view = {track.centre_x, low + track.height / 2, track.width, track.height};
  scene.finish = finish_;
  scene.outlines.assign(clips_[k].mesh().objects.size(), runner.color);
  draw_scene(scene, theme, lane, drawing);
  drawing.clip(lane);
  drawing.segment({lane.x, lane.y + lane.height}, {lane.x + lane.width, lane.y + lane.height}, 2,
                  theme.paper);
  drawing.clip(drawing.whole());
  if (!options_.overlays.labels) return;
  const float size = std::clamp(0.13F * lane.height, 9.0F, 20.0F);
  const bool over = step >= clips_[k].steps();
  const bool arrived = runner.arrived && over;
  const bool decided = step >= steps();
  std::string result = signed_score(runner.so_far(step));
  if (arrived) result = fmt::format("{:.2f} s", clips_[k].seconds(*runner.arrived));
  if (arrived || decided) result = place_name(runner.place) + "   " + result;
  const float y = lane.y + 1.75F * size;
  const auto plate = [&](float x, float width) {
    drawing.rounded_rectangle({x, y - 1.2F * size, width, 1.7F * size}, 0.4F * size, theme.label);
  };
  const Rect badge{lane.x + 0.7F * size, y - 1.1F * size, 1.5F * size, 1.5F * size};
  const float name = typesetter.width(runner.name, size);
  plate(badge.x - 0.2F * size, 2.7F * size + name);
  drawing.rounded_rectangle(badge, 0.35F * size, runner.color);
  drawing.text({badge.x + badge.width / 2, y}, size, runner.letter, ink_on(runner.color),
               Align::centre, true);
  drawing.text({badge.x + 2.0F * size, y}, size, runner.name, theme.text);
  // Beside the name: at the right, robots come in.
  const float left = badge.x + 3.5F * size + name;
  plate(left - 0.4F * size, typesetter.width(result, size, true) + 0.8F * size);
  drawing.text({left, y}, size, result, theme.text, Align::left, true);
}

Drawing Race::frame(double step, Typesetter& typesetter) const {
  const Theme& theme = theme_by_name(options_.theme);
  Drawing drawing(options_.size);
  if (in_lanes(runners_.size())) {
    const auto count = static_cast<float>(runners_.size());
    const Rect whole = drawing.whole();
    for (std::size_t k = 0; k < runners_.size(); ++k) {
      const float top = std::round(whole.height * static_cast<float>(k) / count);
      const float end = std::round(whole.height * static_cast<float>(k + 1) / count);
      draw_lane(k, step, {0, top, whole.width, end - top}, typesetter, drawing);
    }
    return drawing;
  }
  const Rect ranking = ranking_plate(typesetter);
  Scene scene;
  std::vector<Note> letters;
  for (std::size_t k = clips_.size(); k-- > 0;) {  // the first one in front
    scene = clips_[k].scene(step);
    scene.view = view_at(views_, step);
    scene.outlines.assign(clips_[k].mesh().objects.size(), runners_[k].color);
    scene.backdrop = k + 1 == clips_.size();
    scene.heights = heights_ && k == 0;
    scene.goal.reset();
    if (options_.overlays.labels) {
      scene.captions = ranking.y + ranking.height;
      const ModelObject& robot = clips_[k].mesh().objects.front();
      constexpr double above = 1.1;  // voxels
      Vec2 top{0, scene.points[static_cast<std::size_t>(robot.first_point)].y};
      for (int p = robot.first_point; p < robot.first_point + robot.points; ++p) {
        top.x += scene.points[static_cast<std::size_t>(p)].x / robot.points;
        top.y = std::max(top.y, scene.points[static_cast<std::size_t>(p)].y);
      }
      letters.insert(letters.begin(),
                     {{top.x, top.y + above}, runners_[k].letter, runners_[k].color});
    }
    if (k == 0) scene.tags = letters;
    draw_scene(scene, theme, drawing.whole(), drawing);
  }
  if (!options_.overlays.labels) return drawing;
  Caption caption;
  caption.moment = longest(clips_).caption(step).moment;
  draw_caption(caption, theme, drawing.whole(), typesetter, drawing);
  draw_ranking(step, ranking, drawing);
  draw_key(scene, theme, drawing.whole(), 1, typesetter, drawing);
  return drawing;
}

namespace {

// Measures of the ranking, shares of the size of its text.
constexpr float ranking_margin = 0.75F;
constexpr float ranking_line = 1.5F;
constexpr float ranking_names = 2.2F;  // from letters to names

float ranking_size(const Rect& whole) { return std::max(8.0F, label_size(whole)); }

}  // namespace

// As wide as its widest moment, so that it stands still.
Rect Race::ranking_plate(Typesetter& typesetter) const {
  const float size = ranking_size(Drawing(options_.size).whole());
  float names = typesetter.width(task_, size, true);
  float scores = 0;
  for (const Runner& runner : runners_) {
    names = std::max(names, ranking_names * size + typesetter.width(runner.name, size, false));
    for (const double so_far :
         {*std::ranges::min_element(runner.returns), *std::ranges::max_element(runner.returns)})
      scores = std::max(scores, typesetter.width(signed_score(so_far), size, true));
  }
  return {0.8F * size, 0.8F * size, 2 * ranking_margin * size + names + 1.5F * size + scores,
          ranking_line * size * static_cast<float>(runners_.size() + 1) + 0.8F * size};
}

void Race::draw_ranking(double step, const Rect& plate, Drawing& drawing) const {
  const Theme& theme = theme_by_name(options_.theme);
  std::vector<const Runner*> order;
  for (const Runner& runner : runners_) order.push_back(&runner);
  std::stable_sort(order.begin(), order.end(), [&](const Runner* a, const Runner* b) {
    return a->so_far(step) > b->so_far(step);
  });
  const float size = ranking_size(drawing.whole());
  drawing.rounded_rectangle(plate, 0.5F * size, theme.label);
  const float left = plate.x + ranking_margin * size;
  float y = plate.y + 0.25F * size + ranking_line * size * 0.85F;
  drawing.text({left, y}, size, task_, theme.text, Align::left, true);
  for (const Runner* runner : order) {
    y += ranking_line * size;
    const Rect badge{left - 0.2F * size, y - 1.02F * size, 1.3F * size, 1.3F * size};
    drawing.rounded_rectangle(badge, 0.35F * size, runner->color);
    drawing.text({badge.x + badge.width / 2, y}, 0.9F * size, runner->letter, ink_on(runner->color),
                 Align::centre, true);
    drawing.text({left + ranking_names * size, y}, size, runner->name, theme.text_muted);
    drawing.text({plate.x + plate.width - ranking_margin * size, y}, size,
                 signed_score(runner->so_far(step)), theme.text, Align::right, true);
  }
}

}  // namespace evo::render
