#include "formats/physics.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

#include "formats/files.h"

namespace evo {
namespace {

// ---- the constants, by name ---------------------------------------------------

enum class Sign { positive, not_negative };

struct Constant {
  const char* key;
  std::variant<double Physics::*, int Physics::*, SpringStiffness Physics::*> member;
  Sign sign;
  const char* unit;
  const char* meaning;
};

// In the order of libevo/sim/physics.h. A stiffness has two parts, `edge` and
// `diagonal`.
constexpr std::array<Constant, 23> constants{{
    {"voxel_length", &Physics::voxel_length, Sign::positive, "length", "side of a voxel"},
    {"substep", &Physics::substep, Sign::positive, "time", "one step of the integrator"},
    {"substeps", &Physics::substeps, Sign::positive, "count", "substeps in a control step"},
    {"gravity", &Physics::gravity, Sign::not_negative, "length/time^2", "downward acceleration"},
    {"drag", &Physics::drag, Sign::not_negative, "force/velocity", "on every point mass"},
    {"actuation_rate", &Physics::actuation_rate, Sign::not_negative, "share",
     "of (goal - length) that a spring's rest length takes"},
    {"rigid", &Physics::rigid, Sign::not_negative, "force/length", "springs of rigid, fixed cells"},
    {"soft", &Physics::soft, Sign::not_negative, "force/length", "springs of soft cells"},
    {"actuator", &Physics::actuator, Sign::not_negative, "force/length", "springs of actuators"},
    {"contact_stiffness", &Physics::contact_stiffness, Sign::not_negative, "force/length",
     "per depth of penetration"},
    {"contact_margin", &Physics::contact_margin, Sign::not_negative, "length",
     "added to every penetration"},
    {"contact_damping", &Physics::contact_damping, Sign::not_negative, "force/velocity",
     "along the normal of a contact"},
    {"friction_coefficient", &Physics::friction_coefficient, Sign::not_negative, "1",
     "between objects"},
    {"friction_multiplier", &Physics::friction_multiplier, Sign::not_negative, "1",
     "between objects"},
    {"floor_stiffness", &Physics::floor_stiffness, Sign::not_negative, "force/length",
     "of the world floor at y = 0"},
    {"floor_friction_coefficient", &Physics::floor_friction_coefficient, Sign::not_negative, "1",
     "on the world floor"},
    {"floor_friction_multiplier", &Physics::floor_friction_multiplier, Sign::not_negative, "1",
     "on the world floor"},
    {"strain_limit", &Physics::strain_limit, Sign::not_negative, "share of rest length",
     "free strain of a spring"},
    {"strain_correction", &Physics::strain_correction, Sign::not_negative, "share",
     "of the excess taken back"},
    {"rigid_strain_limit", &Physics::rigid_strain_limit, Sign::not_negative, "share of rest length",
     "free strain of a rigid cell's edge"},
    {"rigid_strain_correction", &Physics::rigid_strain_correction, Sign::not_negative, "share",
     "of the excess taken back"},
    {"min_target", &Physics::min_target, Sign::positive, "share of rest length",
     "smallest actuator target"},
    {"max_target", &Physics::max_target, Sign::positive, "share of rest length",
     "largest actuator target"},
}};

// The one setting that is a word.
constexpr const char* arithmetic_key = "arithmetic";
constexpr std::array<const char*, 2> arithmetic_words{"exact", "fast"};

constexpr int most_substeps = 10'000;

std::vector<std::string> constant_names() {
  std::vector<std::string> names;
  names.reserve(constants.size());
  for (const Constant& constant : constants) names.emplace_back(constant.key);
  names.emplace_back(arithmetic_key);
  return names;
}

// ---- numbers ------------------------------------------------------------------

// "0.2" or a quotient of two numbers, "3e8/3.5", rounded once.
std::optional<double> parse_quotient(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return parse_number(text);
  const auto trimmed = [](std::string_view part) {
    while (!part.empty() && part.front() == ' ') part.remove_prefix(1);
    while (!part.empty() && part.back() == ' ') part.remove_suffix(1);
    return part;
  };
  const std::optional<double> above = parse_number(trimmed(text.substr(0, slash)));
  const std::optional<double> below = parse_number(trimmed(text.substr(slash + 1)));
  if (!above || !below || *below == 0.0) return std::nullopt;
  const double value = *above / *below;
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

const char* expectation(Sign sign) {
  return sign == Sign::positive ? "a number greater than 0, or a quotient of two like 3e8/3.5,"
                                : "a number of at least 0, or a quotient of two like 3e8/3.5,";
}

// The value of a constant, or the reason why `text` is none.
struct Reading {
  double value = 0.0;
  std::string problem;
};

// `key` names it in messages: of a spring, which part.
Reading read_constant(const Constant& constant, const std::string& key, const std::string& text) {
  const std::optional<double> value = parse_quotient(text);
  const bool in_range = value && (constant.sign == Sign::positive ? *value > 0.0 : *value >= 0.0);
  if (!in_range)
    return {0.0, fmt::format("{} is expected for '{}', found '{}'", expectation(constant.sign), key,
                             text)};
  if (std::holds_alternative<int Physics::*>(constant.member) &&
      (*value != std::floor(*value) || *value > most_substeps))
    return {0.0, fmt::format("a whole number from 1 to {} is expected for '{}', found '{}'",
                             most_substeps, key, text)};
  return {*value, ""};
}

void set(Physics& physics, const Constant& constant, double value) {
  if (const auto* real = std::get_if<double Physics::*>(&constant.member))
    physics.*(*real) = value;
  else if (const auto* count = std::get_if<int Physics::*>(&constant.member))
    physics.*(*count) = static_cast<int>(value);
}

std::optional<Arithmetic> arithmetic_named(std::string_view word) {
  if (word == arithmetic_words[0]) return Arithmetic::exact;
  if (word == arithmetic_words[1]) return Arithmetic::fast;
  return std::nullopt;
}

std::string arithmetic_problem(const std::string& found) {
  return fmt::format("'{}' must be {}, found {}", arithmetic_key,
                     fmt::join(arithmetic_words, " or "), found);
}

std::string targets_problem(const Physics& physics) {
  if (physics.min_target <= physics.max_target) return "";
  return fmt::format("min_target {} is greater than max_target {}", physics.min_target,
                     physics.max_target);
}

// ---- reading ------------------------------------------------------------------

constexpr const char* default_profile = "evogym";
constexpr int longest_chain = 16;  // of profiles that start from one another

double read_value(const Constant& constant, const std::string& key, const YamlNode& node) {
  if (!node.is_scalar())
    throw node.error(fmt::format("{} is expected for '{}', found {}", expectation(constant.sign),
                                 key, node.found()));
  const Reading reading = read_constant(constant, key, node.string());
  if (!reading.problem.empty()) throw node.error(reading.problem);
  return reading.value;
}

void read_stiffness(SpringStiffness& stiffness, const Constant& constant, const YamlNode& node) {
  const YamlMapping parts(node, constant.key, {"edge", "diagonal"});
  if (const auto edge = parts.find("edge"))
    stiffness.edge = read_value(constant, std::string(constant.key) + ".edge", *edge);
  if (const auto diagonal = parts.find("diagonal"))
    stiffness.diagonal = read_value(constant, std::string(constant.key) + ".diagonal", *diagonal);
}

Physics load(const std::string& name_or_file, const std::filesystem::path& folder,
             const DataFolders& folders, int depth);

Physics read_profile(const YamlNode& node, const std::filesystem::path& folder,
                     const DataFolders& folders, int depth) {
  std::vector<std::string> allowed{"format", "version", "name", "description", "base"};
  for (const std::string& name : constant_names()) allowed.push_back(name);
  const YamlMapping profile(node, "physics profile", allowed);
  check_format(profile, "evo/physics", 1);

  Physics physics;
  const auto base = profile.find("base");
  if (base && depth >= longest_chain)
    throw base->error("profiles start from one another in a circle");
  try {
    physics = load(base ? base->string() : default_profile, folder, folders, depth + 1);
  } catch (const Error& failure) {
    if (!base || failure.kind() == Failure::data) throw;
    throw base->error(failure.what());
  }
  for (const Constant& constant : constants) {
    const auto value = profile.find(constant.key);
    if (!value) continue;
    if (const auto* stiffness = std::get_if<SpringStiffness Physics::*>(&constant.member))
      read_stiffness(physics.*(*stiffness), constant, *value);
    else
      set(physics, constant, read_value(constant, constant.key, *value));
  }
  if (const auto word = profile.find(arithmetic_key)) {
    const auto arithmetic =
        word->is_scalar() ? arithmetic_named(word->string()) : std::optional<Arithmetic>{};
    if (!arithmetic) throw word->error(arithmetic_problem(word->found()));
    physics.arithmetic = *arithmetic;
  }
  if (const std::string problem = targets_problem(physics); !problem.empty())
    throw node.error(problem);
  return physics;
}

Physics load_file(const std::filesystem::path& path, const DataFolders& folders, int depth) {
  const YamlNode node = YamlNode::parse(read_file(path, largest_document), path.string());
  return read_profile(node, path.parent_path(), folders, depth);
}

// `evogym` itself has no base: its file is complete, or libevo's own values
// stand for it.
Physics load(const std::string& name_or_file, const std::filesystem::path& folder,
             const DataFolders& folders, int depth) {
  if (is_file_name(name_or_file)) return load_file(folder / name_or_file, folders, depth);
  if (const auto path = find_data_file(folders, "physics", name_or_file))
    // The default base of evogym.yaml is not evogym.yaml again.
    return load_file(*path, name_or_file == default_profile ? DataFolders{} : folders, depth);
  if (name_or_file == default_profile) return Physics{};
  std::vector<std::string> known = data_names(folders, "physics");
  if (known.empty()) known.emplace_back(default_profile);
  throw Error(Failure::usage,
              unknown_name("physics profile", name_or_file, known) + ", or a file (NAME.yaml)");
}

}  // namespace

Physics load_physics(const std::string& name_or_file, const DataFolders& folders) {
  return load(name_or_file, "", folders, 0);
}

Physics physics_from_yaml(const YamlNode& node, const std::filesystem::path& folder,
                          const DataFolders& folders) {
  return read_profile(node, folder, folders, 0);
}

// ---- single constants -----------------------------------------------------------

std::vector<std::string> physics_keys() {
  std::vector<std::string> keys;
  for (const Constant& constant : constants) {
    if (std::holds_alternative<SpringStiffness Physics::*>(constant.member)) {
      keys.push_back(std::string(constant.key) + ".edge");
      keys.push_back(std::string(constant.key) + ".diagonal");
    } else {
      keys.emplace_back(constant.key);
    }
  }
  keys.emplace_back(arithmetic_key);
  return keys;
}

void apply_override(Physics& physics, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0)
    throw error(Failure::usage, "KEY=VALUE is expected (as in gravity=50), found '{}'", assignment);
  const std::string key(assignment.substr(0, equals));
  const std::string value(assignment.substr(equals + 1));
  if (key == arithmetic_key) {
    const auto arithmetic = arithmetic_named(value);
    if (!arithmetic) throw Error(Failure::usage, arithmetic_problem("'" + value + "'"));
    physics.arithmetic = *arithmetic;
    return;
  }
  for (const Constant& constant : constants) {
    const auto* stiffness = std::get_if<SpringStiffness Physics::*>(&constant.member);
    const bool edge = stiffness && key == std::string(constant.key) + ".edge";
    const bool diagonal = stiffness && key == std::string(constant.key) + ".diagonal";
    if (!edge && !diagonal && (stiffness || key != constant.key)) continue;
    const Reading reading = read_constant(constant, key, value);
    if (!reading.problem.empty()) throw Error(Failure::usage, reading.problem);
    if (edge)
      (physics.*(*stiffness)).edge = reading.value;
    else if (diagonal)
      (physics.*(*stiffness)).diagonal = reading.value;
    else
      set(physics, constant, reading.value);
    if (const std::string problem = targets_problem(physics); !problem.empty())
      throw Error(Failure::usage, problem);
    return;
  }
  throw Error(Failure::usage, unknown_name("physics constant", key, physics_keys()));
}

// ---- writing --------------------------------------------------------------------

std::string physics_constants_to_yaml(const Physics& physics, const std::string& indent) {
  std::string text;
  for (const Constant& constant : constants) {
    std::string value;
    if (const auto* real = std::get_if<double Physics::*>(&constant.member))
      value = fmt::format("{}", physics.*(*real));
    else if (const auto* count = std::get_if<int Physics::*>(&constant.member))
      value = fmt::format("{}", physics.*(*count));
    else if (const auto* stiffness = std::get_if<SpringStiffness Physics::*>(&constant.member))
      value = fmt::format("{{edge: {}, diagonal: {}}}", (physics.*(*stiffness)).edge,
                          (physics.*(*stiffness)).diagonal);
    text += fmt::format("{}{}: {}  # {}; {}\n", indent, constant.key, value, constant.unit,
                        constant.meaning);
  }
  // Left out where it is the default: files and hashes from before there was a
  // choice stay what they were.
  if (physics.arithmetic == Arithmetic::fast)
    text += fmt::format("{}{}: {}  # roots and sums rounded in another way\n", indent,
                        arithmetic_key, arithmetic_words[1]);
  return text;
}

std::string physics_to_yaml(const Physics& physics) {
  return "format: evo/physics\nversion: 1\n" + physics_constants_to_yaml(physics, "");
}

}  // namespace evo
