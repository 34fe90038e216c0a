#include "render/film/evolution_film.h"

#include <algorithm>
#include <cmath>
#include <ranges>

#include "libevo/base/error.h"
#include "libevo/body/changes.h"
#include "render/figures/key.h"
#include "render/figures/label.h"

namespace evo::render {
namespace {

// Seconds of the film.
constexpr double standing_time = 0.7;
constexpr double longest_run = 2.0;
constexpr double ended_time = 0.4;
constexpr double flashes = 5.0;  // per second

// Voxels of `body` that are not what they are in `before`, where they stand at the
// start; none where the two differ in size.
std::vector<std::array<Vec2, 4>> changed_voxels(const Body& before, const Body& body,
                                                const Clip& clip) {
  std::vector<std::array<Vec2, 4>> changed;
  const auto first = std::find_if(body.cells.begin(), body.cells.end(),
                                  [](Voxel voxel) { return voxel != Voxel::empty; });
  if (first == body.cells.end()) return changed;
  const auto index = static_cast<int>(first - body.cells.begin());
  const ModelObject& robot = clip.mesh().objects.front();
  const auto cell = static_cast<std::size_t>(robot.first_cell);
  const Vec2 corner = clip.points(0)[static_cast<std::size_t>(clip.mesh().cells[cell].points[0])];
  for (const Change& change : changes(before, body)) {
    const double x = corner.x + change.col - index % body.cols;
    const double y = corner.y - change.row + index / body.cols;
    changed.push_back({Vec2{x, y}, {x + 1, y}, {x + 1, y - 1}, {x, y - 1}});
  }
  return changed;
}

std::string generations(const Champion& champion) {
  return champion.first == champion.last
             ? fmt::format("generation {}", champion.first)
             : fmt::format("generations {} to {}", champion.first, champion.last);
}

}  // namespace

EvolutionFilm::EvolutionFilm(const std::vector<Champion>& champions, const RenderOptions& options)
    : options_(options) {
  if (champions.empty()) throw Error(Failure::data, "there is no generation to show");
  const double aspect =
      static_cast<double>(options.size.width) / static_cast<double>(options.size.height);
  const auto frames = [&](double seconds) {
    return static_cast<std::size_t>(std::lround(seconds * options.fps / options.speed));
  };
  for (const Champion& champion : champions) {
    Part part{champion, Clip(champion.episode, options, aspect), frames_, 0, 0, 0, {}};
    const auto& robot = champion.episode.rollout->robot;
    const auto& before = parts_.empty() ? robot : parts_.back().champion.episode.rollout->robot;
    if (robot && before) part.changed = changed_voxels(before->body, robot->body, part.clip);
    part.standing = frames(standing_time);
    part.running = std::max<std::size_t>(
        1, frames(std::min(longest_run, part.clip.seconds(part.clip.steps()))));
    part.ended = frames(ended_time);
    frames_ += part.standing + part.running + part.ended;
    parts_.push_back(std::move(part));
  }
  share_value_scale(parts_ | std::views::transform(&Part::clip));
}

Drawing EvolutionFilm::frame(std::size_t k, Typesetter& typesetter) const {
  auto next = std::find_if(parts_.begin(), parts_.end(),
                           [&](const Part& part) { return part.first_frame > k; });
  const Part& part = *(next - 1);
  const std::size_t at = k - part.first_frame;
  const bool stands = at < part.standing;
  const bool over = at >= part.standing + part.running;
  const double step = stands ? 0
                             : static_cast<double>(part.clip.steps()) *
                                   std::min(1.0, static_cast<double>(at - part.standing + 1) /
                                                     static_cast<double>(part.running));
  const Theme& theme = theme_by_name(options_.theme);
  Drawing drawing(options_.size);
  Scene scene = part.clip.scene(step);
  const double flash = flashes * static_cast<double>(at) / options_.fps * options_.speed;
  if (stands && flash - std::floor(flash) < 0.6) scene.framed = part.changed;
  if (options_.overlays.labels) scene.captions = caption_height(drawing.whole(), 1);
  for (auto earlier = parts_.begin(); options_.overlays.labels && &*earlier != &part; ++earlier)
    scene.pins.push_back({earlier->clip.centre(earlier->clip.steps()),
                          fmt::format("gen {}", earlier->champion.first)});
  draw_scene(scene, theme, drawing.whole(), drawing);
  if (!options_.overlays.labels) return drawing;
  Caption caption = part.clip.caption(step);
  caption.detail = generations(part.champion) + "  " +
                   (part.champion.episode.rollout->robot ? part.champion.episode.rollout->robot->id
                                                         : std::string());
  caption.brief = generations(part.champion);
  if (stands || over) caption.score = "fitness " + signed_score(part.champion.fitness);
  draw_caption(caption, theme, drawing.whole(), typesetter, drawing);
  draw_key(scene, theme, drawing.whole(), 2, typesetter, drawing);
  return drawing;
}

}  // namespace evo::render
