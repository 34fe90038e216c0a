// evo-convert: robots and worlds between this suite's formats and EvoGym's.
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>

#include "cli/command.h"
#include "cli/robots.h"
#include "cli/task_options.h"
#include "formats/evogym.h"
#include "formats/minari.h"
#include "formats/npz.h"
#include "formats/rollout.h"

namespace {

using namespace evo;
namespace fs = std::filesystem;

// A design-tool document: JSON with its grid's size.
std::optional<World> design_tool_world(const std::string& text, const std::string& name) {
  if (text.find("\"grid_width\"") == std::string::npos) return std::nullopt;
  return evogym_world_from_json(parse_json(text, name), name);
}

std::vector<Robot> read_any(const std::vector<std::string>& files) {
  std::vector<Robot> robots;
  const auto add = [&](std::vector<Robot> more) {
    std::move(more.begin(), more.end(), std::back_inserter(robots));
  };
  const std::vector<std::string> sources =
      files.empty() ? std::vector<std::string>{std::string(standard_stream)} : files;
  for (const std::string& file : sources) {
    if (file == standard_stream) {
      const std::string text = read_input(file);
      if (const auto world = design_tool_world(text, input_label(file))) {
        robots.push_back(robot_from_evogym_world(*world, input_label(file), BodyCheck::any));
      } else {
        add(parse_robots(text, input_label(file), BodyCheck::any));
      }
    } else if (fs::is_directory(file)) {
      if (!is_evogym_experiment(file))
        throw error(Failure::data, "{}: not an EvoGym experiment (no generation_0/structure in it)",
                    file);
      add(read_evogym_experiment(file));
    } else if (fs::path(file).extension() == ".npz") {
      robots.emplace_back(read_npz(file));
    } else if (fs::path(file).extension() == ".json" &&
               design_tool_world(read_file(file), file).has_value()) {
      robots.push_back(robot_from_evogym_world(read_evogym_world(file), file, BodyCheck::any));
    } else {
      add(cli::read_robots({file}, BodyCheck::any));
    }
  }
  return robots;
}

void keep_first_of_each(std::vector<Robot>& robots) {
  std::set<std::string> seen;
  std::erase_if(robots, [&](const Robot& robot) { return !seen.insert(robot.id).second; });
}

std::string letters(const Body& body) {
  return fmt::format("{}\n", fmt::join(body.to_rows(), "\n"));
}

void write_text(const std::string& output, const std::string& text) {
  if (output != standard_stream) return write_file(output, text);
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
    throw error(Failure::io, "cannot write standard output");
}

// What holds one robot only.
const Robot& single(const std::vector<Robot>& robots, const char* format) {
  if (robots.size() != 1)
    throw error(Failure::usage, "--to {} writes one robot, but {} were read", format,
                robots.size());
  return robots.front();
}

// ---- the forms robots are written in ----------------------------------------------

void write_lines(const std::vector<Robot>& robots, const std::string& output) {
  cli::RobotWriter out(output);
  for (const Robot& robot : robots) out.write(robot);
  out.finish();
}

void write_json(const std::vector<Robot>& robots, const std::string& output) {
  write_text(output, robot_to_json(single(robots, "json")) + "\n");
}

void write_yaml(const std::vector<Robot>& robots, const std::string& output) {
  std::string text;
  for (const Robot& robot : robots) {
    if (!text.empty()) text += "---\n";
    text += robot_to_yaml(robot);
  }
  write_text(output, text);
}

void write_letters(const std::vector<Robot>& robots, const std::string& output) {
  std::string text;
  for (const Robot& robot : robots) {
    if (!text.empty()) text += "\n";
    text += letters(robot.body);
  }
  write_text(output, text);
}

void write_npz(const std::vector<Robot>& robots, const std::string& output) {
  write_text(output, body_to_npz(single(robots, "npz").body));
}

void write_evogym(const std::vector<Robot>& robots, const std::string& output) {
  write_text(output,
             evogym_world_to_json(evogym_world_of_robot(single(robots, "evogym"))).dump(2) + "\n");
}

struct Target {
  const char* name;
  std::vector<std::string> endings;  // of -o that choose it
  void (*write)(const std::vector<Robot>& robots, const std::string& output);
};

// The first one is written where nothing else is said.
const std::vector<Target> targets{
    {"jsonl", {".jsonl"}, write_lines},
    {"json", {".json"}, write_json},
    {"yaml", {".yaml", ".yml"}, write_yaml},
    {"text", {".txt"}, write_letters},
    {"npz", {".npz"}, write_npz},
    {"evogym", {}, write_evogym},
};
constexpr const char* dataset = "minari";  // of rollouts, not of robots

// The format asked for, or the one the ending of the output says.
const Target& target_of(const std::optional<std::string>& asked, const std::string& output) {
  const std::string ending = fs::path(output).extension().string();
  std::vector<std::string> names;
  for (const Target& target : targets) {
    names.emplace_back(target.name);
    const auto& endings = target.endings;
    if (asked ? *asked == target.name
              : std::find(endings.begin(), endings.end(), ending) != endings.end())
      return target;
  }
  if (!asked) return targets.front();
  names.emplace_back(dataset);
  throw error(Failure::usage, "--to: unknown format '{}'{}; allowed: {}", *asked,
              did_you_mean(*asked, names), fmt::join(names, ", "));
}

// Rollouts as a dataset for offline learning.
void write_dataset(const std::vector<std::string>& files, const std::string& folder,
                   const std::optional<std::string>& id) {
  if (folder == standard_stream)
    throw error(Failure::usage, "--to minari writes a folder; name it with -o");
  std::vector<Rollout> rollouts;
  rollouts.reserve(files.size());
  for (const std::string& file : files) rollouts.push_back(read_rollout(file));
  if (rollouts.empty()) throw error(Failure::usage, "--to minari needs rollout files");
  write_minari(folder, rollouts, id.value_or(minari_dataset_id(rollouts.front())));
}

// The world of a task, without a robot, for EvoGym's design tool.
void write_task_world(const cli::TaskOptions& options, const std::string& output) {
  World world;
  for (const Placement& placement : options.load().objects)
    world.objects.push_back(placement.object);
  write_text(output, evogym_world_to_json(world).dump(2) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-convert", "robots and worlds between formats, EvoGym's included");
  std::vector<std::string> files;
  std::optional<std::string> format;
  std::optional<std::string> dataset_id;
  bool unique = false;
  cli::TaskOptions task;
  command.arguments(files, "FILE",
                    "robots (JSON, JSON Lines, YAML, letters, .npz, design-tool JSON, policies, "
                    "rollouts) or EvoGym experiment folders [standard input]");
  command.option("--to", format, "FORMAT",
                 "jsonl, json, yaml, text, npz, evogym (design-tool JSON), or minari (a dataset "
                 "folder of rollouts) [by the ending of -o, else jsonl]");
  command.option("--dataset-id", dataset_id, "ID",
                 "of the Minari dataset [evo/<task>/rollouts-v0]");
  command.flag("--unique", unique, "each body once, where it first came");
  command.option("--task", task.task, "TASK",
                 "instead of robots, the world of a task as design-tool JSON");
  command.output_option("where it goes");
  command.example("evo-convert saved_data/my_experiment -o robots.jsonl",
                  "all robots of an EvoGym experiment with their fitness");
  command.example("evo-convert best.json -o best.npz", "a robot for EvoGym's own scripts");

  return command.run(argc, argv, [&] {
    if (task.given()) {
      write_task_world(task, command.output);
      return 0;
    }
    if (format == dataset) {
      write_dataset(files, command.output, dataset_id);
      return 0;
    }
    const Target& target = target_of(format, command.output);
    std::vector<Robot> robots = read_any(files);
    if (unique) keep_first_of_each(robots);
    target.write(robots, command.output);
    return 0;
  });
}
