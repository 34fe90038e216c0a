#include "formats/foreign/minari.h"

#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <system_error>
#include <utility>

#include "formats/io/files.h"
#include "formats/rollout/ending.h"
#include "libevo/base/error.h"

namespace evo {
namespace fs = std::filesystem;
namespace {

constexpr const char* minari_version = "0.5.0";  // of the layout

bool is_word_sign(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
}

// "(namespace/)name-v<number>"
bool is_dataset_id(const std::string& id) {
  const std::size_t version = id.rfind("-v");
  if (version == std::string::npos || version == 0 || version + 2 == id.size()) return false;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto is_sign = [](char c) { return is_word_sign(c) || c == '/'; };
  return std::all_of(id.begin() + static_cast<std::ptrdiff_t>(version) + 2, id.end(), is_digit) &&
         std::all_of(id.begin(), id.begin() + static_cast<std::ptrdiff_t>(version), is_sign) &&
         id.front() != '/' && id[version - 1] != '/';
}

void check_length(const Rollout& rollout, std::size_t k, const char* what, std::size_t found,
                  std::size_t expected) {
  if (found != expected)
    throw error(Failure::data, "task {}, episode {}: {} numbers of {}, expected {}", rollout.task,
                k, found, what, expected);
}

void check(const std::vector<Rollout>& rollouts) {
  if (rollouts.empty()) throw Error(Failure::data, "a dataset needs at least one rollout");
  const Rollout& first = rollouts.front();
  for (const Rollout& rollout : rollouts) {
    if (rollout.observation_length != first.observation_length ||
        rollout.action_length != first.action_length)
      throw error(Failure::data,
                  "rollouts of one dataset have observations and actions of one length, but there "
                  "are {} and {} (task {}) and {} and {} (task {})",
                  first.observation_length, first.action_length, first.task,
                  rollout.observation_length, rollout.action_length, rollout.task);
    for (std::size_t k = 0; k < rollout.episodes.size(); ++k) {
      const RolloutEpisode& episode = rollout.episodes[k];
      const auto steps = static_cast<std::size_t>(episode.steps());
      check_length(rollout, k, "observations", episode.observations.size(),
                   (steps + 1) * static_cast<std::size_t>(rollout.observation_length));
      check_length(rollout, k, "actions", episode.actions.size(),
                   steps * static_cast<std::size_t>(rollout.action_length));
    }
  }
}

// A Box space of Gymnasium as Minari has it: JSON, but Python's, where numbers
// can be infinite.
std::string box_space(int length, const std::string& low, const std::string& high) {
  const auto repeated = [&](const std::string& number) {
    return fmt::format(
        "[{}]",
        fmt::join(std::vector<std::string>(static_cast<std::size_t>(length), number), ", "));
  };
  return fmt::format(
      R"({{"type": "Box", "dtype": "float64", "shape": [{}], "low": {}, "high": {}}})", length,
      repeated(low), repeated(high));
}

// All that the physics of any of the rollouts takes; the benchmark's where a file of
// another maker says nothing.
std::string action_space(const std::vector<Rollout>& rollouts) {
  std::vector<double> low;
  std::vector<double> high;
  for (const Rollout& rollout : rollouts) {
    const Physics physics = recorded_physics(rollout);
    low.push_back(physics.min_target);
    high.push_back(physics.max_target);
  }
  return box_space(rollouts.front().action_length,
                   fmt::format("{}", *std::min_element(low.begin(), low.end())),
                   fmt::format("{}", *std::max_element(high.begin(), high.end())));
}

// Gymnasium's description of the environment, as Minari keeps it: JSON in a text.
// The robot is an argument where all rollouts have the same one.
std::string environment_spec(const std::vector<Rollout>& rollouts) {
  const Rollout& first = rollouts.front();
  Json arguments{{"task", first.task}};
  const bool one_robot =
      first.robot && std::all_of(rollouts.begin(), rollouts.end(), [&](const Rollout& rollout) {
        return rollout.robot && rollout.robot->id == first.robot->id;
      });
  if (one_robot) arguments["robot"] = robot_to_document(Robot(first.robot->body));
  return compact(Json{{"id", "evo/" + first.task},
                      {"entry_point", "evo_robots.environment:Environment"},
                      {"reward_threshold", nullptr},
                      {"nondeterministic", false},
                      {"max_episode_steps", nullptr},
                      {"order_enforce", true},
                      {"disable_env_checker", false},
                      {"kwargs", std::move(arguments)},
                      {"additional_wrappers", Json::array()},
                      {"vector_entry_point", "evo_robots.vector:VectorEnvironment"}});
}

Json metadata(const std::vector<Rollout>& rollouts, const std::string& dataset_id,
              std::uintmax_t bytes) {
  std::int64_t episodes = 0;
  std::int64_t steps = 0;
  for (const Rollout& rollout : rollouts) {
    episodes += static_cast<std::int64_t>(rollout.episodes.size());
    for (const RolloutEpisode& episode : rollout.episodes) steps += episode.steps();
  }
  const Rollout& first = rollouts.front();
  constexpr double megabyte = 1e6;
  return {{"total_episodes", episodes},
          {"total_steps", steps},
          {"data_format", "hdf5"},
          {"observation_space", box_space(first.observation_length, "-Infinity", "Infinity")},
          {"action_space", action_space(rollouts)},
          {"env_spec", environment_spec(rollouts)},
          {"dataset_id", dataset_id},
          {"minari_version", minari_version},
          {"algorithm_name", first.created_by},
          {"description", fmt::format("Rollouts of soft robots, task {}", first.task)},
          {"dataset_size", std::round(10.0 * static_cast<double>(bytes) / megabyte) / 10.0},
          {"task_yaml", first.task_yaml},
          {"physics_yaml", first.physics_yaml}};
}

void write_data(const fs::path& data, const std::vector<Rollout>& rollouts,
                const std::string& dataset_id) {
  const fs::path main_data = data / "main_data.hdf5";
  hdf5::Writer file(main_data);
  std::size_t id = 0;
  for (const Rollout& rollout : rollouts) {
    for (std::size_t k = 0; k < rollout.episodes.size(); ++k) {
      const std::string group = write_episode(file, rollout, k, id++, FlagType::boolean);
      if (rollout.robot) file.attribute(group, "robot", robot_to_line(*rollout.robot));
    }
  }
  file.commit();
  write_file(data / "metadata.json",
             compact(metadata(rollouts, dataset_id, fs::file_size(main_data))) + "\n");
}

}  // namespace

std::string minari_dataset_id(const Rollout& rollout) {
  std::string task = rollout.task.empty() ? "unknown" : rollout.task;
  for (char& c : task)
    if (!is_word_sign(c)) c = '_';
  return fmt::format("evo/{}/rollouts-v0", task);
}

void write_minari(const fs::path& folder, const std::vector<Rollout>& rollouts,
                  const std::string& dataset_id) {
  if (!is_dataset_id(dataset_id))
    throw error(Failure::usage,
                "dataset id '{}': expected (namespace/)name-v<number>, of letters, digits, - and _",
                dataset_id);
  check(rollouts);
  const auto refused = [](const fs::path& path, const std::string& why) {
    return error(Failure::cannot_create, "{}: cannot be created: {}", path.string(), why);
  };
  std::error_code failed;
  const fs::path path = folder.has_filename() ? folder : folder.parent_path();
  if (fs::exists(path, failed))
    throw error(Failure::cannot_create, "{}: exists already", path.string());
  // Under a temporary name beside its own, until it is complete.
  fs::path temporary = path;
  temporary.replace_filename(fmt::format(".{}.{}.tmp", path.filename().string(), ::getpid()));
  if (!fs::create_directory(temporary, failed))
    throw refused(path, failed ? failed.message() : "its temporary name is taken");
  try {
    if (!fs::create_directory(temporary / "data", failed)) throw refused(folder, failed.message());
    write_data(temporary / "data", rollouts, dataset_id);
    fs::rename(temporary, path, failed);
    if (failed) throw refused(path, failed.message());
  } catch (...) {
    fs::remove_all(temporary, failed);
    throw;
  }
}

}  // namespace evo
