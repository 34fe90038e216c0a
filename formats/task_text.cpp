#include "formats/task_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "libevo/base/overloaded.h"
#include "libevo/task/env.h"

namespace evo {
namespace {

// ---- formulas -------------------------------------------------------------------

std::string number(double value) { return fmt::format("{:.6g}", value); }

// A length in voxels, shown raw as it is compared: "9.9 (99 voxels)".
std::string length(double voxels, const Physics& physics) {
  return fmt::format("{} ({} voxel{})", number(voxels * physics.voxel_length), number(voxels),
                     voxels == 1.0 ? "" : "s");
}

const char* letter(Axis axis) { return axis == Axis::x ? "X" : "Y"; }

std::string condition_text(const Condition& condition, const Physics& physics) {
  using namespace condition;
  return std::visit(
      Overloaded{
          [&](const Position& c) {
            std::vector<std::string> bounds;
            const auto bound = [&](const char* relation, const std::optional<double>& value) {
              if (value)
                bounds.push_back(fmt::format("{}({}) {} {}", letter(c.axis), c.of, relation,
                                             length(*value, physics)));
            };
            bound(">", c.above);
            bound("<", c.below);
            bound(">=", c.at_least);
            bound("<=", c.at_most);
            return fmt::format("{}", fmt::join(bounds, " and "));
          },
          [](const Tilt& c) {
            return fmt::format("{} tilted by more than {} degrees", c.of, number(c.degrees));
          },
          [](const GoalsReached&) { return std::string("all goals reached"); },
      },
      condition);
}

std::string conditions_text(const std::vector<Condition>& conditions, const Physics& physics) {
  std::vector<std::string> parts;
  parts.reserve(conditions.size());
  for (const Condition& condition : conditions) parts.push_back(condition_text(condition, physics));
  return fmt::format("{}", fmt::join(parts, " and "));
}

struct TermText {
  std::string formula;
  std::string words;
};

TermText term_text(const RewardTerm& term, const Physics& physics) {
  using namespace reward;
  return std::visit(
      Overloaded{
          [](const Displacement& t) -> TermText {
            return {fmt::format("d{}({})", letter(t.axis), t.of),
                    fmt::format("how far {} moves {}", t.of,
                                t.axis == Axis::x ? "to the right" : "up")};
          },
          [](const Distance& t) -> TermText {
            return {fmt::format("|d{}({})|", letter(t.axis), t.of),
                    fmt::format("how far {} moves {}", t.of,
                                t.axis == Axis::x ? "left or right" : "up or down")};
          },
          [&](const Approach& t) -> TermText {
            const std::string own = fmt::format("{}({})", letter(t.axis), t.of);
            if (const auto* object = std::get_if<std::string>(&t.to))
              return {fmt::format("-d|{}({}) - {}|", letter(t.axis), *object, own),
                      fmt::format("how much nearer {} comes to {}", t.of, *object)};
            const double place = std::get<double>(t.to);
            return {fmt::format("-d|{} - {}|", number(place * physics.voxel_length), own),
                    fmt::format("how much nearer {} comes to {} = {}", t.of,
                                t.axis == Axis::x ? "x" : "y", length(place, physics))};
          },
          [](const HullArea& t) -> TermText {
            return {fmt::format("dA({})", t.of),
                    fmt::format("growth of the area of {}'s convex hull", t.of)};
          },
          [](const Extent& t) -> TermText {
            const char* name = t.axis == Axis::x ? "width" : "height";
            return {fmt::format("d{}({})", name, t.of),
                    fmt::format("growth of {}'s {}", t.of, name)};
          },
          [](const Rotation& t) -> TermText {
            return {fmt::format("dangle({})", t.of),
                    fmt::format("radians that {} turns counter-clockwise", t.of)};
          },
          [](const GoalApproach&) -> TermText {
            return {"-d|goal - X(robot)|", "how much nearer the robot comes to the current goal"};
          },
      },
      term.term);
}

std::string signed_number(double value) {
  return fmt::format("{}{}", value < 0 ? "-" : "+", number(std::abs(value)));
}

// ---- observation ------------------------------------------------------------------

std::string part_words(const ObservationPart& part, const Physics& physics) {
  using namespace observation;
  const auto profile = [&](const auto& p, const char* side) {
    const std::string over =
        p.over.empty() ? "all objects but the robot" : fmt::format("{}", fmt::join(p.over, ", "));
    return fmt::format(
        "distance {} the robot's centre to the nearest point of {}, in {} columns one voxel wide, "
        "at most {}",
        side, over, 2 * p.width + 1, length(p.range, physics));
  };
  return std::visit(
      Overloaded{
          [](const Velocity& p) { return fmt::format("mean velocity of {} (x, y)", p.of); },
          [](const Orientation& p) {
            return fmt::format("how far {} is turned, radians in [0, 2 pi)", p.of);
          },
          [](const RelativePositions& p) {
            return fmt::format("points of {} relative to its centre: all x, then all y", p.of);
          },
          [](const Offset& p) {
            return fmt::format("centre of {} minus centre of {} (x, y)", p.of, p.from);
          },
          [&](const Floor& p) { return profile(p, "below"); },
          [&](const Ceiling& p) { return profile(p, "above"); },
          [](const GoalIndex&) { return std::string("how many goals have been reached"); },
          [](const GoalPosition&) { return std::string("the current goal's x"); },
          [](const GoalOffset&) {
            return std::string("the current goal's x minus that of the robot's centre");
          },
      },
      part);
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

std::string observation_summary(const TaskSpec& task) {
  std::vector<std::string> names;
  for (const ObservationPart& part : task.observation) names.push_back(part_name(part));
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string rule_text(const Rule& rule, const Physics& physics) {
  std::string text = conditions_text(rule.when, physics);
  if (rule.reward != 0.0) text += ": " + signed_number(rule.reward);
  return text + (rule.terminate ? "" : ", goes on");
}

std::string rules_summary(const TaskSpec& task) {
  std::vector<std::string> rules;
  for (const Rule& rule : task.rules) rules.push_back(rule_text(rule, task.physics));
  return rules.empty() ? "-" : fmt::format("{}", fmt::join(rules, "; "));
}

// ---- the whole --------------------------------------------------------------------

std::string goals_text(const DrawnGoals& goals, const Physics& physics) {
  return fmt::format(
      "  goals: whole voxels from {} to {} along x, until the way from {} over all of them is at "
      "least {} voxels;\n         reached when the robot's centre is nearer than {}\n",
      goals.low, goals.high, goals.start, goals.distance, length(goals.radius, physics));
}

std::string world_text(const TaskSpec& task) {
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
  return text;
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
                        part_words(task.observation[i], task.physics));
  }
  return text;
}

std::string reward_text(const TaskSpec& task) {
  std::string text =
      "reward of a step (X, Y: centre; d: change in the step; raw lengths, a voxel is " +
      number(task.physics.voxel_length) + ")\n";
  for (const RewardTerm& term : task.reward) {
    const TermText words = term_text(term, task.physics);
    text +=
        fmt::format("  {:>6} {:<32} {}\n", signed_number(term.weight), words.formula, words.words);
    if (!term.when.empty())
      text += fmt::format("{:9}while {}\n", "", conditions_text(term.when, task.physics));
  }
  return text;
}

std::string ends_text(const TaskSpec& task) {
  std::string text = "ends (in this order; the rewards add up)\n";
  text += fmt::format("  {:>6} self-folding: ends\n", signed_number(task.folding_reward));
  for (const Rule& rule : task.rules)
    text +=
        fmt::format("  {:>6} {}: {}\n", signed_number(rule.reward),
                    conditions_text(rule.when, task.physics), rule.terminate ? "ends" : "goes on");
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
  if (!task.aliases.empty())
    text += fmt::format("also called: {}\n", fmt::join(task.aliases, ", "));
  text += fmt::format("episode: {} steps\naction: {} targets in [{}, {}]\n\n", task.episode_steps,
                      arena.action_length(), number(task.physics.min_target),
                      number(task.physics.max_target));
  text += world_text(task) + "\n" + observation_text(task, arena) + "\n" + reward_text(task) +
          "\n" + ends_text(task);
  if (!task.notes.empty()) text += "\nnotes\n";
  for (const std::string& note : task.notes) text += "  - " + note + "\n";
  return text;
}

// ---- the table ------------------------------------------------------------------------

namespace {

using Row = std::vector<std::string>;

// What both tables begin with.
Row table_head(const TaskSpec& task) {
  const Arena arena(task, full_body(5, 5));
  return {task.name, task.difficulty.empty() ? "-" : task.difficulty,
          fmt::format("{}", task.episode_steps), length_formula(task),
          fmt::format("{}", arena.observation_length())};
}

std::string plain_table(const std::vector<Row>& rows) {
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

std::string markdown_table(const std::vector<Row>& rows) {
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += fmt::format("| {} |\n", fmt::join(rows[r], " | "));
    if (r != 0) continue;
    for (std::size_t i = 0; i < rows[r].size(); ++i) text += "|---";
    text += "|\n";
  }
  return text;
}

}  // namespace

std::string task_table(const std::vector<TaskSpec>& tasks, TableStyle style) {
  const bool plain = style == TableStyle::plain;
  std::vector<Row> rows;
  rows.push_back({"task", "difficulty", "steps", "observation", "5x5"});
  if (plain)
    rows.back().push_back("description");
  else
    rows.back().insert(rows.back().end(), {"parts", "ends, besides self-folding"});
  for (const TaskSpec& task : tasks) {
    Row row = table_head(task);
    if (plain)
      row.push_back(task.description);
    else
      row.insert(row.end(), {observation_summary(task), rules_summary(task)});
    rows.push_back(std::move(row));
  }
  return plain ? plain_table(rows) : markdown_table(rows);
}

}  // namespace evo
