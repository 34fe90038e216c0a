#include "formats/task/physics_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include "formats/io/format.h"
#include "formats/io/profile.h"

namespace evo {

namespace {

// ---- the constants, by name ---------------------------------------------------

// Values a constant may have.
struct Range {
  double low = 0.0;
  bool is_open = false;  // low itself is not allowed
  double high = std::numeric_limits<double>::infinity();
};
constexpr Range positive{0.0, true};
constexpr Range not_negative{0.0};
constexpr Range substep_count{1.0, false, 10'000.0};

// A stiffness has two parts, `edge` and `diagonal`, and so has its baseline.
struct Constant {
  const char* key;
  std::variant<double Physics::*, int Physics::*, SpringStiffness Physics::*> member;
  Range range;
  const char* unit;
  const char* meaning;
  // What no line of an identity means (formats/training/identity.h): frozen for ever,
  // whatever becomes of the default. A new constant's is what leaves the physics
  // as it was.
  std::array<double, 2> baseline;
};

// In the order of libevo/sim/physics.h. All that is said, checked and written of
// the constants comes from here.
constexpr std::array<Constant, 23> constants{{
    {"voxel_length", &Physics::voxel_length, positive, "length", "side of a voxel", {0.1}},
    {"substep", &Physics::substep, positive, "time", "one step of the integrator", {1e-4}},
    {"substeps", &Physics::substeps, substep_count, "count", "substeps in a control step", {30}},
    {"gravity", &Physics::gravity, not_negative, "length/time^2", "downward acceleration", {110}},
    {"drag", &Physics::drag, not_negative, "force/velocity", "on every point mass", {0.1}},
    {"actuation_rate",
     &Physics::actuation_rate,
     not_negative,
     "share",
     "of (goal - length) that a spring's rest length takes",
     {0.006}},
    {"rigid",
     &Physics::rigid,
     not_negative,
     "force/length",
     "springs of rigid, fixed cells",
     {3e8 / 3.5, 3e8 / 7.0}},
    {"soft",
     &Physics::soft,
     not_negative,
     "force/length",
     "springs of soft cells",
     {3e8 / 6.0, 3e8 / 24.0}},
    {"actuator",
     &Physics::actuator,
     not_negative,
     "force/length",
     "springs of actuators",
     {3e8 / 5.0, 3e8 / 10.0}},
    {"contact_stiffness",
     &Physics::contact_stiffness,
     not_negative,
     "force/length",
     "per depth of penetration",
     {2.1e6}},
    {"contact_margin",
     &Physics::contact_margin,
     not_negative,
     "length",
     "added to every penetration",
     {0.005}},
    {"contact_damping",
     &Physics::contact_damping,
     not_negative,
     "force/velocity",
     "along the normal of a contact",
     {140}},
    {"friction_coefficient",
     &Physics::friction_coefficient,
     not_negative,
     "1",
     "between objects",
     {0.2}},
    {"friction_multiplier",
     &Physics::friction_multiplier,
     not_negative,
     "1",
     "between objects",
     {1200}},
    {"floor_stiffness",
     &Physics::floor_stiffness,
     not_negative,
     "force/length",
     "of the world floor at y = 0",
     {1.4e7}},
    {"floor_friction_coefficient",
     &Physics::floor_friction_coefficient,
     not_negative,
     "1",
     "on the world floor",
     {0.2}},
    {"floor_friction_multiplier",
     &Physics::floor_friction_multiplier,
     not_negative,
     "1",
     "on the world floor",
     {10}},
    {"strain_limit",
     &Physics::strain_limit,
     not_negative,
     "share of rest length",
     "free strain of a spring",
     {0.25}},
    {"strain_correction",
     &Physics::strain_correction,
     not_negative,
     "share",
     "of the excess taken back",
     {0.8}},
    {"rigid_strain_limit",
     &Physics::rigid_strain_limit,
     not_negative,
     "share of rest length",
     "free strain of a rigid cell's edge",
     {0.03}},
    {"rigid_strain_correction",
     &Physics::rigid_strain_correction,
     not_negative,
     "share",
     "of the excess taken back",
     {0.5}},
    {"min_target",
     &Physics::min_target,
     positive,
     "share of rest length",
     "smallest actuator target",
     {0.6}},
    {"max_target",
     &Physics::max_target,
     positive,
     "share of rest length",
     "largest actuator target",
     {1.6}},
}};

// One value of a constant: a stiffness has two, the others one.
struct Value {
  const Constant& constant;
  std::string key;  // "gravity", "rigid.edge"
  std::size_t part = 0;
};

std::vector<Value> values_of(const Constant& constant) {
  const std::string key = constant.key;
  if (!std::holds_alternative<SpringStiffness Physics::*>(constant.member))
    return {{constant, key, 0}};
  return {{constant, key + ".edge", 0}, {constant, key + ".diagonal", 1}};
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

bool is_count(const Value& value) {
  return std::holds_alternative<int Physics::*>(value.constant.member);
}

std::string expectation(const Value& value) {
  const Range& range = value.constant.range;
  if (is_count(value)) return fmt::format("a whole number from {} to {}", range.low, range.high);
  return fmt::format("a number {} {}, or a quotient of two like 3e8/3.5,",
                     range.is_open ? "greater than" : "of at least", range.low);
}

std::string mismatch(const Value& value, const std::string& found) {
  return fmt::format("{} is expected for '{}', found {}", expectation(value), value.key, found);
}

// ---- values ---------------------------------------------------------------------

double get(const Physics& physics, const Value& value) {
  return std::visit(
      [&](auto member) {
        const auto& held = physics.*member;
        if constexpr (std::is_same_v<decltype(held), const SpringStiffness&>)
          return value.part == 0 ? held.edge : held.diagonal;
        else
          return static_cast<double>(held);
      },
      value.constant.member);
}

void set(Physics& physics, const Value& value, double number) {
  std::visit(
      [&](auto member) {
        auto& held = physics.*member;
        using Held = std::remove_reference_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, SpringStiffness>)
          (value.part == 0 ? held.edge : held.diagonal) = number;
        else
          held = static_cast<Held>(number);
      },
      value.constant.member);
}

std::string text_of(const Physics& physics, const Value& value) {
  return fmt::format("{}", get(physics, value));
}

std::optional<double> parse_value(const Value& value, const std::string& text) {
  const Range& range = value.constant.range;
  const std::optional<double> number = parse_quotient(text);
  if (!number || *number < range.low || *number > range.high) return std::nullopt;
  if (range.is_open && *number == range.low) return std::nullopt;
  if (is_count(value) && *number != std::floor(*number)) return std::nullopt;
  return number;
}

std::string targets_problem(const Physics& physics) {
  if (physics.min_target <= physics.max_target) return "";
  return fmt::format("min_target {} is greater than max_target {}", physics.min_target,
                     physics.max_target);
}

// ---- reading ------------------------------------------------------------------

void read_value(Physics& physics, const Value& value, const YamlNode& node) {
  if (!node.is_scalar()) throw node.error(mismatch(value, node.found()));
  const std::optional<double> number = parse_value(value, node.string());
  if (!number) throw node.error(mismatch(value, "'" + node.string() + "'"));
  set(physics, value, *number);
}

void read_constants(Physics& physics, const YamlMapping& profile) {
  for (const Constant& constant : constants) {
    const auto node = profile.find(constant.key);
    if (!node) continue;
    const std::vector<Value> values = values_of(constant);
    if (values.size() == 1) {
      read_value(physics, values[0], *node);
      continue;
    }
    const YamlMapping parts(*node, constant.key, {"edge", "diagonal"});
    for (const Value& value : values)
      if (const auto part = parts.find(value.part == 0 ? "edge" : "diagonal"))
        read_value(physics, value, *part);
  }
  if (const std::string problem = targets_problem(physics); !problem.empty())
    throw profile.node().error(problem);
}

const ProfileKind<Physics>& physics_kind() {
  static const ProfileKind<Physics> kind = [] {
    std::vector<std::string> names;
    for (const Constant& constant : constants) names.emplace_back(constant.key);
    return ProfileKind<Physics>{"physics profile", format::physics,  "physics",
                                "evogym",          std::move(names), read_constants};
  }();
  return kind;
}

// Of all constants, a stiffness in its two parts.
std::vector<Value> all_values() {
  std::vector<Value> all;
  for (const Constant& constant : constants)
    for (Value& value : values_of(constant)) all.push_back(std::move(value));
  return all;
}

}  // namespace

Physics load_physics(const std::string& name_or_file, const DataFolders& folders) {
  return load_profile(physics_kind(), name_or_file, "", folders);
}

Physics physics_from_yaml(const YamlNode& node, const std::filesystem::path& folder,
                          const DataFolders& folders) {
  return read_profile(physics_kind(), node, folder, folders);
}

// ---- single constants -----------------------------------------------------------

std::vector<std::string> physics_keys() {
  std::vector<std::string> keys;
  for (const Value& value : all_values()) keys.push_back(value.key);
  return keys;
}

void apply_override(Physics& physics, std::string_view assignment) {
  const auto [key, text] = split_assignment(assignment, "gravity=50");
  for (const Value& value : all_values()) {
    if (key != value.key) continue;
    const std::optional<double> number = parse_value(value, text);
    if (!number) throw Error(Failure::usage, mismatch(value, "'" + text + "'"));
    set(physics, value, *number);
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
    const std::vector<Value> values = values_of(constant);
    const std::string shown =
        values.size() == 1 ? text_of(physics, values[0])
                           : fmt::format("{{edge: {}, diagonal: {}}}", text_of(physics, values[0]),
                                         text_of(physics, values[1]));
    text += fmt::format("{}{}: {}  # {}; {}\n", indent, constant.key, shown, constant.unit,
                        constant.meaning);
  }
  return text;
}

std::string physics_to_yaml(const Physics& physics) {
  return "format: evo/physics\nversion: 1\n" + physics_constants_to_yaml(physics, "");
}

std::vector<SettingRow> physics_table(const Physics& physics) {
  std::vector<SettingRow> rows;
  for (const Value& value : all_values()) {
    const Range& range = value.constant.range;
    rows.push_back({value.key, text_of(physics, value),
                    is_count(value) ? fmt::format("{}..{}", range.low, range.high)
                                    : fmt::format("{} {}", range.is_open ? ">" : ">=", range.low),
                    value.constant.unit, value.constant.meaning});
  }
  return rows;
}

std::vector<std::string> physics_identity(const Physics& physics) {
  std::vector<std::string> lines;
  for (const Value& value : all_values())
    if (get(physics, value) != value.constant.baseline.at(value.part))
      lines.push_back(fmt::format("physics.{}={}", value.key, text_of(physics, value)));
  return lines;
}

}  // namespace evo
