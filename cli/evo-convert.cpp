// evo-convert: robots and worlds between this suite's formats and EvoGym's.
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>

#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/robots.h"
#include "cli/task_options.h"
#include "formats/foreign/minari.h"
#include "formats/foreign/onnx.h"
#include "formats/io/format.h"
#include "formats/io/hdf5.h"
#include "formats/io/npz.h"
#include "formats/robot/evogym.h"
#include "formats/robot/writer.h"
#include "formats/rollout/rollout.h"
#include "formats/task/draft.h"
#include "formats/training/policy_json.h"

namespace {

using namespace evo;
namespace fs = std::filesystem;

std::vector<Robot> read_any(const std::vector<std::string>& files) {
  std::vector<Robot> robots;
  const auto add = [&](std::vector<Robot> more) {
    std::move(more.begin(), more.end(), std::back_inserter(robots));
  };
  const std::vector<std::string> sources =
      files.empty() ? std::vector<std::string>{std::string(standard_stream)} : files;
  for (const std::string& file : sources) {
    if (file != standard_stream && fs::is_directory(file)) {
      if (!is_evogym_experiment(file))
        throw error(Failure::data, "{}: not an EvoGym experiment (no generation_0/structure in it)",
                    file);
      add(read_evogym_experiment(file));
    } else {
      add(cli::read_robots({file}));
    }
  }
  return robots;
}

// Where it first came, as it was in the end.
void keep_one_of_each(std::vector<Robot>& robots) {
  std::map<std::string, std::size_t> seen;
  std::vector<Robot> kept;
  for (Robot& robot : robots) {
    const auto [place, is_new] = seen.emplace(robot.id, kept.size());
    if (is_new)
      kept.push_back(std::move(robot));
    else if (has_gone_on(kept[place->second], robot))
      kept[place->second] = std::move(robot);
  }
  robots = std::move(kept);
}

// What holds one robot only.
const Robot& single(const std::vector<Robot>& robots, const std::string& format) {
  if (robots.size() != 1)
    throw error(Failure::usage, "--to {} writes one robot, but {} were read", format,
                robots.size());
  return robots.front();
}

// An evolution cannot continue from robots that have all failed.
void need_fitness(const std::vector<Robot>& robots) {
  std::map<std::string, int> reasons;
  for (const Robot& robot : robots) {
    if (robot.fitness()) return;
    const auto failure = robot.failure();
    ++reasons[failure ? failure->why : "no fitness"];
  }
  const auto most =
      std::ranges::max_element(reasons, {}, [](const auto& reason) { return reason.second; });
  const std::string why =
      reasons.empty() ? "none was read" : fmt::format("{} x {}", most->second, most->first);
  throw error(Failure::data,
              "none of {} robots has a fitness ({}), so there is nothing to evolve from; when the "
              "cause is mended, remove their files and give the same command again",
              robots.size(), why);
}

void write_ids(const std::vector<std::string>& files, const std::string& output) {
  LineWriter out(output);
  for (const std::string& id : cli::read_ids(files)) out.line(id);
  out.finish();
}

// The policy that a robot names, as a file of its own.
void copy_policy(const std::vector<Robot>& robots, const std::string& output) {
  const auto policy = single(robots, "policy").policy();
  if (!policy) throw error(Failure::data, "robot {} has no policy", robots.front().id);
  write_output(output, read_file(*policy));
}

// ---- what robots are written as -----------------------------------------------------

using Robots = std::vector<Robot>;

void write_lines(const Robots& robots, const std::string& output) {
  RobotWriter out(output);
  for (const Robot& robot : robots) out.write(robot);
  out.finish();
}

void write_json(const Robots& robots, const std::string& output) {
  write_output(output, robot_to_json(single(robots, "json")) + "\n");
}

void write_yaml(const Robots& robots, const std::string& output) {
  std::string text;
  for (const Robot& robot : robots) {
    if (!text.empty()) text += "---\n";
    text += robot_to_yaml(robot) + "\n";
  }
  write_output(output, text);
}

// A robot for a format that has bodies and no more.
const Robot& plain(const Robot& robot, const char* format) {
  if (!robot.body.stiffness.empty())
    throw error(Failure::data, "robot {} has factors of stiffness, which {} cannot hold", robot.id,
                format);
  return robot;
}

void write_letters(const Robots& robots, const std::string& output) {
  std::string text;
  for (const Robot& robot : robots) {
    if (!text.empty()) text += "\n";
    text += fmt::format("{}\n", fmt::join(plain(robot, "text").body.to_rows(), "\n"));
  }
  write_output(output, text);
}

void write_npz(const Robots& robots, const std::string& output) {
  write_output(output, body_to_npz(plain(single(robots, "npz"), "npz").body));
}

void write_design(const Robots& robots, const std::string& output) {
  write_output(output, evogym_world_to_json(
                           evogym_world_of_robot(plain(single(robots, "evogym"), "evogym"))));
}

// Rollouts as a dataset for offline learning.
void write_dataset(const std::vector<std::string>& files, const std::string& folder) {
  if (folder == standard_stream)
    throw error(Failure::usage, "--to minari writes a folder; name it with -o");
  std::vector<Rollout> rollouts;
  rollouts.reserve(files.size());
  for (const std::string& file : files) rollouts.push_back(read_rollout(file));
  if (rollouts.empty()) throw error(Failure::usage, "--to minari needs rollout files");
  write_minari(folder, rollouts, minari_dataset_id(rollouts.front()));
}

// The one input of formats that are no robots'.
const std::string& only(const std::vector<std::string>& files, const std::string& format,
                        const std::string& what) {
  if (files.size() != 1)
    throw error(Failure::usage, "--to {} writes one {}, but {} files are named", format, what,
                files.size());
  return files.front();
}

bool is_policy(const std::string& file) {
  return file != standard_stream && hdf5::is_hdf5(file) &&
         hdf5::Reader(file).format() == format::policy.name;
}

// A whole policy, not only its robot. Whether that is what is to be written.
bool write_policy_document(const std::vector<std::string>& files, const std::string& format,
                           const std::optional<std::string>& body, const std::string& output) {
  if (format == "onnx") {
    std::optional<Robot> robot;
    if (body) robot = single(cli::read_robots({*body}), format);
    write_output(output, policy_to_onnx(read_policy(only(files, format, "policy")), robot));
    return true;
  }
  if (body) throw Error(Failure::usage, "--robot is for --to onnx");
  if (format != "json" || files.size() != 1 || !is_policy(files.front())) return false;
  write_output(output, policy_to_json(read_policy(files.front())));
  return true;
}

// A world of the design tool as the beginning of a task.
void write_task(const std::vector<std::string>& files, const std::string& output) {
  const std::string& file = only(files, "task", "world");
  const std::string name = file == standard_stream ? "my-task" : fs::path(file).stem().string();
  write_output(output, draft_task(read_evogym_world(file, cli::log::warn), name));
}

struct Target {
  std::string name;                  // of --to
  std::vector<std::string> endings;  // of files that are written so without --to
  void (*write)(const Robots& robots, const std::string& output) = nullptr;
  // Of files that hold something else; neither for onnx, which write_policy_document() writes.
  void (*make)(const std::vector<std::string>& files, const std::string& output) = nullptr;
};

const std::vector<Target>& targets() {
  static const std::vector<Target> list{{"jsonl", {".jsonl"}, write_lines},
                                        {"json", {".json"}, write_json},
                                        {"yaml", {".yaml", ".yml"}, write_yaml},
                                        {"text", {".txt"}, write_letters},
                                        {"npz", {".npz"}, write_npz},
                                        {"onnx", {".onnx"}},
                                        {"policy", {}, copy_policy},
                                        {"ids", {}, nullptr, write_ids},
                                        {"evogym", {}, write_design},
                                        {"minari", {}, nullptr, write_dataset},
                                        {"task", {}, nullptr, write_task}};
  return list;
}

std::vector<std::string> target_names() {
  std::vector<std::string> names;
  for (const Target& target : targets()) names.push_back(target.name);
  return names;
}

// The target asked for, or the one of the output's ending, or JSON Lines.
const Target& target_of(const std::optional<std::string>& asked, const std::string& output) {
  if (asked) {
    for (const Target& target : targets())
      if (target.name == *asked) return target;
    throw error(Failure::usage, "--to: unknown format '{}'{}; allowed: {}", *asked,
                did_you_mean(*asked, target_names()), fmt::join(target_names(), ", "));
  }
  const std::string ending = fs::path(output).extension().string();
  for (const Target& target : targets())
    if (std::find(target.endings.begin(), target.endings.end(), ending) != target.endings.end())
      return target;
  if (!ending.empty())
    throw error(Failure::usage, "{}: no format has the ending {}; choose one by --to ({})", output,
                ending, fmt::join(target_names(), ", "));
  return targets().front();
}

// The world of a task, without a robot, for EvoGym's design tool.
void write_task_world(const cli::TaskOptions& options, const std::string& output) {
  World world;
  for (const Placement& placement : options.load().objects)
    world.objects.push_back(placement.object);
  write_output(output, evogym_world_to_json(world));
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-convert");
  std::vector<std::string> files;
  std::optional<std::string> format;
  std::optional<std::string> body;
  bool unique = false;
  bool bodies = false;
  bool fitness_needed = false;
  cli::TaskOptions task;
  command.arguments(files, "FILE",
                    "robots (JSON, JSON Lines, YAML, letters, .npz, design-tool JSON, policies, "
                    "rollouts) or EvoGym experiment folders [standard input]");
  command.option(
      "--to", format, "FORMAT",
      "jsonl, json (of a policy: all of it), yaml, text, npz, onnx (a policy's network), policy "
      "(the one that a robot names), ids (each once, of robots or lists), "
      "evogym (design-tool JSON), task (of a design-tool world) or minari (a dataset "
      "folder of rollouts, evo/<task>/rollouts-v0) [by the ending of -o, else jsonl]");
  command.suggestions("--to", target_names);
  command.option("--robot", body, "FILE",
                 "with --to onnx, of a modular policy: the robot that the graph is for [its own]");
  command.flag("--unique", unique,
               "each body once, where it first came, with the fitness of its longest training");
  command.flag("--bodies", bodies, "bodies alone, without fitness, parents and what else is said");
  command.flag("--need-fitness", fitness_needed, "refuse robots none of which has a fitness");
  command.option("--task", task.task, "TASK",
                 "instead of robots, the world of a task as design-tool JSON");
  command.output_option("where it goes");
  command.example("evo-convert saved_data/my_experiment -o robots.jsonl",
                  "all robots of an EvoGym experiment with their fitness");
  command.example("evo-convert best.json -o best.npz", "a robot for EvoGym's own scripts");
  command.example("evo-convert best.policy.h5 -o best.onnx", "a controller for other programs");

  return command.run(argc, argv, [&] {
    if (task.given()) {
      if (!files.empty())
        throw error(Failure::usage, "--task writes the task's world and reads no '{}'",
                    files.front());
      write_task_world(task, command.output);
      return 0;
    }
    const Target& target = target_of(format, command.output);
    const std::string& to = target.name;
    if (to != "ids") cli::keep_inputs(command.output, files);  // to which ids may be added
    if (target.make != nullptr) {
      target.make(files, command.output);
      return 0;
    }
    if (write_policy_document(files, to, body, command.output)) return 0;
    std::vector<Robot> robots = read_any(files);
    if (unique) keep_one_of_each(robots);
    if (bodies)  // what trainings and operators of another run said of them goes
      for (Robot& robot : robots) robot = Robot(robot.body);
    if (fitness_needed) need_fitness(robots);
    target.write(robots, command.output);
    return 0;
  });
}
