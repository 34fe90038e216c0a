// Sheets: several small pictures on one, with text below each.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/robot.h"
#include "render/clip.h"
#include "render/text.h"

namespace evo::render {

// A body in the middle of `area`, nothing behind it. Its scale is that of a body
// of `across` times `across` voxels that fills the area, so that bodies of one
// sheet can be compared.
void draw_body(const Body& body, int across, const Theme& theme, const Rect& area,
               Drawing& drawing);

// One robot: its body over a grid of voxels, id, fitness and task below.
Drawing robot_picture(const Robot& robot, const Theme& theme, Size size, Typesetter& typesetter);

// Robots in reading order, `width` pixels across and as high as it takes, with
// id and fitness. More rows than fit into the largest picture make the robots
// smaller.
Drawing robot_grid(const std::vector<Robot>& robots, const Theme& theme, int width,
                   Typesetter& typesetter);

// The figure "Evolution of robot designs" of the benchmark's paper: a column for
// each generation, its best robots from the top, fitness below each.
struct Generation {
  std::string name;           // heading of the column
  std::vector<Robot> robots;  // best first
};
Drawing generation_sheet(const std::vector<Generation>& generations, int rows, const Theme& theme,
                         int width, Typesetter& typesetter);

// Moments of an episode side by side, in rows when they are many.
Drawing moment_sheet(const Clip& clip, const std::vector<double>& moments, const Theme& theme,
                     int width, Typesetter& typesetter);

// Width to height of a panel of a moment sheet, for the clip's camera.
double moment_aspect(std::size_t moments);

// As many generations as can be told apart in `width` pixels, evenly chosen,
// the first and the last always among them.
std::vector<std::size_t> chosen_generations(std::size_t generations, int width);

}  // namespace evo::render
