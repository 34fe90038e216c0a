#include "formats/task/task.h"

#include <algorithm>
#include <optional>

#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/task/physics_profile.h"
#include "formats/task/pieces.h"
#include "formats/task/world.h"

namespace evo {
namespace fs = std::filesystem;
namespace {

constexpr int most_steps = 10'000'000;
constexpr int longest_hold = 1000;          // control steps
constexpr int largest_draw = 100'000;       // voxels
constexpr int longest_goal_path = 100'000;  // voxels
constexpr int longest_chain = 16;           // of tasks that start from one another

// load_task, for a task that `depth` others start from, one from the other.
TaskSpec load(const std::string& name_or_file, const DataFolders& folders, int depth);

Rule read_rule(const Node& node, const Scope& scope) {
  const Mapping mapping(node, "rule", {"when", "reward", "terminate"});
  Rule rule;
  rule.when = read_conditions(mapping.at("when"), scope);
  if (const auto reward = mapping.find("reward")) rule.reward = reward->number();
  if (const auto terminate = mapping.find("terminate")) rule.terminate = terminate->boolean();
  return rule;
}

// ---- random parts -----------------------------------------------------------------------

std::vector<Node> read_range(const Node& node) {
  std::vector<Node> bounds = node.items();
  if (bounds.size() == 2) return bounds;
  throw node.error("a range [low, high] of whole numbers, both included, is expected");
}

std::vector<DrawnInteger> read_draws(const Node& node) {
  std::vector<DrawnInteger> draws;
  for (const auto& [name, range] : node.entries()) {
    const auto bounds = read_range(range);
    const int low = bounds[0].integer(-largest_draw, largest_draw);
    draws.push_back({name.string(), low, bounds[1].integer(low, largest_draw)});
  }
  return draws;
}

DrawnGoals read_goals(const Node& node) {
  const Mapping mapping(node, "goals", {"start", "between", "distance", "radius"});
  DrawnGoals goals;
  goals.start = mapping.at("start").integer(-largest_draw, largest_draw);
  const auto bounds = read_range(mapping.at("between"));
  goals.low = bounds[0].integer(-largest_draw, largest_draw - 1);
  goals.high = bounds[1].integer(goals.low + 1, largest_draw);
  goals.distance = mapping.at("distance").integer(1, longest_goal_path);
  goals.radius = mapping.at("radius").positive();
  return goals;
}

// ---- the task -----------------------------------------------------------------------------

// What `load` makes of the profile or task that a node names; a file is looked for in `folder`.
template <typename Load>
auto load_named(const Node& node, const fs::path& folder, Load load) {
  const std::string name = node.string();
  try {
    return load(is_file_name(name) ? (folder / name).string() : name);
  } catch (const Error& failure) {
    if (failure.kind() == Failure::data) throw;
    throw node.error(failure.what());
  }
}

// A profile by name or file, or constants given in the task itself.
Physics read_physics(const Node& node, const fs::path& folder, const DataFolders& folders) {
  if (node.is_mapping()) return physics_profiles().read(node, folder, folders);
  return load_named(node, folder, [&](const std::string& name) {
    return physics_profiles().load(name, folders);
  });
}

std::vector<std::string> read_words(const Node& node) {
  std::vector<std::string> words;
  for (const Node& item : node.items()) words.push_back(item.string());
  return words;
}

std::string read_task_name(const Node& node) {
  std::string name = node.string();
  if (is_file_name(name) || name.find_first_of(" \t\n") != std::string::npos)
    throw node.error("a name without spaces, '/' or '.yaml' is expected, found " + node.found());
  return name;
}

Mapping task_mapping(std::string_view text, const std::string& where) {
  Mapping mapping(
      Node::yaml(text, where), "task",
      {"format", "version",     "name",   "aliases",        "base",  "difficulty", "description",
       "notes",  "steps",       "hold",   "step_cost",      "robot", "world",      "draws",
       "goals",  "observation", "reward", "folding_reward", "rules", "follow",     "physics"});
  check_format(mapping.node(), format::task);
  return mapping;
}

bool names_file(const Node& world) {
  if (world.is_scalar()) return true;
  const auto& entries = world.entries();
  return std::any_of(entries.begin(), entries.end(),
                     [](const Node::Entry& entry) { return entry.key.string() == "file"; });
}

// The task that another starts from, `depth` others that one.
Mapping read_base(const Node& node, const fs::path& folder, const DataFolders& folders, int depth) {
  if (depth >= longest_chain) throw node.error("tasks start from one another in a circle");
  return load_named(node, folder, [&](const std::string& name) {
    return task_mapping(load(name, folders, depth + 1).source, name);
  });
}

// The text needs no other file: no base, no world file, no profile but the built-in one.
bool is_complete(const Mapping& mapping, const TaskSpec& task) {
  if (mapping.has("base") || names_file(mapping.at("world"))) return false;
  const auto physics = mapping.find("physics");
  const bool built_in = !physics || (physics->is_scalar() && physics->string() == "evogym");
  return built_in && task.physics == Physics{};
}

TaskSpec read_task(std::string_view text, const std::string& where, const fs::path& folder,
                   const DataFolders& folders, int depth) {
  Mapping mapping = task_mapping(text, where);
  TaskSpec task;
  task.name = read_task_name(mapping.at("name"));
  if (const auto aliases = mapping.find("aliases")) task.aliases = read_words(*aliases);
  if (const auto base = mapping.find("base"))
    mapping.complete_from(read_base(*base, folder, folders, depth));
  if (const auto difficulty = mapping.find("difficulty"))
    task.difficulty = difficulty->choice("difficulty", {"easy", "medium", "hard"});
  if (const auto description = mapping.find("description"))
    task.description = description->string();
  if (const auto notes = mapping.find("notes")) task.notes = read_words(*notes);
  task.episode_steps = mapping.at("steps").integer(1, most_steps);
  if (const auto hold = mapping.find("hold")) task.hold = hold->integer(1, longest_hold);
  if (const auto cost = mapping.find("step_cost")) task.step_cost = cost->number();

  const Mapping robot(mapping.at("robot"), "robot", {"at"});
  const Node at = robot.at("at");
  if (at.items().size() != 2) throw at.error("a cell [x, y] is expected");
  task.robot_x = at.items()[0].integer(0, largest_draw);
  task.robot_y = at.items()[1].integer(0, largest_draw);

  if (const auto draws = mapping.find("draws")) task.draws = read_draws(*draws);
  if (const auto goals = mapping.find("goals")) task.goals = read_goals(*goals);
  task.objects = world_from_yaml(mapping.at("world"), folder, task.draws);

  Scope scope{{robot_name}, task.goals.has_value()};
  for (const Placement& placement : task.objects) scope.objects.push_back(placement.object.name);
  for (const Node& part : mapping.at("observation").items())
    task.observation.push_back(read_part(part, scope));
  for (const Node& term : mapping.at("reward").items())
    task.reward.push_back(read_reward(term, scope));
  if (const auto folding = mapping.find("folding_reward")) task.folding_reward = folding->number();
  if (const auto rules = mapping.find("rules"))
    for (const Node& rule : rules->items()) task.rules.push_back(read_rule(rule, scope));
  if (const auto follow = mapping.find("follow")) {
    task.follow.clear();
    for (const Node& object : follow->items()) task.follow.push_back(read_object(object, scope));
  }
  if (task.observation.empty())
    throw mapping.at("observation").error("at least one observation part is expected");

  if (const auto physics = mapping.find("physics"))
    task.physics = read_physics(*physics, folder, folders);
  else
    task.physics = physics_profiles().load("evogym", folders);
  task.source = is_complete(mapping, task) ? std::string(text) : task_to_yaml(task);
  return task;
}

// ---- finding -----------------------------------------------------------------------------------

TaskSpec load_file(const fs::path& path, const DataFolders& folders, int depth) {
  return read_task(read_file(path, largest_document), path.string(), path.parent_path(), folders,
                   depth);
}

// The aliases in a task file; nothing for other YAML that lives in the folder. Throws Error(data)
// for a file that is not YAML.
std::optional<std::vector<std::string>> task_aliases(const fs::path& path) {
  const Node root = Node::yaml(read_file(path, largest_document), path.string());
  std::vector<std::string> aliases;
  bool is_task = false;
  for (const auto& [key, value] : root.entries()) {
    if (key.string() == "format") is_task = value.string() == format::task.name;
    if (key.string() == "aliases") aliases = read_words(value);
  }
  return is_task ? std::optional(aliases) : std::nullopt;
}

// "Walker" of "Walker-v0".
std::string without_version(const std::string& name) { return name.substr(0, name.rfind("-v")); }

// The task whose name was misspelt, or that was given without its version.
std::string task_meant(const std::string& word, const std::vector<std::string>& names) {
  if (std::string name = nearest(word, names); !name.empty()) return name;
  std::vector<std::string> stems;
  for (const std::string& name : names) stems.push_back(without_version(name));
  const std::string stem = nearest(word, stems);
  const auto found = std::find(stems.begin(), stems.end(), stem);
  return found == stems.end() ? "" : names[static_cast<std::size_t>(found - stems.begin())];
}

// The file of this name: a benchmark task's, or that of an easier world for one.
std::optional<fs::path> find_task(const DataFolders& folders, const std::string& name) {
  auto path = find_data_file(folders, "", name);
  return path ? path : find_data_file(folders, "easier", name);
}

// What may have been meant by a name that no task has.
std::string hint(const std::string& word, const std::vector<std::string>& names) {
  std::error_code ignored;
  if (fs::is_regular_file(word, ignored))
    return fmt::format(" (a file is given with its folder: './{}')", word);
  const std::string meant = task_meant(word, names);
  return meant.empty() ? "" : " (did you mean '" + meant + "'?)";
}

TaskSpec load(const std::string& name_or_file, const DataFolders& folders, int depth) {
  if (is_file_name(name_or_file)) {
    std::error_code ignored;
    const std::string stem = fs::path(name_or_file).stem().string();
    if (!fs::exists(name_or_file, ignored) && find_task(folders, stem))
      throw error(Failure::no_input, "{}: no such file; the task of that name is given as '{}'",
                  name_or_file, stem);
    return load_file(name_or_file, folders, depth);
  }
  const auto path = find_task(folders, name_or_file);
  if (path && task_aliases(*path)) return load_file(*path, folders, depth);

  std::vector<std::string> names;
  std::string unreadable;  // the first file that may be what is looked for
  for (const std::string& name : data_names(folders, "")) {
    const fs::path file = *find_data_file(folders, "", name);
    std::optional<std::vector<std::string>> aliases;
    try {
      aliases = task_aliases(file);
    } catch (const Error& failure) {
      if (unreadable.empty()) unreadable = fmt::format("; not read: {}", failure.what());
    }
    if (!aliases) continue;
    if (std::find(aliases->begin(), aliases->end(), name_or_file) != aliases->end())
      return load_file(file, folders, depth);
    names.push_back(name);
  }
  if (name_or_file.find(".py:") != std::string::npos)
    throw error(Failure::usage,
                "{} is a task in Python, which `evo evolve` and `python3 -m evo_robots` know",
                name_or_file);
  throw error(Failure::usage,
              "unknown task '{}'{}; `evo-inspect tasks` lists them, a task of your own is given "
              "as a file (NAME.yaml){}",
              name_or_file, hint(name_or_file, names), unreadable);
}

}  // namespace

TaskSpec parse_task(std::string_view text, const std::string& where, const fs::path& folder,
                    const DataFolders& folders) {
  return read_task(text, where, folder, folders, 0);
}

TaskSpec load_task(const std::string& name_or_file, const DataFolders& folders) {
  return load(name_or_file, folders, 0);
}

std::vector<std::string> task_names(const DataFolders& folders) {
  std::vector<std::string> names;
  for (const std::string& name : data_names(folders, ""))
    if (task_aliases(*find_data_file(folders, "", name))) names.push_back(name);
  return names;
}

void change_physics(TaskSpec& task, const std::vector<std::string>& words,
                    const DataFolders& folders) {
  const Profiles<Physics>& profiles = physics_profiles();
  const auto [profile, constants] = profile_words(words);
  Physics changed = profile ? profiles.load(*profile, folders) : task.physics;
  for (const std::string& constant : constants) profiles.assign(changed, constant);
  profiles.check(changed);
  if (task.physics == changed) return;
  task.physics = changed;
  task.source = task_to_yaml(task);
}

}  // namespace evo
