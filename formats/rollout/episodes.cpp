#include "formats/rollout/episodes.h"

#include <algorithm>

#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "libevo/base/error.h"
#include "libevo/base/join.h"

namespace evo {
namespace {

void append(std::vector<double>& to, std::span<const double> values) {
  to.insert(to.end(), values.begin(), values.end());
}

}  // namespace

Recorder::Recorder(const Arena& arena, const Robot& robot, std::uint64_t seed,
                   const std::string& created_by) {
  const Model& model = arena.model();
  rollout_.task = arena.task().name;
  rollout_.task_yaml = arena.task().source;
  rollout_.physics_yaml = physics_profiles().to_yaml(arena.task().physics);
  rollout_.robot = robot;
  rollout_.seed = seed;
  rollout_.created_by = created_by;
  rollout_.observation_length = arena.observation_length();
  rollout_.action_length = arena.action_length();
  rollout_.points = model.points();
  rollout_.world = {model.objects(), model.cells()};
}

void Recorder::record(const EpisodeMoment& moment) {
  const auto index = static_cast<std::size_t>(moment.episode);
  if (rollout_.episodes.size() <= index) rollout_.episodes.resize(index + 1);
  RolloutEpisode& episode = rollout_.episodes[index];
  const VecEnv& env = moment.env;
  const auto lane = static_cast<std::size_t>(moment.lane);
  if (moment.targets.empty()) {
    episode.seed = rollout_.seed;
    episode.random_draws = draws_to_json(moment.start.draws);
    episode.jitter = moment.start.jitter;
    episode.jitter_seed = moment.start.jitter_seed;
  } else {
    append(episode.actions, moment.targets);
    episode.rewards.push_back(env.rewards()[lane]);
    episode.terminations.push_back(env.terminated()[lane]);
    episode.truncations.push_back(env.truncated()[lane]);
  }
  append(episode.observations,
         env.observations().subspan(env.observation_offset(moment.lane),
                                    static_cast<std::size_t>(rollout_.observation_length)));
  const auto positions = env.positions(moment.lane);
  episode.positions.insert(episode.positions.end(), positions.begin(), positions.end());
}

void BehaviourGauge::record(const EpisodeMoment& moment) {
  const auto index = static_cast<std::size_t>(moment.episode);
  if (episodes_.size() <= index) episodes_.resize(index + 1);
  episodes_[index].add(moment.env.model(moment.lane), moment.env.positions(moment.lane));
}

Json BehaviourGauge::mean() const {
  Json json = Json::object();
  for (const BehaviourFeature& feature : behaviour_features) {
    double sum = 0.0;
    for (const BehaviourMeter& episode : episodes_) sum += episode.behaviour().*feature.value;
    json[feature.name] = sum / static_cast<double>(episodes_.size());
  }
  return json;
}

std::filesystem::path recorded_beside(const std::filesystem::path& policy) {
  std::filesystem::path stem = policy.stem();  // FILE.policy
  return policy.parent_path() / stem.replace_extension(".rollout.h5");
}

Rollout play(const PolicyFile& policy, const std::filesystem::path& file,
             const std::string& created_by) {
  if (policy.task_yaml.empty() && !file.empty()) {
    const std::filesystem::path beside = recorded_beside(file);
    Rollout recorded = read_rollout(beside);
    if (!recorded.robot || recorded.robot->id != policy.robot.id)
      throw error(Failure::data, "{}: is not of robot {}, whose policy is {}", beside.string(),
                  policy.robot.id, file.string());
    return recorded;
  }
  const Arena arena(policy_task(policy, "robot " + policy.robot.id), policy.robot.body);
  EvaluationSettings settings;
  settings.seed = policy.seed;
  Recorder recorder(arena, policy.robot, policy.seed, created_by);
  evaluate(arena, policy.controller, settings,
           [&](const EpisodeMoment& moment) { recorder.record(moment); });
  return recorder.rollout();
}

Json draws_to_json(const Draws& draws) {
  Json json = Json::object();
  for (const auto& [name, value] : draws.integers) json[name] = value;
  if (!draws.goals.empty()) json["goals"] = draws.goals;
  return json;
}

Draws read_draws(const Node& node, const TaskSpec& task) {
  std::vector<std::string> names;
  for (const DrawnInteger& drawn : task.draws) names.push_back(drawn.name);
  if (task.goals) names.push_back("goals");
  Draws draws;
  for (const auto& [key, value] : node.entries()) {
    const std::string& name = key.text();
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw key.error(fmt::format("{} draws nothing named '{}'{}; it draws: {}", task.name, name,
                                  did_you_mean(name, names),
                                  names.empty() ? "nothing" : joined(names, ", ")));
    if (name == "goals" && task.goals) {
      for (const Node& goal : value.items()) draws.goals.push_back(goal.integer());
      if (draws.goals.empty()) throw value.error("a list of integers is expected, found none");
    } else {
      draws.integers[name] = value.integer();
    }
  }
  for (const std::string& name : names) (void)node.at(name);
  return draws;
}

Draws parse_draws(const std::string& text_or_file, const TaskSpec& task) try {
  if (text_or_file.find('{') == std::string::npos)
    return read_draws(to_node(read_draws(text_or_file), text_or_file), task);
  return read_draws(Node::json(text_or_file, "--draws"), task);
} catch (const Error& failure) {
  if (failure.kind() != Failure::data) throw;
  throw Error(Failure::usage, failure.what());
}

}  // namespace evo
