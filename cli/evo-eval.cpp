// evo-eval: episodes with a given controller, and what they earned.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>

#include "cli/command.h"
#include "cli/data.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "cli/robots.h"
#include "cli/task_options.h"
#include "formats/io/files.h"
#include "formats/io/values.h"
#include "formats/robot/writer.h"
#include "formats/rollout/episodes.h"
#include "formats/task/task.h"
#include "formats/training/policy.h"
#include "libevo/base/parallel.h"
#include "libevo/control/evaluate.h"

namespace {

using namespace evo;

struct Settings {
  cli::TaskOptions task;
  std::optional<std::string> policy;
  std::optional<std::string> actions;
  std::optional<std::string> planner;
  int episodes = 1;
  std::optional<int> max_steps;
  std::optional<std::string> draws;
  double jitter = 0.0;
  std::optional<std::string> rollout;
  bool skip_failures = false;
};

constexpr std::string_view random_actions = "random";
constexpr std::string_view sine_actions = "sine:";
constexpr std::string_view free_planner = "free";
constexpr std::string_view holding_planner = "hold";

// Where a robot is measured and what drives it.
struct Trial {
  TaskSpec task;
  Controller controller;
};

PlannerController parse_planner(const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string kind = text.substr(0, colon);
  PlannerController planner;
  if (kind == holding_planner) {
    planner.window = 40;
    planner.committed = 4;
    planner.rounds = 4;
    planner.sequence.emplace();
  } else if (kind != free_planner) {
    throw error(Failure::usage, "--planner: '{}' is neither {} nor {}", kind, free_planner,
                holding_planner);
  }
  if (colon == text.size()) return planner;
  const std::vector<int> numbers = parse_wholes(text.substr(colon + 1), "--planner", 1, 1000);
  if (numbers.size() != 4)
    throw error(Failure::usage, "--planner: '{}' is not {}:WINDOW,COMMITTED,ROUNDS,LANES", text,
                kind);
  planner.window = numbers[0];
  planner.committed = numbers[1];
  planner.rounds = numbers[2];
  planner.lanes = numbers[3];
  return planner;
}

// `task`: what --task names, if it was given; else the policy's own is used.
Trial policy_trial(const Settings& settings, const std::optional<TaskSpec>& task,
                   const Robot& robot, const std::string& path) {
  PolicyFile file = read_policy(path);
  // One for any body was trained for this one as well.
  if (file.robot.id != robot.id && !std::holds_alternative<ModularPolicy>(file.controller))
    cli::log::warn(
        fmt::format("{} was trained for robot {}, not for {}", path, file.robot.id, robot.id));
  if (task && task->name != file.task)
    cli::log::warn(fmt::format("{} was trained on {}, not on {}", path, file.task, task->name));
  if (task) return {*task, file.controller};
  TaskSpec own = policy_task(file, path);
  change_physics(own, settings.task.physics, cli::data_folders());
  return {std::move(own), file.controller};
}

Trial make_trial(const Settings& settings, const std::optional<TaskSpec>& task,
                 const Robot& robot) {
  if (settings.policy) return policy_trial(settings, task, robot, *settings.policy);
  if (!settings.actions) {
    const auto policy = robot.policy();
    if (settings.planner && !parse_planner(*settings.planner).sequence && (task || !policy))
      return {task ? *task : settings.task.load(), {}};
    if (!policy) throw error(Failure::usage, "it has no policy; give --policy or --actions");
    return policy_trial(settings, task, robot, *policy);
  }
  const TaskSpec spec = task ? *task : settings.task.load();
  const Physics& physics = spec.physics;
  const int actuators = count_actuators(robot.body);
  const std::string& actions = *settings.actions;
  if (actions == random_actions)
    return {spec, RandomController{physics.min_target, physics.max_target}};
  if (actions.starts_with(sine_actions)) {
    const std::vector<double> wave =
        parse_numbers(actions.substr(sine_actions.size()), "--actions");
    if (wave.size() != 3 || wave[1] == 0.0)
      throw error(Failure::usage, "--actions: '{}' is not sine:AMPLITUDE,PERIOD,PHASE", actions);
    return {spec, travelling_wave(actuators, wave[0], wave[1], wave[2])};
  }
  ActionSequence sequence = read_actions(actions);
  if (sequence.actuators != actuators)
    throw error(Failure::data, "{}: {} actions per step, but robot {} has {} actuators", actions,
                sequence.actuators, robot.id, actuators);
  if (sequence.is_single)  // clipped in their own type, as the benchmark does
    for (double& target : sequence.values)
      target = std::clamp(static_cast<float>(target), static_cast<float>(physics.min_target),
                          static_cast<float>(physics.max_target));
  return {spec, ReplayController{std::move(sequence.values), actuators}};
}

bool records_into_folder(const Settings& settings) {
  std::error_code unknown;
  return settings.rollout && (settings.rollout->ends_with('/') ||
                              std::filesystem::is_directory(*settings.rollout, unknown));
}

std::optional<std::string> rollout_of(const Settings& settings, const Robot& robot) {
  if (!records_into_folder(settings)) return settings.rollout;
  return (std::filesystem::path(*settings.rollout) / (robot.id + ".h5")).string();
}

void check_files(const Settings& settings, const std::vector<Robot>& robots,
                 const std::vector<std::string>& files, const std::string& output) {
  std::vector<cli::FileName> rollouts;
  std::vector<cli::FileName> inputs;
  const auto reads = [&](const std::string& what, const std::optional<std::string>& path) {
    if (path) inputs.push_back({what, *path});
  };
  reads("the policy", settings.policy);
  if (settings.actions != random_actions) reads("the actions", settings.actions);
  reads("the draws", settings.draws);
  std::set<std::string> ids;
  for (const Robot& robot : robots) {
    if (!ids.insert(robot.id).second) continue;
    reads("the policy of robot " + robot.id, robot.policy());
    if (const auto rollout = rollout_of(settings, robot))
      rollouts.push_back({"--rollout", *rollout});
  }
  std::vector<cli::FileName> outputs{{"--output", output}};
  outputs.insert(outputs.end(), rollouts.begin(), rollouts.end());
  cli::check_outputs(outputs, inputs);
  // Robots may go where they came from, with their fitness; rollouts are something else.
  for (const std::string& file : files) reads("the robots", file);
  cli::check_outputs(rollouts, inputs);
}

// `threads`: for this robot.
Robot measure(const Settings& settings, const std::optional<TaskSpec>& task, const Robot& robot,
              std::uint64_t seed, int threads) {
  const std::optional<std::string> rollout_path = rollout_of(settings, robot);
  const Trial trial = make_trial(settings, task, robot);
  const Arena arena(trial.task, robot.body);
  if (const int limit = arena.task().episode_steps; settings.max_steps.value_or(0) > limit)
    throw error(Failure::usage,
                "--max-steps {}: episodes of {} end after {} steps; for longer ones, change "
                "`steps` in a copy of the task (docs/make-a-task.md)",
                *settings.max_steps, arena.task().name, limit);
  EvaluationSettings evaluation;
  evaluation.episodes = settings.episodes;
  evaluation.seed = seed;
  evaluation.jitter = settings.jitter;
  evaluation.max_steps = settings.max_steps.value_or(0);
  evaluation.threads = threads;
  if (settings.draws) evaluation.draws = parse_draws(*settings.draws, arena.task());

  Controller controller = trial.controller;
  if (settings.planner) {
    PlannerController planner = parse_planner(*settings.planner);
    EvaluationSettings unperturbed = evaluation;
    unperturbed.jitter = 0.0;
    if (planner.sequence) planner.sequence = recorded(arena, controller, unperturbed);
    controller = std::move(planner);
  }

  std::optional<Recorder> recorder;
  if (rollout_path) recorder.emplace(arena, robot, seed, "evo-eval");
  BehaviourGauge gauge;
  const Evaluation result =
      evaluate(arena, controller, evaluation, [&](const EpisodeMoment& moment) {
        if (recorder) recorder->record(moment);
        gauge.record(moment);
      });
  if (recorder) write_rollout(*rollout_path, recorder->rollout());

  Robot measured = robot;
  measured.set_fitness(result.mean());
  measured.document["task"] = arena.task().name;
  measured.document["behaviour"] = gauge.mean();
  measured.document["returns"] = result.returns;
  measured.document["lengths"] = result.lengths;
  return measured;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-eval");
  Settings settings;
  std::vector<std::string> files;
  command.arguments(files, "FILE", "robots, policies or rollouts [standard input]");
  command.section("Task");
  settings.task.add_to(command, " [the one the policy was trained on; else required]");
  command.section("Controller (default: the policy named by each robot)");
  const cli::Option policy = command.option("--policy", settings.policy, "FILE.h5",
                                            "a trained policy, for every robot read");
  const cli::Option actions =
      command
          .option(
              "--actions", settings.actions, "WHAT",
              "random: uniform targets; sine:A,PERIOD,PHASE: 1.1 + A sin(2 pi t / PERIOD + PHASE "
              "i) "
              "of actuator i, in control steps and radian; or a file of actions [T, A]: a rollout, "
              "another HDF5 file, NumPy's, or a CSV")
          .excludes({policy});
  command
      .option(
          "--planner", settings.planner, "WHAT",
          "plan in the simulation: free, to earn the most; hold, to come back to the way of the "
          "policy's unperturbed episode; either with :WINDOW,COMMITTED,ROUNDS,LANES "
          "[free:96,16,8,8 hold:40,4,4,8]")
      .excludes({actions});
  command.section("Episodes");
  command.option("--episodes", settings.episodes, "N", "episodes of each robot").at_least(1);
  command
      .option("--max-steps", settings.max_steps, "N",
              "end episodes after N control steps [the task's limit]")
      .at_least(1);
  command.option("--draws", settings.draws, "JSON|FILE",
                 "what a random task draws, such as '{\"ox\":0,\"oy\":3}', or a rollout to take it "
                 "from");
  command
      .option("--jitter", settings.jitter, "VOXELS",
              "move every start coordinate by up to this, to test robustness")
      .between(0.0, 0.49);
  command.seed_option();
  command.section("Output");
  command.output_option("where the robots go, with fitness, returns and lengths");
  command.option("--rollout", settings.rollout, "FILE.h5|DIR/",
                 "record the episodes of one robot, or in a folder of each: DIR/<id>.h5");
  command.choice("--failures", settings.skip_failures, "WHAT", {{"stop", false}, {"skip", true}},
                 "a robot that cannot be measured: stop, or skip (fitness null)");
  command.jobs_option();
  command.progress_option();
  command.example("evo-sample -n 9 | evo-eval --task Walker-v0 --actions sine:0.5,20,0.7",
                  "how far random bodies get on a travelling wave");
  command.example("evo-eval best.json --episodes 20 --jitter 1e-4 --rollout best.h5",
                  "a trained robot from slightly different starts, recorded");

  return command.run(argc, argv, [&] {
    std::optional<TaskSpec> task;
    if (settings.task.given()) task = settings.task.load();
    const std::vector<Robot> robots = cli::read_robots(files);
    const bool records_each = records_into_folder(settings);
    if (settings.rollout && !records_each && robots.size() != 1)
      throw error(Failure::usage,
                  "--rollout {0} records one robot, but {1} were read; {0}/ is a folder for each",
                  *settings.rollout, robots.size());
    check_files(settings, robots, files, command.output);
    if (records_each) make_folders(*settings.rollout);
    OrderedWriter out(command.output);
    // Robots that go to the terminal are progress enough.
    const bool shows = command.progress == "auto" && command.output == standard_stream &&
                       ::isatty(STDOUT_FILENO) == 1;
    cli::TrainingProgress progress(shows ? cli::Progress::none : command.progress_style(),
                                   robots.size());
    cli::Workers workers(command, robots.size());
    const int threads = std::max(1, command.jobs / std::max(1, static_cast<int>(robots.size())));
    workers.pool.run(robots.size(), [&](std::size_t i, int /*worker*/) {
      const Robot& robot = robots[i];
      try {
        Robot measured = measure(settings, task, robot, command.seed, threads);
        double steps = 0.0;
        for (const Json& length : measured.document.at("lengths")) steps += length.get<double>();
        progress.update(i, {robot.id, 1.0, {}, 0.0, steps});
        out.put(i, std::move(measured));
      } catch (const Error& e) {
        if (!settings.skip_failures || e.kind() != Failure::work) throw e.at("robot " + robot.id);
        out.put(i, robot.failed({e.what(), std::nullopt, command.seed}));
      }
      progress.finish(i);
    });
    out.finish();
    return 0;
  });
}
