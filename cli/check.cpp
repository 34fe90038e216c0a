#include "cli/check.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <span>

#include "cli/documents.h"
#include "cli/run_source.h"
#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/hdf5.h"
#include "formats/io/npz.h"
#include "formats/io/text.h"
#include "formats/rollout/episodes.h"
#include "formats/rollout/rollout.h"
#include "formats/run/run.h"
#include "formats/task/task.h"
#include "formats/training/policy.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/method.h"

namespace evo::cli {
namespace {

namespace fs = std::filesystem;

// What the policies in question say, each read once.
class Policies {
 public:
  explicit Policies(bool replay) : replay_(replay) {}
  bool replays() const { return replay_; }

  // Throws Error for a policy that is not what it says.
  const PolicyFile& at(const fs::path& path) {
    const auto [found, added] = known_.try_emplace(fs::weakly_canonical(path).string());
    if (added) {
      found->second = read_policy(path);
      if (replay_) replay(path, *found->second);
    }
    if (!found->second) throw error(Failure::data, "{}: refused above", path.string());
    return *found->second;
  }

 private:
  // For a task that no tool knows: the return of the episode recorded beside it, in which the
  // policy has to act as it does at what was observed.
  static double recorded_return(const fs::path& path, const PolicyFile& policy) {
    const Rollout rollout = play(policy, path, "");
    const RolloutEpisode& episode = rollout.episodes.front();
    const auto* network = std::get_if<Policy>(&policy.controller);
    std::vector<double> actions(episode.actions.size());
    std::vector<std::int32_t> steps(episode.rewards.size());
    std::iota(steps.begin(), steps.end(), 0);
    const bool fits = network != nullptr && !actions.empty() &&
                      rollout.observation_length == network->observation_length() &&
                      rollout.action_length == network->action_length();
    if (fits)
      act(*network,
          std::span(episode.observations)
              .first(steps.size() * static_cast<std::size_t>(rollout.observation_length)),
          steps, actions);
    if (!fits || actions != episode.actions)
      throw error(Failure::data, "{}: acts otherwise than in the episode recorded beside it",
                  path.string());
    return std::accumulate(episode.rewards.begin(), episode.rewards.end(), 0.0);
  }
  static void replay(const fs::path& path, const PolicyFile& policy) {
    const std::string name = path.string();
    const Node training = Node::yaml(policy.training_yaml, name + ": training");
    EvaluationSettings evaluation;
    evaluation.seed = policy.seed;
    for (const auto& [key, value] : training.entries()) {
      if (key.text() == "evaluation_episodes") evaluation.episodes = value.integer(1);
      if (key.text() == "evaluation_jitter") evaluation.jitter = value.number(0.0);
    }
    double again = 0.0;
    if (policy.task_yaml.empty()) {
      again = recorded_return(path, policy);
      if (evaluation.episodes > 1 || evaluation.jitter != 0.0) return;
    } else {
      const Arena arena(policy_task(policy, name), policy.robot.body);
      again = evaluate(arena, policy.controller, evaluation).mean();
    }
    if (again != policy.fitness)
      throw error(Failure::data, "{}: earns {}, not its fitness of {}", name, again,
                  policy.fitness);
  }

  bool replay_;
  std::map<std::string, std::optional<PolicyFile>> known_;
};

std::string check_hdf5(const fs::path& path, Policies& policies) {
  const hdf5::Reader file(path);
  const std::string found = file.format();
  if (found == format::policy.name) {
    const PolicyFile& policy = policies.at(path);
    const std::string stem = path.stem().stem().string();
    const bool named_by_id = path.string().ends_with(".policy.h5") && stem.size() == 12 &&
                             stem.find_first_not_of("0123456789abcdef") == std::string::npos;
    if (named_by_id && stem != policy.robot.id)
      throw error(Failure::data, "{}: holds the policy of robot {}", path.string(),
                  policy.robot.id);
    return "policy of robot " + policy.robot.id;
  }
  if (found == format::checkpoint.name) {
    TrainingIdentity own;
    own.lines = file.text("/", "identity");
    (void)read_checkpoint(path, own);
    return "checkpoint";
  }
  const Rollout rollout = read_rollout(path);
  return fmt::format("rollout, {} episodes", rollout.episodes.size());
}

void check_policy_of(const Robot& robot, const fs::path& folder, Policies& policies) {
  const auto named = robot.document.find("policy");
  if (named == robot.document.end() || !named->is_string()) return;
  const fs::path path = folder / named->get<std::string>();
  const PolicyFile& policy = policies.at(path);
  if (policy.robot.id != robot.id)
    throw error(Failure::data, "robot {}: {} is the policy of robot {}", robot.id, path.string(),
                policy.robot.id);
  const auto fitness = robot.fitness();
  // Evaluated otherwise later, it has returns of its own.
  if (fitness && *fitness != policy.fitness && !robot.document.contains("returns"))
    throw error(Failure::data, "robot {}: fitness {}, but its policy earned {}", robot.id, *fitness,
                policy.fitness);
}

std::string check_file(const fs::path& path, Policies& policies) {
  if (hdf5::is_hdf5(path)) return check_hdf5(path, policies);
  if (path.extension() == ".npz") {
    (void)read_npz(path);
    return "structure";
  }
  if (path.filename() == "run.yaml") {
    const RunSettings settings = RunSettings::read(path);
    if (policies.replays()) check_source(settings, path.string());
    return "settings of a run";
  }
  const std::string text = read_robot_text(path.string());
  if (const auto document = describe_document(text, path.string())) return document->kind;
  const std::vector<Robot> robots = parse_robots(text, path.string());
  for (const Robot& robot : robots) check_policy_of(robot, path.parent_path(), policies);
  return robots.size() == 1 ? "robot " + robots.front().id
                            : fmt::format("{} robots", robots.size());
}

// Files that are formats of ours; a run folder holds logs, tables and videos, too.
bool is_ours(const fs::path& path) {
  const std::string name = path.filename().string();
  return !name.starts_with('.') &&
         (name == "run.yaml" || name.ends_with(".h5") || name.ends_with(".npz") ||
          name.ends_with(".json") || name == "population.jsonl" || name == "scores.jsonl" ||
          name == "history.jsonl");
}

std::vector<fs::path> files_of(const std::string& name) {
  if (!fs::is_directory(name)) return {name};
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(name))
    if (entry.is_regular_file() && is_ours(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

void check_paths(const std::vector<std::string>& paths, bool replay) {
  Policies policies(replay);
  std::size_t refused = 0;
  std::size_t files = 0;
  for (const std::string& name : paths)
    for (const fs::path& path : files_of(name)) {
      ++files;
      try {
        fmt::print("{}: ok, {}\n", printable(path.string()), printable(check_file(path, policies)));
      } catch (const Error& e) {
        if (e.kind() == Failure::io) throw;
        ++refused;
        const std::string what = printable(e.what());
        const std::string where = printable(path.string());
        fmt::print("{}\n", what.starts_with(where) ? what : where + ": " + what);
      }
    }
  if (refused > 0)
    throw error(Failure::data, "{} of {} files are not what they say", refused, files);
}

}  // namespace evo::cli
