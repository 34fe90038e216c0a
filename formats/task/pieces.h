// The pieces of a task - observation parts, conditions, reward terms - as YAML
// and in words. One source file per list (observation.cpp, conditions.cpp,
// reward.cpp), with functions for each piece: `read` takes over its value, `write`
// gives it back as YAML ("" for none), `words` tells what it is. A piece of
// libevo/task/spec.h without one of them does not compile.
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "formats/io/node.h"
#include "formats/task/world.h"
#include "libevo/base/alternatives.h"
#include "libevo/task/spec.h"

namespace evo {

// What a piece may refer to.
struct Scope {
  std::vector<std::string> objects;  // robot first
  bool has_goals = false;
};

// ---- the three lists ----------------------------------------------------------------

ObservationPart read_part(const Node& node, const Scope& scope);
std::string part_to_yaml(const ObservationPart& part);  // "velocity: \"robot\""
std::string part_to_words(const ObservationPart& part, const Physics& physics);

// One condition, or a list; all of it has to hold.
std::vector<Condition> read_conditions(const Node& node, const Scope& scope);
std::string condition_to_yaml(const Condition& condition);
std::string conditions_to_words(const std::vector<Condition>& conditions, const Physics& physics);

// A term with its weight and conditions.
RewardTerm read_reward(const Node& node, const Scope& scope);
std::string term_to_yaml(const reward::Term& term);
struct TermWords {
  std::string formula;
  std::string words;
};
TermWords term_to_words(const reward::Term& term, const Physics& physics);

// ---- one piece ------------------------------------------------------------------------

// A piece as it is written: a word (`- goal_index`), or a word with a value
// (`- velocity: robot`).
struct PieceNode {
  Node name;
  std::optional<Node> given;
  const Scope& scope;

  std::string word() const { return name.string(); }
  Node value() const;          // throws where there is none
  std::string object() const;  // of the value: a name in scope
  void no_value() const;       // throws where there is one
  void needs_goals() const;    // no value, and goals to look at
};

// `what` is "an observation part", "a condition", for messages.
PieceNode read_piece(const Node& node, const std::string& what, const Scope& scope);

std::string read_object(const Node& node, const Scope& scope);
Axis read_axis(const Node& node);
double read_length(const Node& node);  // voxels

const char* axis_letter(Axis axis);  // X, in formulas

// ---- numbers in words -------------------------------------------------------------------

std::string number_text(double value);
// A length in voxels, shown raw as it is compared: "9.9 (99 voxels)".
std::string length_text(double voxels, const Physics& physics);

// ---- pieces with the same fields -----------------------------------------------------------

template <typename T, typename... Fields>
concept HasMore = requires(Fields... fields) {
  T{fields..., {}};
};
// Fields of these types and no others.
template <typename T, typename... Fields>
concept HasOnly = !HasMore<T, Fields...> && requires(Fields... fields) {
  T{fields...};
};
template <typename T>
concept HasNone = std::is_empty_v<T>;

// An object, `of`.
template <HasOnly<std::string> T>
void read(const PieceNode& piece, T& t) {
  t.of = piece.object();
}

template <HasOnly<std::string> T>
std::string write(const T& t) {
  return yaml_scalar(t.of);
}

// `of` and `axis`.
template <HasOnly<std::string, Axis> T>
void read(const PieceNode& piece, T& t) {
  const Mapping mapping(piece.value(), piece.word(), {"of", "axis"});
  t = {read_object(mapping.at("of"), piece.scope), read_axis(mapping.at("axis"))};
}

template <HasOnly<std::string, Axis> T>
std::string write(const T& t) {
  return fmt::format("{{of: {}, axis: {}}}", yaml_scalar(t.of), word(t.axis));
}

template <HasNone T>
std::string write(const T&) {
  return "";
}

// ---- one of a list --------------------------------------------------------------------------

// The piece whose name is written, which is known to be in the list; `take` reads its value.
template <typename Variant, typename Take>
Variant read_named(const PieceNode& piece, const Take& take) {
  Variant found;
  for_each_alternative<Variant>([&]<typename T>(std::type_identity<T>) {
    if (piece.word() == T::name) take(found.template emplace<T>());
  });
  return found;
}

// "velocity: \"robot\""; without a value the name and `alone`.
std::string piece_to_yaml(const std::string& name, const std::string& value,
                          const char* alone = "");

}  // namespace evo
