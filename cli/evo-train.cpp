// evo-train: a controller for every robot read.
#include <set>

#include "cli/outputs.h"
#include "cli/robots.h"
#include "cli/training_options.h"
#include "formats/robot/writer.h"

namespace {

using namespace evo;

// None of the files that the trainings write is another one's.
void check_files(const TrainingPlan& plan, const std::vector<Robot>& robots,
                 const std::string& output) {
  std::vector<cli::FileName> outputs{{"--output", output}};
  if (plan.curve) outputs.push_back({"--curve", plan.curve->string()});
  std::set<std::string> ids;
  for (const Robot& robot : robots) {
    if (!ids.insert(robot.id).second) continue;
    if (plan.shared && ids.size() > 1) continue;
    const TrainingPaths paths = training_paths(plan, robot.id);
    const std::string of = plan.shared ? "all robots" : "robot " + robot.id;
    outputs.push_back({"the policy of " + of, paths.policy.string()});
    outputs.push_back({"the checkpoint of " + of, paths.checkpoint.string()});
    outputs.push_back({"the log of " + of, paths.log.string()});
  }
  cli::check_outputs(outputs);
}

// PPO trains by whole updates; a number of steps that this cuts by more than a tenth is
// told.
void warn_of_fewer_steps(const TrainingSettings& settings) {
  const std::int64_t trained = settings.updates() * settings.batch();
  if (settings.algorithm != Algorithm("ppo") || 10 * trained >= 9 * settings.steps) return;
  cli::log::warn(
      fmt::format("{} of {} steps are trained: an update takes {} (environments x rollout)",
                  trained, settings.steps, settings.batch()));
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-train");
  cli::TrainingOptions options;
  std::vector<std::string> files;
  command.arguments(files, "FILE", "robots [standard input]");
  options.add_to(command);
  command.example("evo-sample -n 4 | evo-train --task Walker-v0 --steps 102400 --out-dir policies",
                  "four random robots, trained in parallel");
  command.example("evo-train best.json --task Climber-v0 --train paper --out-dir climb --resume",
                  "with the settings of the paper, going on after an interruption");

  command.example("evo-train --train modular --task Walker-v0 --shared one.policy.h5 bodies.jsonl",
                  "one controller for all bodies of a file, which fits any other");

  return command.run(argc, argv, [&] {
    const std::vector<Robot> robots = cli::read_robots(files);
    const TrainingPlan plan = options.plan(command.seed);
    check_files(plan, robots, command.output);
    warn_of_fewer_steps(plan.children);
    OrderedWriter out(command.output);
    const int status = cli::train_robots(command, plan, robots, [&](const Trained& trained) {
      if (trained.robot) out.put(trained.index, *trained.robot);
    });
    if (status == 0)
      out.finish();
    else
      cli::log::warn(cli::how_to_go_on);
    return status;
  });
}
