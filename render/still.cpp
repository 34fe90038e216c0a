#include "render/still.h"

#include "render/figures/sheet.h"
#include "render/painters/raster.h"
#include "render/painters/vector.h"
#include "render/scene/scene.h"

namespace evo::render {

Image draw_still(const Episode& episode, const RenderOptions& options) {
  check_options(options);
  Image image(options.size);
  Drawing drawing(options.size);
  const Rect whole = drawing.whole();
  const Clip clip(episode, options, whole.width / whole.height);
  draw_scene(clip.scene(0), theme_by_name(options.theme), whole, drawing);
  rasterise(drawing, target(image));
  return image;
}

std::string robot_svg(const Robot& robot, Size size) {
  Typesetter typesetter;
  return encode_svg(robot_picture(robot, theme_by_name("light"), size, typesetter), robot.id,
                    typesetter);
}

}  // namespace evo::render
