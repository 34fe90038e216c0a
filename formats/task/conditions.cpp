// Conditions of rules and reward terms: how each is read, written and told.

#include "formats/task/pieces.h"
#include "libevo/base/join.h"

namespace evo {
namespace {

using namespace condition;

void read(const PieceNode& piece, Position& position) {
  const Node node = piece.value();
  const Mapping mapping(node, piece.word(),
                        {"of", "axis", "above", "below", "at_least", "at_most"});
  const auto bound = [&](const char* key) -> std::optional<double> {
    const auto value = mapping.find(key);
    return value ? std::optional(read_length(*value)) : std::nullopt;
  };
  position.of = read_object(mapping.at("of"), piece.scope);
  position.axis = read_axis(mapping.at("axis"));
  position.above = bound("above");
  position.below = bound("below");
  position.at_least = bound("at_least");
  position.at_most = bound("at_most");
  if (!position.above && !position.below && !position.at_least && !position.at_most)
    throw node.error("a bound is expected: above, below, at_least or at_most (voxels)");
}

std::string write(const Position& c) {
  const auto bound = [](const char* key, const std::optional<double>& value) {
    return value ? fmt::format(", {}: {}", key, *value) : "";
  };
  return fmt::format("{{of: {}, axis: {}{}{}{}{}}}", yaml_scalar(c.of), word(c.axis),
                     bound("above", c.above), bound("below", c.below),
                     bound("at_least", c.at_least), bound("at_most", c.at_most));
}

std::string words(const Position& c, const Physics& physics) {
  std::vector<std::string> bounds;
  const auto bound = [&](const char* relation, const std::optional<double>& value) {
    if (value)
      bounds.push_back(fmt::format("{}({}) {} {}", axis_letter(c.axis), c.of, relation,
                                   length_text(*value, physics)));
  };
  bound(">", c.above);
  bound("<", c.below);
  bound(">=", c.at_least);
  bound("<=", c.at_most);
  return joined(bounds, " and ");
}

void read(const PieceNode& piece, Tilt& tilt) {
  const Mapping mapping(piece.value(), piece.word(), {"of", "degrees"});
  tilt.of = read_object(mapping.at("of"), piece.scope);
  tilt.degrees = mapping.at("degrees").number(0, 180);
}

std::string write(const Tilt& c) {
  return fmt::format("{{of: {}, degrees: {}}}", yaml_scalar(c.of), c.degrees);
}

std::string words(const Tilt& c, const Physics&) {
  return fmt::format("{} tilted by more than {} degrees", c.of, number_text(c.degrees));
}

void read(const PieceNode& piece, GoalsReached&) { piece.needs_goals(); }
std::string words(const GoalsReached&, const Physics&) { return "all goals reached"; }

Condition read_condition(const Node& node, const Scope& scope) {
  const PieceNode piece = read_piece(node, "a condition", scope);
  piece.name.choice("condition", names_of<Condition>());
  return read_named<Condition>(piece, [&](auto& condition) { read(piece, condition); });
}

}  // namespace

// ---- any of them --------------------------------------------------------------------------

std::vector<Condition> read_conditions(const Node& node, const Scope& scope) {
  if (!node.is_sequence()) return {read_condition(node, scope)};
  std::vector<Condition> conditions;
  for (const Node& item : node.items()) conditions.push_back(read_condition(item, scope));
  if (conditions.empty()) throw node.error("at least one condition is expected");
  return conditions;
}

std::string condition_to_yaml(const Condition& condition) {
  return std::visit([]<typename T>(const T& c) { return piece_to_yaml(T::name, write(c)); },
                    condition);
}

std::string conditions_to_words(const std::vector<Condition>& conditions, const Physics& physics) {
  std::vector<std::string> parts;
  parts.reserve(conditions.size());
  for (const Condition& condition : conditions)
    parts.push_back(std::visit([&](const auto& c) { return words(c, physics); }, condition));
  return joined(parts, " and ");
}

}  // namespace evo
