// Tasks back to YAML: the form that policies and rollouts carry with them.
#include <variant>

#include "formats/physics_profile.h"
#include "formats/task.h"
#include "formats/task_world.h"
#include "libevo/base/overloaded.h"

namespace evo {
namespace {

std::string axis_name(Axis axis) { return axis == Axis::x ? "x" : "y"; }

std::string list(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + yaml_scalar(word);
  return "[" + text + "]";
}

template <typename Profile>
std::string profile(const char* name, const Profile& part) {
  const std::string over = part.over.empty() ? "" : ", over: " + list(part.over);
  return fmt::format("{}: {{width: {}, range: {}{}}}", name, part.width, part.range, over);
}

std::string part_yaml(const ObservationPart& part) {
  using namespace observation;
  return std::visit(
      Overloaded{
          [](const Velocity& p) { return "velocity: " + yaml_scalar(p.of); },
          [](const Orientation& p) { return "orientation: " + yaml_scalar(p.of); },
          [](const RelativePositions& p) { return "relative_positions: " + yaml_scalar(p.of); },
          [](const Offset& p) {
            return fmt::format("offset: {{of: {}, from: {}}}", yaml_scalar(p.of),
                               yaml_scalar(p.from));
          },
          [](const Floor& p) { return profile("floor", p); },
          [](const Ceiling& p) { return profile("ceiling", p); },
          [](const GoalIndex&) { return std::string("goal_index"); },
          [](const GoalPosition&) { return std::string("goal_position"); },
          [](const GoalOffset&) { return std::string("goal_offset"); },
      },
      part);
}

std::string bound(const char* name, const std::optional<double>& value) {
  return value ? fmt::format(", {}: {}", name, *value) : "";
}

std::string condition_yaml(const Condition& condition) {
  using namespace condition;
  return std::visit(
      Overloaded{
          [](const Position& c) {
            return fmt::format("position: {{of: {}, axis: {}{}{}{}{}}}", yaml_scalar(c.of),
                               axis_name(c.axis), bound("above", c.above), bound("below", c.below),
                               bound("at_least", c.at_least), bound("at_most", c.at_most));
          },
          [](const Tilt& c) {
            return fmt::format("tilt: {{of: {}, degrees: {}}}", yaml_scalar(c.of), c.degrees);
          },
          [](const GoalsReached&) { return std::string("goals_reached"); },
      },
      condition);
}

std::string conditions_yaml(const std::vector<Condition>& conditions) {
  std::string text = "    when:\n";
  for (const Condition& condition : conditions)
    text += "      - " + condition_yaml(condition) + "\n";
  return text;
}

template <typename OfAxis>
std::string of_axis(const char* name, const OfAxis& term) {
  return fmt::format("{}: {{of: {}, axis: {}}}", name, yaml_scalar(term.of), axis_name(term.axis));
}

std::string approach_yaml(const reward::Approach& term) {
  const auto* object = std::get_if<std::string>(&term.to);
  const std::string to =
      object ? yaml_scalar(*object) : fmt::format("{}", std::get<double>(term.to));
  return fmt::format("approach: {{of: {}, axis: {}, to: {}}}", yaml_scalar(term.of),
                     axis_name(term.axis), to);
}

std::string term_yaml(const RewardTerm& term) {
  using namespace reward;
  return std::visit(Overloaded{
                        [](const Displacement& t) { return of_axis("displacement", t); },
                        [](const Distance& t) { return of_axis("distance", t); },
                        [](const Approach& t) { return approach_yaml(t); },
                        [](const HullArea& t) { return "hull_area: " + yaml_scalar(t.of); },
                        [](const Extent& t) { return of_axis("extent", t); },
                        [](const Rotation& t) { return "rotation: " + yaml_scalar(t.of); },
                        [](const GoalApproach&) { return std::string("goal_approach:"); },
                    },
                    term.term);
}

std::string reward_yaml(const RewardTerm& term) {
  std::string text = fmt::format("  - {}\n    weight: {}\n", term_yaml(term), term.weight);
  if (!term.when.empty()) text += conditions_yaml(term.when);
  return text;
}

std::string rule_yaml(const Rule& rule) {
  return fmt::format("  - reward: {}\n    terminate: {}\n{}", rule.reward, rule.terminate,
                     conditions_yaml(rule.when));
}

}  // namespace

std::string task_to_yaml(const TaskSpec& task) {
  std::string text = "format: evo/task\nversion: 1\nname: " + yaml_scalar(task.name) + "\n";
  if (!task.aliases.empty()) text += "aliases: " + list(task.aliases) + "\n";
  if (!task.difficulty.empty()) text += "difficulty: " + task.difficulty + "\n";
  if (!task.description.empty()) text += "description: " + yaml_scalar(task.description) + "\n";
  if (!task.notes.empty()) {
    text += "notes:\n";
    for (const std::string& note : task.notes) text += "  - " + yaml_scalar(note) + "\n";
  }
  text += fmt::format("steps: {}\nrobot: {{at: [{}, {}]}}\n", task.episode_steps, task.robot_x,
                      task.robot_y);
  if (!task.draws.empty()) {
    text += "draws:\n";
    for (const DrawnInteger& drawn : task.draws)
      text += fmt::format("  {}: [{}, {}]\n", yaml_scalar(drawn.name), drawn.low, drawn.high);
  }
  if (task.goals)
    text += fmt::format("goals: {{start: {}, between: [{}, {}], distance: {}, radius: {}}}\n",
                        task.goals->start, task.goals->low, task.goals->high, task.goals->distance,
                        task.goals->radius);
  text += "world:\n" + world_to_yaml(task.objects) + "observation:\n";
  for (const ObservationPart& part : task.observation) text += "  - " + part_yaml(part) + "\n";
  text += task.reward.empty() ? "reward: []\n" : "reward:\n";
  for (const RewardTerm& term : task.reward) text += reward_yaml(term);
  text += fmt::format("folding_reward: {}\n", task.folding_reward);
  if (!task.rules.empty()) text += "rules:\n";
  for (const Rule& rule : task.rules) text += rule_yaml(rule);
  text += "follow: " + list(task.follow) + "\n";
  return text + "physics:\n" + physics_constants_to_yaml(task.physics, "  ");
}

}  // namespace evo
