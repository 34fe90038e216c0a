#include "formats/rollout/rollout.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>
#include <utility>

#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/learners.h"
#include "formats/io/npz.h"
#include "formats/io/number.h"
#include "formats/io/text.h"
#include "libevo/base/error.h"

namespace evo {
namespace fs = std::filesystem;
namespace {

std::string episode_group(std::size_t k) { return fmt::format("/episode_{}", k); }

Error wrong(const hdf5::Reader& file, const std::string& path, const std::string& message) {
  return error(Failure::data, "{}: {}: {}", file.name(), path, message);
}

// Points are stored as pairs of numbers.
std::vector<double> as_numbers(const std::vector<Vec2>& points) {
  std::vector<double> numbers;
  numbers.reserve(2 * points.size());
  for (const Vec2& point : points) numbers.insert(numbers.end(), {point.x, point.y});
  return numbers;
}

std::vector<Vec2> as_points(const std::vector<double>& numbers) {
  std::vector<Vec2> points(numbers.size() / 2);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {numbers[2 * i], numbers[2 * i + 1]};
  return points;
}

// ---- writing ----------------------------------------------------------------

void write_world(hdf5::Writer& file, const RolloutWorld& world) {
  std::vector<std::string> names;
  std::vector<std::int64_t> first_points;
  std::vector<std::int64_t> points;
  for (const ModelObject& object : world.objects) {
    names.push_back(object.name);
    first_points.push_back(object.first_point);
    points.push_back(object.points);
  }
  std::vector<std::int32_t> owners;
  std::vector<std::uint8_t> types;
  std::vector<std::int32_t> corners;
  for (const ModelCell& cell : world.cells) {
    owners.push_back(cell.object);
    types.push_back(static_cast<std::uint8_t>(cell.type));
    corners.insert(corners.end(), cell.points.begin(), cell.points.end());
  }
  file.group("/world");
  file.strings("/world/object_names", names);
  file.vector("/world/object_first_point", first_points);
  file.vector("/world/object_points", points);
  file.vector("/world/cell_object", owners);
  file.vector("/world/cell_type", types);
  file.array("/world/cell_points", {world.cells.size(), 4}, corners);
}

}  // namespace

std::string write_episode(hdf5::Writer& file, const Rollout& rollout, std::size_t k, std::size_t id,
                          FlagType type) {
  const RolloutEpisode& episode = rollout.episodes[k];
  const std::string group = episode_group(id);
  const auto steps = static_cast<std::size_t>(episode.steps());
  file.group(group);
  file.attribute(group, "id", static_cast<std::int64_t>(id));
  file.attribute(group, "seed", episode.seed);
  file.attribute(group, "total_steps", static_cast<std::int64_t>(steps));
  file.attribute(group, "random_draws", compact(episode.random_draws));
  if (episode.jitter != 0.0) {
    file.attribute(group, "jitter", episode.jitter);
    file.attribute(group, "jitter_seed", episode.jitter_seed);
  }
  file.array(group + "/observations",
             {steps + 1, static_cast<std::size_t>(rollout.observation_length)},
             episode.observations);
  file.array(group + "/actions", {steps, static_cast<std::size_t>(rollout.action_length)},
             episode.actions);
  file.vector(group + "/rewards", episode.rewards);
  for (const auto& [name, flags] : {std::pair("/terminations", &episode.terminations),
                                    std::pair("/truncations", &episode.truncations)}) {
    if (type == FlagType::boolean)
      file.flags(group + name, *flags);
    else
      file.vector(group + name, *flags);
  }
  if (!episode.positions.empty())
    file.array(group + "/infos/positions", {steps + 1, episode.positions.size() / (steps + 1), 2},
               as_numbers(episode.positions));
  return group;
}

namespace {

// ---- reading ----------------------------------------------------------------

std::string text_or_nothing(const hdf5::Reader& file, const std::string& attribute) {
  return file.has_attribute("/", attribute) ? file.text("/", attribute) : "";
}

// The numbers k of the groups episode_<k>, in order.
std::vector<std::size_t> episode_numbers(const hdf5::Reader& file) {
  constexpr std::string_view prefix = "episode_";
  std::vector<std::size_t> numbers;
  for (const std::string& child : file.children("/")) {
    if (child.rfind(prefix, 0) != 0) continue;
    const auto k = number_in<std::size_t>(std::string_view(child).substr(prefix.size()));
    if (k && episode_group(*k) == "/" + child) numbers.push_back(*k);
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

// Older files keep the draws of their one episode at the root.
std::optional<Json> draws_of(const hdf5::Reader& file, const std::string& group) {
  for (const std::string& owner : {group, std::string("/")}) {
    if (!file.exists(owner) || !file.has_attribute(owner, "random_draws")) continue;
    const std::string where = fmt::format("{}: {}@random_draws", file.name(), owner);
    const Node draws = Node::json(file.text(owner, "random_draws"), where);
    (void)draws.entries();
    return to_json(draws);
  }
  return std::nullopt;
}

// A dataset; every row has the length of the other episodes; `length`
// is -1 until one is known. Nothing when the dataset is absent.
std::vector<double> read_rows(const hdf5::Reader& file, const std::string& path, std::size_t rows,
                              int& length) {
  if (!file.exists(path)) return {};
  auto array =
      file.array<double>(path, {rows, length < 0 ? hdf5::any : static_cast<std::size_t>(length)});
  length = static_cast<int>(array.shape[1]);
  return std::move(array.values);
}

std::vector<Vec2> read_points(const hdf5::Reader& file, const std::string& path, std::size_t rows,
                              int& points) {
  if (!file.exists(path)) return {};
  const auto array = file.array<double>(
      path, {rows, points < 0 ? hdf5::any : static_cast<std::size_t>(points), 2});
  points = static_cast<int>(array.shape[1]);
  return as_points(array.values);
}

std::vector<std::uint8_t> read_flags(const hdf5::Reader& file, const std::string& path,
                                     std::size_t steps) {
  if (!file.exists(path)) return std::vector<std::uint8_t>(steps, 0);
  return file.vector<std::uint8_t>(path, steps);
}

// Row lengths common to all episodes; -1: none seen yet.
struct Lengths {
  int observation = -1;
  int action = -1;
  int points = -1;
};

RolloutEpisode read_episode(const hdf5::Reader& file, std::size_t k, Lengths& lengths) {
  const std::string group = episode_group(k);
  RolloutEpisode episode;
  episode.rewards = file.vector<double>(group + "/rewards");
  const std::size_t steps = episode.rewards.size();
  if (file.has_attribute(group, "seed")) episode.seed = file.number<std::uint64_t>(group, "seed");
  if (auto draws = draws_of(file, group)) episode.random_draws = std::move(*draws);
  if (file.has_attribute(group, "jitter")) {
    episode.jitter = file.number<double>(group, "jitter");
    episode.jitter_seed = file.number<std::uint64_t>(group, "jitter_seed");
  }
  episode.observations = read_rows(file, group + "/observations", steps + 1, lengths.observation);
  episode.actions = read_rows(file, group + "/actions", steps, lengths.action);
  episode.terminations = read_flags(file, group + "/terminations", steps);
  episode.truncations = read_flags(file, group + "/truncations", steps);
  episode.positions = read_points(file, group + "/infos/positions", steps + 1, lengths.points);
  return episode;
}

std::vector<ModelObject> read_objects(const hdf5::Reader& file, int points) {
  const std::vector<std::string> names = file.strings("/world/object_names");
  const auto first = file.vector<std::int64_t>("/world/object_first_point", names.size());
  const auto count = file.vector<std::int64_t>("/world/object_points", names.size());
  std::vector<ModelObject> objects;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (first[i] < 0 || count[i] < 0 || first[i] > points || count[i] > points - first[i])
      throw wrong(file, "/world/object_points",
                  fmt::format("object '{}' has points {} to {}, but there are {}", names[i],
                              first[i], first[i] + count[i] - 1, points));
    ModelObject object;
    object.name = names[i];
    object.first_point = static_cast<int>(first[i]);
    object.points = static_cast<int>(count[i]);
    objects.push_back(std::move(object));
  }
  return objects;
}

ModelCell checked_cell(const hdf5::Reader& file, std::size_t c, std::int64_t object,
                       std::int64_t type, const std::int64_t* corners, std::size_t objects,
                       int points) {
  const auto refuse = [&](const char* dataset, std::int64_t found, std::int64_t low,
                          std::int64_t high) {
    return wrong(file, fmt::format("/world/{}", dataset),
                 fmt::format("cell {} has {}, expected {} to {}", c, found, low, high));
  };
  const auto last_object = static_cast<std::int64_t>(objects) - 1;
  if (object < 0 || object > last_object) throw refuse("cell_object", object, 0, last_object);
  constexpr auto last_type = static_cast<std::int64_t>(Voxel::fixed);
  if (type < 1 || type > last_type) throw refuse("cell_type", type, 1, last_type);
  ModelCell cell;
  cell.object = static_cast<int>(object);
  cell.type = static_cast<Voxel>(type);
  for (std::size_t i = 0; i < cell.points.size(); ++i) {
    if (corners[i] < 0 || corners[i] >= points)
      throw refuse("cell_points", corners[i], 0, points - 1);
    cell.points[i] = static_cast<int>(corners[i]);
  }
  return cell;
}

RolloutWorld read_world(const hdf5::Reader& file, int points) {
  RolloutWorld world;
  if (!file.exists("/world")) return world;
  world.objects = read_objects(file, points);
  if (!file.exists("/world/cell_object")) return world;
  const auto owners = file.vector<std::int64_t>("/world/cell_object");
  const auto types = file.vector<std::int64_t>("/world/cell_type", owners.size());
  const auto corners = file.array<std::int64_t>("/world/cell_points", {owners.size(), 4}).values;
  for (ModelObject& object : world.objects) object.is_static = true;
  for (std::size_t c = 0; c < owners.size(); ++c) {
    const ModelCell cell =
        checked_cell(file, c, owners[c], types[c], &corners[4 * c], world.objects.size(), points);
    if (!world.cells.empty() && cell.object < world.cells.back().object)
      throw wrong(file, "/world/cell_object", "the cells of the objects are not in order");
    ModelObject& object = world.objects[static_cast<std::size_t>(cell.object)];
    if (object.cells++ == 0) object.first_cell = static_cast<int>(c);
    object.is_static = object.is_static && cell.type == Voxel::fixed;
    world.cells.push_back(cell);
  }
  for (ModelObject& object : world.objects) object.is_static = object.is_static && object.cells > 0;
  return world;
}

// ---- actions from text --------------------------------------------------------

// A row per step, of numbers between commas, or blanks as numpy.savetxt has them; blank lines and
// lines that begin with # are passed over, a first line of names is a heading.
ActionSequence actions_from_csv(std::string_view text, const std::string& name) {
  ActionSequence actions;
  bool heading_possible = true;
  std::size_t line_number = 0;
  for (std::string_view line : split(without_byte_order_mark(text), "\n")) {
    ++line_number;
    line = trimmed(line);
    if (line.empty() || line.front() == '#') continue;
    const auto fields = line.find(',') == line.npos ? split_words(line) : split(line, ",");
    const bool is_heading =
        heading_possible && std::all_of(fields.begin(), fields.end(), [](std::string_view f) {
          f = trimmed(f);
          const bool named = !f.empty() && (std::isalpha(static_cast<unsigned char>(f[0])) != 0 ||
                                            f[0] == '"' || f[0] == '_');
          return named && !number_in<double>(f);
        });
    heading_possible = false;
    if (is_heading) continue;
    if (actions.steps == 0) actions.actuators = static_cast<int>(fields.size());
    if (std::cmp_not_equal(fields.size(), actions.actuators))
      throw error(Failure::data, "{}: line {}: {} values, but the row before has {}", name,
                  line_number, fields.size(), actions.actuators);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto value = number_in<double>(trimmed(fields[i]));
      if (!value || !std::isfinite(*value))
        throw error(Failure::data, "{}: line {}: value {} is {}, expected a number", name,
                    line_number, i + 1, shown(fields[i]));
      actions.values.push_back(*value);
    }
    ++actions.steps;
  }
  if (actions.steps == 0)
    throw error(Failure::data, "{}: no actions; expected a row of numbers per step", name);
  return actions;
}

ActionSequence actions_from_hdf5(const fs::path& path) {
  const hdf5::Reader file(path);
  check_format(file, format::rollout, Head::optional);
  if (const auto episodes = episode_numbers(file); !file.exists("/actions") && episodes.size() > 1)
    throw wrong(
        file, "/",
        fmt::format("{} episodes, actions are of one: /actions is expected", episodes.size()));
  for (const char* dataset : {"/actions", "/episode_0/actions"}) {
    if (!file.exists(dataset)) continue;
    auto array = file.array<double>(dataset, {hdf5::any, hdf5::any});
    for (std::size_t i = 0; i < array.values.size(); ++i)
      if (!std::isfinite(array.values[i]))
        throw wrong(file, dataset,
                    fmt::format("step {} holds {}, expected a number", i / array.shape[1],
                                array.values[i]));
    return {static_cast<int>(array.shape[0]), static_cast<int>(array.shape[1]),
            std::move(array.values), file.is_single(dataset)};
  }
  throw wrong(file, "/actions", "is missing, and so is /episode_0/actions");
}

ActionSequence actions_from_numpy(std::string_view bytes, const std::string& name) {
  NumpyMatrix matrix = matrix_from_numpy(bytes, "actions", name);
  for (std::size_t i = 0; i < matrix.values.size(); ++i)
    if (!std::isfinite(matrix.values[i]))
      throw error(Failure::data, "{}: step {} holds {}, expected a number", name, i / matrix.cols,
                  matrix.values[i]);
  if (matrix.values.empty())
    throw error(Failure::data, "{}: no actions; expected a row of numbers per step", name);
  return {static_cast<int>(matrix.rows), static_cast<int>(matrix.cols), std::move(matrix.values),
          matrix.is_single};
}

}  // namespace

void write_rollout(const fs::path& path, const Rollout& rollout) {
  std::int64_t total_steps = 0;
  for (const RolloutEpisode& episode : rollout.episodes) total_steps += episode.steps();
  hdf5::Writer file(path);
  file.attribute("/", "format", format::rollout.name);
  file.attribute("/", "version", std::int32_t{format::rollout.version});
  file.attribute("/", "created_by", rollout.created_by);
  file.attribute("/", "task", rollout.task);
  file.attribute("/", "task_yaml", rollout.task_yaml);
  file.attribute("/", "physics_yaml", rollout.physics_yaml);
  if (rollout.robot) file.attribute("/", "robot", robot_to_line(*rollout.robot));
  file.attribute("/", "seed", rollout.seed);
  file.attribute("/", "total_episodes", static_cast<std::int64_t>(rollout.episodes.size()));
  file.attribute("/", "total_steps", total_steps);
  write_world(file, rollout.world);
  for (std::size_t k = 0; k < rollout.episodes.size(); ++k)
    write_episode(file, rollout, k, k, FlagType::number);
  file.commit();
}

Rollout read_rollout(const fs::path& path) {
  const hdf5::Reader file(path);
  check_format(file, format::rollout, Head::optional);  // the benchmark writes neither
  Rollout rollout;
  rollout.task = text_or_nothing(file, "task");
  rollout.task_yaml = text_or_nothing(file, "task_yaml");
  rollout.physics_yaml = text_or_nothing(file, "physics_yaml");
  rollout.created_by = text_or_nothing(file, "created_by");
  if (file.has_attribute("/", "seed")) rollout.seed = file.number<std::uint64_t>("/", "seed");
  if (file.has_attribute("/", "robot")) {
    const std::string where = file.name() + ": /@robot";
    rollout.robot = read_robot(Node::json(file.text("/", "robot"), where), BodyCheck::any);
  }
  Lengths lengths;
  for (const std::size_t k : episode_numbers(file))
    rollout.episodes.push_back(read_episode(file, k, lengths));
  if (rollout.episodes.empty()) throw wrong(file, "/", "no episodes (groups episode_0, ...)");
  rollout.observation_length = std::max(lengths.observation, 0);
  rollout.action_length = std::max(lengths.action, 0);
  rollout.points = std::max(lengths.points, 0);
  rollout.world = read_world(file, rollout.points);
  return rollout;
}

ActionSequence read_actions(const fs::path& path) {
  if (hdf5::is_hdf5(path)) return actions_from_hdf5(path);
  refuse_learner_file(path);
  const std::string text = read_input(path.string(), largest_document);
  const std::string name = input_label(path.string());
  return begins_as_numpy(text) ? actions_from_numpy(text, name) : actions_from_csv(text, name);
}

Json read_draws(const fs::path& path) {
  const hdf5::Reader file(path);
  check_format(file, format::rollout, Head::optional);
  if (auto draws = draws_of(file, episode_group(0))) return *std::move(draws);
  throw wrong(file, "/episode_0@random_draws", "is missing");
}

}  // namespace evo
