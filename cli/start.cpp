#include "cli/start.h"

#include <filesystem>

#include "formats/training/policy.h"
#include "libevo/base/digest.h"
#include "libevo/base/error.h"
#include "libevo/control/transfer.h"

namespace evo {
namespace {

namespace fs = std::filesystem;

// A robot's policy in the folder.
std::optional<fs::path> policy_in(const fs::path& folder, const std::string& id) {
  if (const fs::path path = folder / (id + ".policy.h5"); fs::exists(path)) return path;
  return std::nullopt;
}

// The policy that a robot starts from. Founders may have one of their own; in a folder of
// parents' it is that of the first parent which has one. Nothing: from scratch.
std::optional<fs::path> inherited_policy(const TrainingPlan& plan, const Robot& robot) {
  if (plan.own) return policy_in(*plan.own, robot.id);
  const std::vector<std::string> parents = robot.parents();
  if (parents.empty() && plan.founders_from) {
    if (fs::is_regular_file(*plan.founders_from)) return plan.founders_from;
    if (auto own = policy_in(*plan.founders_from, robot.id)) return own;
    throw error(Failure::no_input, "{}: has no policy of robot {} to continue from",
                *plan.founders_from, robot.id);
  }
  if (!plan.init) return std::nullopt;
  if (plan.shared && fs::is_directory(*plan.init))
    throw error(Failure::usage,
                "--init {}: one controller for all robots starts from one policy, not from those "
                "of a folder",
                *plan.init);
  if (!fs::is_directory(*plan.init)) return plan.init;
  for (const std::string& parent : parents)
    if (auto path = policy_in(*plan.init, parent)) return path;
  return std::nullopt;
}

// How many robots, and which.
std::string names_of_all(const std::vector<const Arena*>& robots) {
  std::string ids;
  for (const Arena* robot : robots) ids += identity(robot->robot()) + "\n";
  return fmt::format("{} {}", robots.size(), sha256_hex(ids));
}

TrainingIdentity identity_of(const TrainingPlan& plan, const Robot& robot, std::int64_t steps,
                             const TrainingOrigin& origin) {
  TrainingSettings settings = plan.settings(robot);
  settings.steps = steps;
  return identify(robot.body, plan.task, settings, plan.seed, origin);
}

// The checkpoint is of this training, or the end of one with fewer steps.
void go_on(const TrainingPlan& plan, const Robot& robot, const std::vector<const Arena*>& robots,
           const fs::path& path, TrainingStart& start) {
  const TrainingSettings& settings = plan.settings(robot);
  const auto span = span_of_same(read_checkpoint_identity(path), start.identity.lines);
  if (!span || span->steps > settings.steps) {
    start.checkpoint = read_checkpoint(path, start.identity);  // an old one, or says what differs
    return;
  }
  start.origin.parts = span->parts;
  start.checkpoint = read_checkpoint(path, identity_of(plan, robot, span->steps, start.origin));
  if (span->steps < settings.steps) {
    TrainingSettings of_part = settings;
    of_part.steps = span->steps;
    Trainer part(robots, of_part, plan.seed, stream_name(plan, robot), start.inheritance);
    restore(part, *start.checkpoint, path);
    if (!part.done())
      throw error(Failure::cannot_create,
                  "{}: belongs to a training of {} steps that has not ended; finish it first, or "
                  "remove it to start afresh",
                  path.string(), span->steps);
    start.origin.parts.push_back(span->steps);
  }
  start.identity = identity_of(plan, robot, settings.steps, start.origin);
}

}  // namespace

void restore(Trainer& trainer, const Checkpoint& checkpoint, const fs::path& path) {
  try {
    trainer.restore(checkpoint);
  } catch (const Error& e) {
    throw error(
        e.kind(),
        "{}: {}; perhaps it is from another version of evo-train: remove it to start afresh",
        path.string(), e.what());
  }
}

bool is_part(const std::string& identity, const TrainingStart& start) {
  return start.checkpoint && span_of_same(identity, start.identity.lines);
}

TrainingStart find_start(const TrainingPlan& plan, const Robot& robot,
                         const std::vector<const Arena*>& robots) {
  TrainingStart start;
  if (plan.shared) start.origin.robots = names_of_all(robots);
  if (const auto path = inherited_policy(plan, robot)) {
    const PolicyFile file = read_policy(*path);
    start.inheritance = Inheritance{file.controller, anatomy(file.robot.body, file.layout)};
    start.origin.inherited = file.settings_hash;
  }
  start.identity = identity_of(plan, robot, plan.settings(robot).steps, start.origin);
  if (const fs::path path = training_paths(plan, robot.id).checkpoint;
      plan.resume && fs::exists(path))
    go_on(plan, robot, robots, path, start);
  return start;
}

}  // namespace evo
