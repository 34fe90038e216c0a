#include "formats/task/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace evo {
namespace {

// Cells by place, y upwards from 0.
class Cells {
 public:
  void add(const Body& body, int x, int y, char robot_letter) {
    for (int row = 0; row < body.rows; ++row)
      for (int col = 0; col < body.cols; ++col) {
        const Voxel voxel = body.at(row, col);
        if (voxel == Voxel::empty) continue;
        const char letter = robot_letter != 0 ? robot_letter : voxel == Voxel::fixed ? '#' : 'o';
        put(x + col, y + body.rows - 1 - row, letter);
      }
  }
  int width() const { return width_; }
  int height() const { return static_cast<int>(lines_.size()); }
  char at(int x, int y) const {
    if (y < 0 || y >= height()) return '.';
    const std::string& line = lines_[static_cast<std::size_t>(y)];
    return static_cast<std::size_t>(x) < line.size() ? line[static_cast<std::size_t>(x)] : '.';
  }

 private:
  void put(int x, int y, char letter) {
    if (x < 0 || y < 0) return;
    if (y >= height()) lines_.resize(static_cast<std::size_t>(y) + 1);
    std::string& line = lines_[static_cast<std::size_t>(y)];
    if (static_cast<std::size_t>(x) >= line.size())
      line.resize(static_cast<std::size_t>(x) + 1, '.');
    line[static_cast<std::size_t>(x)] = letter;
    width_ = std::max(width_, x + 1);
  }
  std::vector<std::string> lines_;
  int width_ = 0;
};

// What must be seen most in a square of cells.
char of_square(const Cells& cells, int x, int y, int side) {
  static const std::string order = "@o#.";
  std::size_t first = order.size() - 1;
  for (int dx = 0; dx < side; ++dx)
    for (int dy = 0; dy < side; ++dy) first = std::min(first, order.find(cells.at(x + dx, y + dy)));
  return order[first];
}

}  // namespace

std::string draw_task(const TaskSpec& task, const Body& robot, int columns, int rows) {
  Cells cells;
  for (const Placement& placement : task.objects)
    cells.add(placement.object.body, placement.object.x, placement.object.y, 0);
  cells.add(robot, task.robot_x, task.robot_y, '@');
  const int side = std::max(1, (cells.width() + columns - 1) / columns);
  const int lines = (cells.height() + side - 1) / side;
  const int robot_top = (task.robot_y + robot.rows + side - 1) / side;
  const int shown = std::min(lines, std::max(rows, robot_top));
  std::string text = "@ robot, o object, # terrain";
  text += side > 1 ? fmt::format("; a letter for {0}x{0} cells\n", side) : "\n";
  if (shown < lines) text += fmt::format("... {} more lines above\n", lines - shown);
  for (int line = shown - 1; line >= 0; --line) {
    for (int x = 0; x < cells.width(); x += side) text += of_square(cells, x, line * side, side);
    text += '\n';
  }
  return text;
}

}  // namespace evo
