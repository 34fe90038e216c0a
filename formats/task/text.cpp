#include "formats/task/text.h"

#include <algorithm>
#include <cmath>

#include "formats/task/pieces.h"
#include "libevo/base/join.h"
#include "libevo/task/env.h"

namespace evo {
namespace {

std::string signed_number(double value) {
  return fmt::format("{}{}", value < 0 ? "-" : "+", number_text(std::abs(value)));
}

// "2n+14", n being the robot's points.
std::string length_formula(const TaskSpec& task) {
  int factor = 0;
  int constant = 0;
  for (const ObservationPart& part : task.observation) {
    const bool of_robot = part_object(part) == robot_name;
    factor += of_robot ? part_length(part, 1) - part_length(part, 0) : 0;
    constant += part_length(part, 0);
  }
  if (factor == 0) return fmt::format("{}", constant);
  if (constant == 0) return fmt::format("{}n", factor);
  return fmt::format("{}n+{}", factor, constant);
}

// ---- the whole --------------------------------------------------------------------

std::string goals_text(const DrawnGoals& goals, const Physics& physics) {
  return fmt::format(
      "  goals: whole voxels from {} to {} along x, until the way from {} over all of them is at "
      "least {} voxels;\n         reached when the robot's centre is nearer than {}\n",
      goals.low, goals.high, goals.start, goals.distance, length_text(goals.radius, physics));
}

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

// The world as an episode begins, offsets that are drawn left out: '#' terrain, 'o' other
// objects, '@' the robot, '.' nothing. A letter is a cell; worlds wider than `columns`
// letters have a letter for every 2x2 cells, or more, what stands first in this list
// hiding the rest: robot, object, terrain. Taller ones than `rows` lines are cut at
// the top, but not the robot, and say so. The first line explains the letters.
std::string world_drawing(const TaskSpec& task, const Body& robot) {
  constexpr int columns = 76;
  constexpr int rows = 24;
  Cells cells;
  for (const Placement& placement : task.objects)
    cells.add(placement.object.body, placement.object.x, placement.object.y, 0);
  cells.add(robot, task.robot_x, task.robot_y, '@');
  const int side = std::max(1, (cells.width() + columns - 1) / columns);
  const int lines = (cells.height() + side - 1) / side;
  const int robot_top = (task.robot_y + robot.rows + side - 1) / side;
  const int shown = std::min(lines, std::max(rows, robot_top));
  std::string text = "  @ robot, o object, # terrain";
  text += side > 1 ? fmt::format("; a letter for {0}x{0} cells\n", side) : "\n";
  if (shown < lines) text += fmt::format("  ... {} more lines above\n", lines - shown);
  for (int line = shown - 1; line >= 0; --line) {
    text += "  ";
    for (int x = 0; x < cells.width(); x += side) text += of_square(cells, x, line * side, side);
    text += '\n';
  }
  return text;
}

std::string world_text(const TaskSpec& task, const Body& robot) {
  std::string text = "world (cells of the lower-left corner, columns x rows)\n";
  text += fmt::format("  robot at {}, {}\n", task.robot_x, task.robot_y);
  for (const Placement& placement : task.objects) {
    const Object& object = placement.object;
    const auto offset = [](const std::string& name) { return name.empty() ? "" : " + " + name; };
    text += fmt::format("  {} at {}{}, {}{}: {} x {}, {} voxels\n", object.name, object.x,
                        offset(placement.offset_x), object.y, offset(placement.offset_y),
                        object.body.cols, object.body.rows, count_voxels(object.body));
  }
  for (const DrawnInteger& drawn : task.draws)
    text += fmt::format("  {}: drawn from {} .. {} in each episode\n", drawn.name, drawn.low,
                        drawn.high);
  if (task.goals) text += goals_text(*task.goals, task.physics);
  return text + world_drawing(task, robot);
}

std::string observation_text(const TaskSpec& task, const Arena& arena) {
  std::string text =
      fmt::format("observation: {} numbers ({}; n = points of the robot), raw lengths\n",
                  arena.observation_length(), length_formula(task));
  for (std::size_t i = 0; i < arena.layout().size(); ++i) {
    const ObservationSlice& slice = arena.layout()[i];
    const int last = slice.offset + slice.length - 1;
    const std::string range = slice.length == 1 ? fmt::format("{}", slice.offset)
                                                : fmt::format("{}-{}", slice.offset, last);
    text += fmt::format("  {:>8}  {:<28} {}\n", range, slice.name,
                        part_to_words(task.observation[i], task.physics));
  }
  return text;
}

std::string reward_text(const TaskSpec& task) {
  std::string text =
      "reward of a step (X, Y: centre; a: targets; d: change in the step; raw lengths, a voxel "
      "is " +
      number_text(task.physics.voxel_length) + ")\n";
  for (const RewardTerm& term : task.reward) {
    const TermWords words = term_to_words(term.term, task.physics);
    text +=
        fmt::format("  {:>6} {:<32} {}\n", signed_number(term.weight), words.formula, words.words);
    if (!term.when.empty())
      text += fmt::format("{:9}while {}\n", "", conditions_to_words(term.when, task.physics));
  }
  if (task.step_cost != 0.0)
    text += fmt::format("  {:>6} every step\n", signed_number(-task.step_cost));
  return text;
}

std::string ends_text(const TaskSpec& task) {
  std::string text = "ends (in this order; the rewards add up)\n";
  text += fmt::format("  {:>6} self-folding: ends\n", signed_number(task.folding_reward));
  for (const Rule& rule : task.rules)
    text += fmt::format("  {:>6} {}: {}\n", signed_number(rule.reward),
                        conditions_to_words(rule.when, task.physics),
                        rule.terminate ? "ends" : "continues");
  return text + fmt::format("         after {} steps: truncated\n", task.episode_steps);
}

}  // namespace

Body full_body(int rows, int cols) {
  return {rows, cols,
          std::vector<Voxel>(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols),
                             Voxel::horizontal)};
}

std::string describe_task(const TaskSpec& task, const Body& robot) {
  const Arena arena(task, robot);
  std::string text = task.name;
  if (!task.difficulty.empty()) text += " (" + task.difficulty + ")";
  text += "\n";
  if (!task.description.empty()) text += task.description + "\n";
  if (!task.aliases.empty()) text += fmt::format("also called: {}\n", joined(task.aliases, ", "));
  text += fmt::format("episode: {} steps{}\naction: {} targets in [{}, {}]\n\n", task.episode_steps,
                      task.hold == 1 ? "" : fmt::format(" of {} control steps", task.hold),
                      arena.action_length(), number_text(task.physics.min_target),
                      number_text(task.physics.max_target));
  text += world_text(task, robot) + "\n" + observation_text(task, arena) + "\n" +
          reward_text(task) + "\n" + ends_text(task);
  if (!task.notes.empty()) text += "\nnotes\n";
  for (const std::string& note : task.notes) text += "  - " + note + "\n";
  return text;
}

// ---- the table ------------------------------------------------------------------------

namespace {

using Row = std::vector<std::string>;

std::string aligned(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const Row& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      text += fmt::format("{:<{}}  ", row[i], widths[i]);
    text += row.back() + "\n";
  }
  return text;
}

}  // namespace

std::string task_table(const std::vector<TaskSpec>& tasks) {
  std::vector<Row> rows{{"task", "difficulty", "steps", "observation", "5x5", "description"}};
  for (const TaskSpec& task : tasks) {
    const Arena arena(task, full_body(5, 5));
    rows.push_back({task.name, task.difficulty.empty() ? "-" : task.difficulty,
                    fmt::format("{}", task.episode_steps), length_formula(task),
                    fmt::format("{}", arena.observation_length()), task.description});
  }
  return aligned(rows);
}

}  // namespace evo
