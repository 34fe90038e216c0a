// Pictures of evo/evo.h, of whatever has a model and positions.
#include <algorithm>

#include "bindings/c/handles.h"
#include "render/still.h"

using namespace evo::c;  // NOLINT(google-build-using-namespace)
using evo::Failure;

namespace evo::c {

namespace {

constexpr int smallest_side = 16;
constexpr int largest_side = 4096;
constexpr int default_width = 600;  // as the benchmark's
constexpr int default_height = 300;

evo_view view_of(const evo_view* given, std::size_t size) {
  evo_view view = taken(given, size);
  if (view.width == 0) view.width = default_width;
  if (view.height == 0) view.height = default_height;
  for (const int side : {view.width, view.height})
    if (side < smallest_side || side > largest_side)
      throw error(Failure::usage, "a picture of {} x {} pixels: each side may be {} to {}",
                  view.width, view.height, smallest_side, largest_side);
  return view;
}

render::RenderOptions options_of(const evo_view& view) {
  render::RenderOptions options;
  options.size = {view.width, view.height};
  options.overlays.labels = false;  // there is no episode to tell of
  constexpr int all = EVO_HIDE_GRID | EVO_HIDE_BACKGROUND | EVO_HIDE_EDGES | EVO_HIDE_VOXELS;
  if ((view.hide & ~all) != 0)
    throw error(Failure::usage, "`hide` is {}, which is no sum of evo_hide", view.hide);
  options.overlays.grid = (view.hide & EVO_HIDE_GRID) == 0;
  options.overlays.background = (view.hide & EVO_HIDE_BACKGROUND) == 0;
  options.overlays.edges = (view.hide & EVO_HIDE_EDGES) == 0;
  options.overlays.voxels = (view.hide & EVO_HIDE_VOXELS) == 0;
  const std::span window(view.window);
  if (std::ranges::all_of(window, [](double value) { return value == 0.0; })) return options;
  constexpr double largest = 1e6;  // voxels
  for (const double value : window)
    if (!(std::abs(value) <= largest))
      throw error(Failure::usage, "the window has a value of {}", value);
  if (window[2] <= 0 || window[3] <= 0)
    throw error(Failure::usage, "a window of {} x {} voxels shows nothing", window[2], window[3]);
  options.camera.mode = render::CameraMode::fixed;
  options.camera.window = {window[0], window[1], window[2], window[3]};
  return options;
}

}  // namespace

void draw(const Model& model, std::span<const Vec2> now, const double* given, const TaskSpec* task,
          const evo_view* view, std::size_t size, std::uint8_t* pixels, std::size_t bytes) {
  const evo_view wanted = view_of(view, size);
  const std::size_t count =
      static_cast<std::size_t>(wanted.width) * static_cast<std::size_t>(wanted.height);
  if (bytes != 3 * count)
    throw error(Failure::usage, "a picture of {} x {} pixels has {} bytes, not {}", wanted.width,
                wanted.height, 3 * count, bytes);
  target(pixels, "pixels");
  Rollout moment;
  if (task != nullptr) moment.task_yaml = task->source;
  moment.points = model.points();
  moment.world.objects.assign(model.objects().begin(), model.objects().end());
  moment.world.cells.assign(model.cells().begin(), model.cells().end());
  RolloutEpisode& episode = moment.episodes.emplace_back();
  const auto shown = given == nullptr ? now : points_of(given, now.size());
  episode.positions.assign(shown.begin(), shown.end());
  const render::Image image = render::draw_still({&moment, 0, ""}, options_of(wanted));
  for (std::size_t i = 0; i < count; ++i) std::copy_n(&image.rgba[4 * i], 3, pixels + 3 * i);
}

}  // namespace evo::c

int evo_robots_svg(const evo_robots* robots, size_t index, int32_t width, char** svg) {
  return guarded([&] {
    const evo::Robot& robot = robot_at(object_of(robots), index);
    if (width < smallest_side || width > largest_side)
      throw evo::error(Failure::usage, "a picture {} pixels wide: {} to {} are allowed", width,
                       smallest_side, largest_side);
    give(evo::render::robot_svg(robot, {width, width}), svg, "svg");
  });
}
