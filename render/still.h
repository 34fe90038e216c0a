// Pictures made within this process, without OpenGL (painters/raster.h says why): what a program
// that the suite is a library of may ask for.
#pragma once

#include <string>

#include "formats/robot/robot.h"
#include "render/painters/image.h"
#include "render/scene/clip.h"
#include "render/scene/options.h"

namespace evo::render {

// The first moment of an episode, without labels. Errors as of draw_moment().
Image draw_still(const Episode& episode, const RenderOptions& options);

// A robot as an SVG document.
std::string robot_svg(const Robot& robot, Size size);

}  // namespace evo::render
