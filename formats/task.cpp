#include "formats/task.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "formats/files.h"
#include "formats/physics.h"
#include "formats/task_world.h"

namespace evo {
namespace fs = std::filesystem;
namespace {

constexpr int most_steps = 10'000'000;
constexpr double largest_length = 1e6;      // voxels
constexpr int largest_draw = 100'000;       // voxels
constexpr int widest_profile = 1000;        // bins to either side
constexpr int longest_goal_path = 100'000;  // voxels

// What a part of a task may refer to.
struct Scope {
  std::vector<std::string> objects;  // robot first
  bool has_goals = false;
};

// ---- small pieces ---------------------------------------------------------------

std::string read_object(const YamlNode& node, const Scope& scope) {
  return node.choice("object", scope.objects);
}

Axis read_axis(const YamlNode& node) {
  return node.choice("axis", {"x", "y"}) == "x" ? Axis::x : Axis::y;
}

double read_length(const YamlNode& node) { return node.number(-largest_length, largest_length); }

void need_goals(const YamlNode& node, const Scope& scope, const std::string& what) {
  if (!scope.has_goals) throw node.error(what + " needs the task to have `goals`");
}

// A single word (`- goal_index`) or a mapping with one key (`- velocity: robot`).
struct Named {
  YamlNode name;
  std::optional<YamlNode> value;
};

Named read_named(const YamlNode& node, const std::string& what) {
  if (node.is_scalar()) return {node, std::nullopt};
  const auto& entries = node.entries();
  if (entries.size() != 1)
    throw node.error(
        fmt::format("{} with one name is expected, found {} keys", what, entries.size()));
  return {entries[0].key, entries[0].value};
}

YamlNode need_value(const Named& named) {
  if (named.value) return *named.value;
  throw named.name.error(fmt::format("'{}' needs a value", named.name.string()));
}

void refuse_value(const Named& named) {
  if (named.value && !named.value->is_null())
    throw named.value->error(fmt::format("'{}' takes no value", named.name.string()));
}

// ---- observation ------------------------------------------------------------------

std::vector<std::string> read_terrain(const YamlNode& node, const Scope& scope) {
  if (node.is_scalar()) return {read_object(node, scope)};
  std::vector<std::string> objects;
  for (const YamlNode& item : node.items()) objects.push_back(read_object(item, scope));
  if (objects.empty())
    throw node.error("at least one object is expected; leave `over` out for all but the robot");
  return objects;
}

template <typename Profile>
Profile read_profile(const YamlNode& node, const std::string& what, const Scope& scope) {
  const YamlMapping mapping(node, what, {"width", "range", "over"});
  Profile profile;
  profile.width = mapping.at("width").integer(0, widest_profile);
  if (const auto range = mapping.find("range")) profile.range = range->positive();
  if (const auto over = mapping.find("over")) profile.over = read_terrain(*over, scope);
  return profile;
}

observation::Offset read_offset(const YamlNode& node, const Scope& scope) {
  const YamlMapping mapping(node, "offset", {"of", "from"});
  return {read_object(mapping.at("of"), scope), read_object(mapping.at("from"), scope)};
}

ObservationPart read_part(const YamlNode& node, const Scope& scope) {
  const Named named = read_named(node, "an observation part");
  const std::string name = named.name.choice(
      "observation part", {"velocity", "orientation", "relative_positions", "offset", "floor",
                           "ceiling", "goal_index", "goal_position", "goal_offset"});
  if (name.rfind("goal_", 0) == 0) {
    refuse_value(named);
    need_goals(named.name, scope, name);
    if (name == "goal_index") return observation::GoalIndex{};
    if (name == "goal_position") return observation::GoalPosition{};
    return observation::GoalOffset{};
  }
  const YamlNode value = need_value(named);
  if (name == "velocity") return observation::Velocity{read_object(value, scope)};
  if (name == "orientation") return observation::Orientation{read_object(value, scope)};
  if (name == "relative_positions")
    return observation::RelativePositions{read_object(value, scope)};
  if (name == "offset") return read_offset(value, scope);
  if (name == "floor") return read_profile<observation::Floor>(value, name, scope);
  return read_profile<observation::Ceiling>(value, name, scope);
}

// ---- conditions ---------------------------------------------------------------------

condition::Position read_position(const YamlNode& node, const Scope& scope) {
  const YamlMapping mapping(node, "position",
                            {"of", "axis", "above", "below", "at_least", "at_most"});
  condition::Position position;
  position.of = read_object(mapping.at("of"), scope);
  position.axis = read_axis(mapping.at("axis"));
  const auto bound = [&](const char* key) -> std::optional<double> {
    const auto value = mapping.find(key);
    return value ? std::optional(read_length(*value)) : std::nullopt;
  };
  position.above = bound("above");
  position.below = bound("below");
  position.at_least = bound("at_least");
  position.at_most = bound("at_most");
  if (!position.above && !position.below && !position.at_least && !position.at_most)
    throw node.error("a bound is expected: above, below, at_least or at_most (voxels)");
  return position;
}

Condition read_condition(const YamlNode& node, const Scope& scope) {
  const Named named = read_named(node, "a condition");
  const std::string name = named.name.choice("condition", {"position", "tilt", "goals_reached"});
  if (name == "goals_reached") {
    refuse_value(named);
    need_goals(named.name, scope, name);
    return condition::GoalsReached{};
  }
  const YamlNode value = need_value(named);
  if (name == "position") return read_position(value, scope);
  const YamlMapping mapping(value, "tilt", {"of", "degrees"});
  return condition::Tilt{read_object(mapping.at("of"), scope),
                         mapping.at("degrees").number(0, 180)};
}

// One condition, or a list of which all have to hold.
std::vector<Condition> read_conditions(const YamlNode& node, const Scope& scope) {
  if (!node.is_sequence()) return {read_condition(node, scope)};
  std::vector<Condition> conditions;
  for (const YamlNode& item : node.items()) conditions.push_back(read_condition(item, scope));
  if (conditions.empty()) throw node.error("at least one condition is expected");
  return conditions;
}

// ---- reward and rules -----------------------------------------------------------------

using Term = decltype(RewardTerm::term);

const std::vector<std::string> term_names{"displacement", "distance", "approach",     "hull_area",
                                          "extent",       "rotation", "goal_approach"};

template <typename OfAndAxis>
OfAndAxis read_of_axis(const YamlNode& node, const std::string& what, const Scope& scope) {
  const YamlMapping mapping(node, what, {"of", "axis"});
  return {read_object(mapping.at("of"), scope), read_axis(mapping.at("axis"))};
}

reward::Approach read_approach(const YamlNode& node, const Scope& scope) {
  const YamlMapping mapping(node, "approach", {"of", "axis", "to"});
  reward::Approach approach;
  approach.of = read_object(mapping.at("of"), scope);
  approach.axis = read_axis(mapping.at("axis"));
  const YamlNode to = mapping.at("to");
  if (to.is_scalar() && parse_number(to.string()))
    approach.to = read_length(to);
  else
    approach.to = read_object(to, scope);
  return approach;
}

Term read_term(const Named& named, const Scope& scope) {
  const std::string name = named.name.string();
  if (name == "goal_approach") {
    refuse_value(named);
    need_goals(named.name, scope, name);
    return reward::GoalApproach{};
  }
  const YamlNode value = need_value(named);
  if (name == "displacement") return read_of_axis<reward::Displacement>(value, name, scope);
  if (name == "distance") return read_of_axis<reward::Distance>(value, name, scope);
  if (name == "extent") return read_of_axis<reward::Extent>(value, name, scope);
  if (name == "approach") return read_approach(value, scope);
  if (name == "hull_area") return reward::HullArea{read_object(value, scope)};
  return reward::Rotation{read_object(value, scope)};
}

RewardTerm read_reward(const YamlNode& node, const Scope& scope) {
  if (node.is_scalar()) {
    node.choice("reward term", term_names);
    return {1.0, read_term({node, std::nullopt}, scope), {}};
  }
  std::vector<std::string> allowed = term_names;
  allowed.insert(allowed.end(), {"weight", "when"});
  const YamlMapping mapping(node, "reward term", allowed);
  std::optional<Named> named;
  for (const auto& [key, value] : node.entries()) {
    if (key.string() == "weight" || key.string() == "when") continue;
    if (named) throw key.error("one reward term is expected in a list item, found a second");
    named = Named{key, value};
  }
  if (!named)
    throw node.error(fmt::format("a reward term is expected: {}", fmt::join(term_names, ", ")));
  RewardTerm term{1.0, read_term(*named, scope), {}};
  if (const auto weight = mapping.find("weight")) term.weight = weight->number();
  if (const auto when = mapping.find("when")) term.when = read_conditions(*when, scope);
  return term;
}

Rule read_rule(const YamlNode& node, const Scope& scope) {
  const YamlMapping mapping(node, "rule", {"when", "reward", "terminate"});
  Rule rule;
  rule.when = read_conditions(mapping.at("when"), scope);
  if (const auto reward = mapping.find("reward")) rule.reward = reward->number();
  if (const auto terminate = mapping.find("terminate")) rule.terminate = terminate->boolean();
  return rule;
}

// ---- random parts -----------------------------------------------------------------------

std::vector<DrawnInteger> read_draws(const YamlNode& node) {
  std::vector<DrawnInteger> draws;
  for (const auto& [name, range] : node.entries()) {
    const auto& bounds = range.items();
    if (bounds.size() != 2)
      throw range.error("a range [low, high] of whole numbers, both included, is expected");
    const int low = bounds[0].integer(-largest_draw, largest_draw);
    draws.push_back({name.string(), low, bounds[1].integer(low, largest_draw)});
  }
  return draws;
}

DrawnGoals read_goals(const YamlNode& node) {
  const YamlMapping mapping(node, "goals", {"start", "between", "distance", "radius"});
  DrawnGoals goals;
  goals.start = mapping.at("start").integer(-largest_draw, largest_draw);
  const YamlNode between = mapping.at("between");
  const auto& bounds = between.items();
  if (bounds.size() != 2)
    throw between.error("a range [low, high] of whole numbers, both included, is expected");
  goals.low = bounds[0].integer(-largest_draw, largest_draw - 1);
  goals.high = bounds[1].integer(goals.low + 1, largest_draw);
  goals.distance = mapping.at("distance").integer(1, longest_goal_path);
  goals.radius = mapping.at("radius").positive();
  return goals;
}

// ---- the task -----------------------------------------------------------------------------

// A profile by name or file, or constants given in the task itself.
Physics read_physics(const YamlNode& node, const fs::path& folder, const DataFolders& folders) {
  if (node.is_mapping()) return physics_from_yaml(node, folder, folders);
  const std::string name = node.string();
  try {
    return load_physics(is_file_name(name) ? (folder / name).string() : name, folders);
  } catch (const Error& failure) {
    if (failure.kind() == Failure::data) throw;
    throw node.error(failure.what());
  }
}

std::vector<std::string> read_words(const YamlNode& node) {
  std::vector<std::string> words;
  for (const YamlNode& item : node.items()) words.push_back(item.string());
  return words;
}

std::string read_task_name(const YamlNode& node) {
  std::string name = node.string();
  if (is_file_name(name) || name.find_first_of(" \t\n") != std::string::npos)
    throw node.error("a name without spaces, '/' or '.yaml' is expected, found " + node.found());
  return name;
}

YamlMapping task_mapping(std::string_view text, const std::string& where) {
  YamlMapping mapping(YamlNode::parse(text, where), "task",
                      {"format", "version", "name", "aliases", "difficulty", "description", "notes",
                       "steps", "robot", "world", "draws", "goals", "observation", "reward",
                       "folding_reward", "rules", "follow", "physics"});
  check_format(mapping, "evo/task", 1);
  return mapping;
}

bool names_file(const YamlNode& world) {
  if (world.is_scalar()) return true;
  const auto& entries = world.entries();
  return std::any_of(entries.begin(), entries.end(),
                     [](const YamlNode::Entry& entry) { return entry.key.string() == "file"; });
}

// The text needs no other file: no world file, no profile but the built-in one.
bool is_complete(const YamlMapping& mapping, const TaskSpec& task) {
  if (names_file(mapping.at("world"))) return false;
  const auto physics = mapping.find("physics");
  const bool built_in = !physics || (physics->is_scalar() && physics->string() == "evogym");
  return built_in && task.physics == Physics{};
}

}  // namespace

TaskSpec parse_task(std::string_view text, const std::string& where, const fs::path& folder,
                    const DataFolders& folders) {
  const YamlMapping mapping = task_mapping(text, where);
  TaskSpec task;
  task.name = read_task_name(mapping.at("name"));
  if (const auto aliases = mapping.find("aliases")) task.aliases = read_words(*aliases);
  if (const auto difficulty = mapping.find("difficulty"))
    task.difficulty = difficulty->choice("difficulty", {"easy", "medium", "hard"});
  if (const auto description = mapping.find("description"))
    task.description = description->string();
  if (const auto notes = mapping.find("notes")) task.notes = read_words(*notes);
  task.episode_steps = mapping.at("steps").integer(1, most_steps);

  const YamlMapping robot(mapping.at("robot"), "robot", {"at"});
  const YamlNode at = robot.at("at");
  if (at.items().size() != 2) throw at.error("a cell [x, y] is expected");
  task.robot_x = at.items()[0].integer(0, largest_draw);
  task.robot_y = at.items()[1].integer(0, largest_draw);

  if (const auto draws = mapping.find("draws")) task.draws = read_draws(*draws);
  if (const auto goals = mapping.find("goals")) task.goals = read_goals(*goals);
  task.objects = world_from_yaml(mapping.at("world"), folder, task.draws);

  Scope scope{{robot_name}, task.goals.has_value()};
  for (const Placement& placement : task.objects) scope.objects.push_back(placement.object.name);
  for (const YamlNode& part : mapping.at("observation").items())
    task.observation.push_back(read_part(part, scope));
  for (const YamlNode& term : mapping.at("reward").items())
    task.reward.push_back(read_reward(term, scope));
  if (const auto folding = mapping.find("folding_reward")) task.folding_reward = folding->number();
  if (const auto rules = mapping.find("rules"))
    for (const YamlNode& rule : rules->items()) task.rules.push_back(read_rule(rule, scope));
  if (const auto follow = mapping.find("follow")) {
    task.follow.clear();
    for (const YamlNode& object : follow->items())
      task.follow.push_back(read_object(object, scope));
  }
  if (task.observation.empty())
    throw mapping.at("observation").error("at least one observation part is expected");

  if (const auto physics = mapping.find("physics"))
    task.physics = read_physics(*physics, folder, folders);
  else
    task.physics = load_physics("evogym", folders);
  task.source = is_complete(mapping, task) ? std::string(text) : task_to_yaml(task);
  return task;
}

// ---- finding -----------------------------------------------------------------------------------

namespace {

TaskSpec load_task_file(const fs::path& path, const DataFolders& folders) {
  return parse_task(read_file(path, largest_document), path.string(), path.parent_path(), folders);
}

// The head of a task file; nothing for other YAML that lives in the folder.
struct TaskFile {
  std::string name;  // of the file
  fs::path path;
  std::vector<std::string> aliases;
};

std::optional<TaskFile> read_head(const std::string& name, const fs::path& path) {
  try {
    const YamlNode root = YamlNode::parse(read_file(path, largest_document), path.string());
    TaskFile file{name, path, {}};
    bool is_task = false;
    for (const auto& [key, value] : root.entries()) {
      if (key.string() == "format") is_task = value.string() == "evo/task";
      if (key.string() == "aliases") file.aliases = read_words(value);
    }
    return is_task ? std::optional(file) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::vector<TaskFile> task_files(const DataFolders& folders) {
  std::vector<TaskFile> files;
  for (const std::string& name : data_names(folders, ""))
    if (auto file = read_head(name, *find_data_file(folders, "", name)))
      files.push_back(std::move(*file));
  return files;
}

}  // namespace

TaskSpec load_task(const std::string& name_or_file, const DataFolders& folders) {
  if (is_file_name(name_or_file)) return load_task_file(name_or_file, folders);
  const auto path = find_data_file(folders, "", name_or_file);
  if (path && read_head(name_or_file, *path)) return load_task_file(*path, folders);

  std::vector<std::string> names;
  for (const TaskFile& file : task_files(folders)) {
    if (std::find(file.aliases.begin(), file.aliases.end(), name_or_file) != file.aliases.end())
      return load_task_file(file.path, folders);
    names.push_back(file.name);
  }
  throw error(Failure::usage,
              "unknown task '{}'{}; `evo-inspect tasks` lists them, a task of your own is given "
              "as a file (NAME.yaml)",
              name_or_file, did_you_mean(name_or_file, names));
}

std::vector<std::string> task_names(const DataFolders& folders) {
  std::vector<std::string> names;
  for (const TaskFile& file : task_files(folders)) names.push_back(file.name);
  return names;
}

void set_physics(TaskSpec& task, const Physics& physics) {
  if (task.physics == physics) return;
  task.physics = physics;
  task.source = task_to_yaml(task);
}

}  // namespace evo
