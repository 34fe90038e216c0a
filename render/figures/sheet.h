// Sheets: several small pictures on one, with text below each.
#pragma once

#include <vector>

#include "formats/robot/robot.h"
#include "render/painters/text.h"
#include "render/scene/clip.h"

namespace evo::render {

// Extents in voxels, without the empty border of a matrix.
struct Span {
  int cols = 1;
  int rows = 1;
};
Span span_of(const Body& body);

// A body in the middle of `area`, nothing behind it. Its scale is that of a body
// of `span` that fills the area, so that bodies of one sheet can be compared. Voxels that
// are not what they are in `before`, if it is given and as large, have a frame.
void draw_body(const Body& body, const Span& span, const Theme& theme, const Rect& area,
               Drawing& drawing, const Body* before = nullptr);

// One robot: its body over a grid of voxels, id, fitness and task below.
Drawing robot_picture(const Robot& robot, const Theme& theme, Size size, Typesetter& typesetter);

// Robots in reading order, at most `width` pixels across and as high as it takes,
// with id and fitness. More rows than fit into the largest picture make the robots
// smaller.
Drawing robot_grid(const std::vector<Robot>& robots, const Theme& theme, int width,
                   Typesetter& typesetter);

// Moments of an episode side by side, in rows when they are many.
Drawing moment_sheet(const Clip& clip, const std::vector<double>& moments, const Theme& theme,
                     int width, Typesetter& typesetter);

// Several episodes at one step, or at their ends, side by side, with id and return.
Drawing robot_sheet(const std::vector<Clip>& clips, double step, const Theme& theme, int width,
                    Typesetter& typesetter);

// Width to height of a panel of a moment sheet, for the clip's camera.
double moment_aspect(std::size_t moments);

}  // namespace evo::render
