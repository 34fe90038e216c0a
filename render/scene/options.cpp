#include "render/scene/options.h"

#include "formats/io/number.h"
#include "libevo/base/error.h"
#include "render/painters/drawing.h"
#include "render/scene/theme.h"

namespace evo::render {

double pixels_of(const std::string& length) {
  constexpr double inch = 96;
  for (const auto& [unit, pixels] :
       {std::pair{"mm", inch / 25.4}, {"cm", inch / 2.54}, {"in", inch}, {"pt", inch / 72}}) {
    if (!length.ends_with(unit)) continue;
    const auto number = number_in<double>(std::string_view(length).substr(0, length.size() - 2));
    if (number && *number * pixels >= 1 && *number * pixels <= largest_side)
      return *number * pixels;
  }
  throw error(Failure::usage, "'{}' is no width, such as 85mm, 17cm, 3.4in or 240pt", length);
}

void check_options(const RenderOptions& o) {
  check_size(o.size);
  (void)theme_by_name(o.theme);
  constexpr double most_fps = 240;
  if (!(o.fps > 0 && o.fps <= most_fps))
    throw error(Failure::usage,
                "a video of {} frames per second cannot be made: allowed are more than 0 to {}",
                o.fps, most_fps);
  if (!(o.speed > 0 && o.speed <= 1000))
    throw error(Failure::usage, "a speed of {} cannot be shown: allowed are more than 0 to 1000",
                o.speed);
  if (o.from < 0)
    throw error(Failure::usage, "the first step shown is {}: must be 0 or more", o.from);
  if (o.to && *o.to < o.from)
    throw error(Failure::usage, "the last step shown, {}, comes before the first, {}", *o.to,
                o.from);
  if (o.workers < 1)
    throw error(Failure::usage, "{} drawing processes: must be 1 or more", o.workers);
  if (!(o.camera.zoom >= 0.1 && o.camera.zoom <= 10))
    throw error(Failure::usage, "a zoom of {}: allowed are 0.1 to 10", o.camera.zoom);
  if (o.camera.mode == CameraMode::fixed &&
      !(o.camera.window.width > 0 && o.camera.window.height > 0))
    throw error(Failure::usage, "a camera window of {}x{} voxels shows nothing",
                o.camera.window.width, o.camera.window.height);
}

}  // namespace evo::render
