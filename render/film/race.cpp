#include "render/film/race.h"

#include <algorithm>
#include <numeric>

#include "formats/task/yaml.h"
#include "libevo/base/error.h"
#include "render/figures/key.h"
#include "render/painters/label.h"

namespace evo::render {
namespace {

const RolloutEpisode& recorded(const Episode& episode) {
  const auto& all = episode.rollout->episodes;
  if (episode.index < 0 || static_cast<std::size_t>(episode.index) >= all.size())
    throw error(Failure::usage, "there is no episode {}: the rollout has {}", episode.index,
                all.size());
  return all[static_cast<std::size_t>(episode.index)];
}

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

// One object of one of the episodes.
struct Part {
  const Episode* episode = nullptr;
  std::size_t object = 0;
};

// All robots in front, then what else moves, of each its own; the terrain of the first.
std::vector<Part> parts(const std::vector<Episode>& episodes) {
  std::vector<Part> robots, things;
  for (const Episode& episode : episodes) {
    const auto& objects = episode.rollout->world.objects;
    for (std::size_t k = 0; k < objects.size(); ++k) {
      if (k == 0)
        robots.push_back({&episode, k});
      else if (!objects[k].is_static || &episode == &episodes.front())
        things.push_back({&episode, k});
    }
  }
  robots.insert(robots.end(), things.begin(), things.end());
  return robots;
}

Rollout merge(const std::vector<Episode>& episodes) {
  Rollout merged;
  merged.task = episodes.front().rollout->task;
  const std::vector<Part> all = parts(episodes);
  RolloutWorld& world = merged.world;
  for (const Part& part : all) {
    const RolloutWorld& from = part.episode->rollout->world;
    ModelObject object = from.objects[part.object];
    const int shift = merged.points - object.first_point;
    for (int c = object.first_cell; c < object.first_cell + object.cells; ++c) {
      ModelCell cell = from.cells[static_cast<std::size_t>(c)];
      cell.object = static_cast<int>(world.objects.size());
      for (int& point : cell.points) point += shift;
      world.cells.push_back(cell);
    }
    object.first_point = merged.points;
    object.first_cell = static_cast<int>(world.cells.size()) - object.cells;
    merged.points += object.points;
    world.objects.push_back(std::move(object));
  }
  RolloutEpisode& episode = merged.episodes.emplace_back();
  int steps = 0;
  for (const Episode& each : episodes) steps = std::max(steps, recorded(each).steps());
  episode.rewards.resize(static_cast<std::size_t>(steps));
  for (int step = 0; step <= steps; ++step)
    for (const Part& part : all) {
      const RolloutEpisode& own = recorded(*part.episode);
      const ModelObject& object = part.episode->rollout->world.objects[part.object];
      const auto first =
          own.positions.begin() +
          static_cast<std::ptrdiff_t>(std::min(step, own.steps())) * part.episode->rollout->points +
          object.first_point;
      episode.positions.insert(episode.positions.end(), first, first + object.points);
    }
  return merged;
}

}  // namespace

double Race::Runner::so_far(double step) const {
  return returns[std::min(static_cast<std::size_t>(step), returns.size() - 1)];
}

Race::Race(const std::vector<Episode>& episodes, const RenderOptions& options) : options_(options) {
  check(episodes);
  const double aspect =
      static_cast<double>(options.size.width) / static_cast<double>(options.size.height);
  for (const Episode& episode : episodes) {
    const Clip whole(episode, options, aspect);  // says what is wrong with a file
    Runner runner{std::string(1, static_cast<char>('A' + runners_.size())),
                  runner_color(runners_.size()),
                  episode.label,
                  {}};
    for (int step = 0; step <= whole.steps(); ++step) runner.returns.push_back(whole.score(step));
    runners_.push_back(std::move(runner));
  }
  for (const Part& part : parts(episodes))
    outlines_.push_back(runner_color(static_cast<std::size_t>(part.episode - episodes.data())));
  heights_ = rewards_height(*episodes.front().rollout);
  merged_ = std::make_unique<Rollout>(merge(episodes));
  if (options_.camera.objects.empty())
    options_.camera.objects = {merged_->world.objects.front().name};
  clip_ = std::make_unique<Clip>(Episode{merged_.get(), 0, ""}, options_, aspect);
}

Drawing Race::frame(double step, Typesetter& typesetter) const {
  const Theme& theme = theme_by_name(options_.theme);
  Drawing drawing(options_.size);
  Scene scene = clip_->scene(step);
  scene.outlines = outlines_;
  scene.heights = heights_;
  const Rect ranking = ranking_plate(typesetter);
  if (options_.overlays.labels) scene.captions = ranking.y + ranking.height;
  for (std::size_t k = 0; options_.overlays.labels && k < runners_.size(); ++k) {
    const ModelObject& object = clip_->mesh().objects[k];
    constexpr double above = 1.1;  // voxels
    Vec2 top{0, scene.points[static_cast<std::size_t>(object.first_point)].y};
    for (int p = object.first_point; p < object.first_point + object.points; ++p) {
      top.x += scene.points[static_cast<std::size_t>(p)].x / object.points;
      top.y = std::max(top.y, scene.points[static_cast<std::size_t>(p)].y);
    }
    scene.tags.push_back({{top.x, top.y + above}, runners_[k].letter, runners_[k].color});
  }
  draw_scene(scene, theme, drawing.whole(), drawing);
  if (!options_.overlays.labels) return drawing;
  Caption caption = clip_->caption(step);
  caption.score.clear();
  caption.title.clear();
  caption.brief.clear();
  draw_caption(caption, theme, drawing.whole(), typesetter, drawing);
  draw_ranking(step, ranking, drawing);
  draw_key(scene, theme, drawing.whole(), 1, typesetter, drawing);
  return drawing;
}

namespace {

// Of the ranking, shares of the size of its text.
constexpr float ranking_margin = 0.75F;
constexpr float ranking_line = 1.5F;
constexpr float ranking_names = 2.2F;  // from letters to names

float ranking_size(const Rect& whole) { return std::max(8.0F, label_size(whole)); }

}  // namespace

// As wide as its widest moment, so that it stands still.
Rect Race::ranking_plate(Typesetter& typesetter) const {
  const float size = ranking_size(Drawing(options_.size).whole());
  float names = typesetter.width(merged_->task, size, true);
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
  drawing.text({{left, y}, size, merged_->task, theme.text, Align::left, true});
  for (const Runner* runner : order) {
    y += ranking_line * size;
    const Rect badge{left - 0.2F * size, y - 1.02F * size, 1.3F * size, 1.3F * size};
    drawing.rounded_rectangle(badge, 0.35F * size, runner->color);
    drawing.text({{badge.x + badge.width / 2, y},
                  0.9F * size,
                  runner->letter,
                  ink_on(runner->color),
                  Align::centre,
                  true});
    drawing.text({{left + ranking_names * size, y}, size, runner->name, theme.text_muted});
    drawing.text({{plate.x + plate.width - ranking_margin * size, y},
                  size,
                  signed_score(runner->so_far(step)),
                  theme.text,
                  Align::right,
                  true});
  }
}

}  // namespace evo::render
