// Tasks back to YAML: the form that policies and rollouts carry with them.
#include "formats/task/physics_profile.h"
#include "formats/task/pieces.h"
#include "formats/task/task.h"
#include "formats/task/world.h"

namespace evo {
namespace {

std::string list(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + yaml_scalar(word);
  return "[" + text + "]";
}

std::string conditions_yaml(const std::vector<Condition>& conditions) {
  std::string text = "    when:\n";
  for (const Condition& condition : conditions)
    text += "      - " + condition_to_yaml(condition) + "\n";
  return text;
}

std::string reward_yaml(const RewardTerm& term) {
  std::string text = fmt::format("  - {}\n    weight: {}\n", term_to_yaml(term.term), term.weight);
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
  text += fmt::format("steps: {}\n", task.episode_steps);
  if (task.hold != 1) text += fmt::format("hold: {}\n", task.hold);
  if (task.step_cost != 0.0) text += fmt::format("step_cost: {}\n", task.step_cost);
  text += fmt::format("robot: {{at: [{}, {}]}}\n", task.robot_x, task.robot_y);
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
  for (const ObservationPart& part : task.observation) text += "  - " + part_to_yaml(part) + "\n";
  text += task.reward.empty() ? "reward: []\n" : "reward:\n";
  for (const RewardTerm& term : task.reward) text += reward_yaml(term);
  text += fmt::format("folding_reward: {}\n", task.folding_reward);
  if (!task.rules.empty()) text += "rules:\n";
  for (const Rule& rule : task.rules) text += rule_yaml(rule);
  text += "follow: " + list(task.follow) + "\n";
  return text + "physics:\n" + setting::to_yaml(physics_profiles().rows(task.physics), "  ");
}

}  // namespace evo
