// Reward terms: how each is read, written and told.

#include "formats/io/number.h"
#include "formats/task/pieces.h"
#include "libevo/base/join.h"
#include "libevo/base/overloaded.h"

namespace evo {
namespace {

// `words`: a formula (d is the change in a step) and what it rewards.

// ---- centres and shapes ---------------------------------------------------------------

TermWords words(const reward::Displacement& t, const Physics&) {
  return {fmt::format("d{}({})", axis_letter(t.axis), t.of),
          fmt::format("how far {} moves {}", t.of, t.axis == Axis::x ? "to the right" : "up")};
}

TermWords words(const reward::Distance& t, const Physics&) {
  return {
      fmt::format("|d{}({})|", axis_letter(t.axis), t.of),
      fmt::format("how far {} moves {}", t.of, t.axis == Axis::x ? "left or right" : "up or down")};
}

TermWords words(const reward::Extent& t, const Physics&) {
  const char* side = t.axis == Axis::x ? "width" : "height";
  return {fmt::format("d{}({})", side, t.of), fmt::format("growth of {}'s {}", t.of, side)};
}

void read(const PieceNode& piece, reward::Approach& approach) {
  const Mapping mapping(piece.value(), piece.word(), {"of", "axis", "to"});
  approach.of = read_object(mapping.at("of"), piece.scope);
  approach.axis = read_axis(mapping.at("axis"));
  const Node to = mapping.at("to");
  if (to.is_scalar() && finite_number(to.string()))
    approach.to = read_length(to);
  else
    approach.to = read_object(to, piece.scope);
}

std::string write(const reward::Approach& t) {
  const std::string to =
      std::visit(Overloaded{[](double place) { return fmt::format("{}", place); },
                            [](const std::string& object) { return yaml_scalar(object); }},
                 t.to);
  return fmt::format("{{of: {}, axis: {}, to: {}}}", yaml_scalar(t.of), word(t.axis), to);
}

TermWords words(const reward::Approach& t, const Physics& physics) {
  const std::string own = fmt::format("{}({})", axis_letter(t.axis), t.of);
  return std::visit(
      Overloaded{[&](double place) -> TermWords {
                   return {
                       fmt::format("-d|{} - {}|", number_text(place * physics.voxel_length), own),
                       fmt::format("how much nearer {} comes to {} = {}", t.of, word(t.axis),
                                   length_text(place, physics))};
                 },
                 [&](const std::string& object) -> TermWords {
                   return {fmt::format("-d|{}({}) - {}|", axis_letter(t.axis), object, own),
                           fmt::format("how much nearer {} comes to {}", t.of, object)};
                 }},
      t.to);
}

TermWords words(const reward::HullArea& t, const Physics&) {
  return {fmt::format("dA({})", t.of), fmt::format("growth of the area of {}'s convex hull", t.of)};
}

TermWords words(const reward::Rotation& t, const Physics&) {
  return {fmt::format("dangle({})", t.of),
          fmt::format("radians that {} turns counter-clockwise", t.of)};
}

// ---- goals ------------------------------------------------------------------------------

void read(const PieceNode& piece, reward::GoalApproach&) { piece.needs_goals(); }
TermWords words(const reward::GoalApproach&, const Physics&) {
  return {"-d|goal - X(robot)|", "how much nearer the robot comes to the current goal"};
}

// ---- actions ----------------------------------------------------------------------------

void read(const PieceNode& piece, reward::Effort&) { piece.no_value(); }
TermWords words(const reward::Effort&, const Physics&) {
  return {"sum (a - 1)^2", "squared distance of the targets from the rest lengths"};
}

void read(const PieceNode& piece, reward::ActionChange&) { piece.no_value(); }
TermWords words(const reward::ActionChange&, const Physics&) {
  return {"sum (da)^2", "squared change of the targets"};
}

// The one key of a list item that is neither `weight` nor `when`.
PieceNode read_term_key(const Node& node, const Scope& scope) {
  std::optional<PieceNode> piece;
  for (const auto& [key, value] : node.entries()) {
    if (key.string() == "weight" || key.string() == "when") continue;
    if (piece) throw key.error("one reward term is expected in a list item, found a second");
    piece.emplace(PieceNode{key, value, scope});
  }
  if (!piece)
    throw node.error(
        fmt::format("a reward term is expected: {}", joined(names_of<reward::Term>(), ", ")));
  return *piece;
}

reward::Term read_term(const PieceNode& piece) {
  return read_named<reward::Term>(piece, [&](auto& term) { read(piece, term); });
}

}  // namespace

// ---- any of them --------------------------------------------------------------------------

RewardTerm read_reward(const Node& node, const Scope& scope) {
  if (node.is_scalar()) {
    node.choice("reward term", names_of<reward::Term>());
    return {1.0, read_term({node, std::nullopt, scope}), {}};
  }
  std::vector<std::string> allowed = names_of<reward::Term>();
  allowed.insert(allowed.end(), {"weight", "when"});
  const Mapping mapping(node, "reward term", allowed);
  RewardTerm term{1.0, read_term(read_term_key(node, scope)), {}};
  if (const auto weight = mapping.find("weight")) term.weight = weight->number();
  if (const auto when = mapping.find("when")) term.when = read_conditions(*when, scope);
  return term;
}

std::string term_to_yaml(const reward::Term& term) {
  return std::visit([]<typename T>(const T& t) { return piece_to_yaml(T::name, write(t), ":"); },
                    term);
}

TermWords term_to_words(const reward::Term& term, const Physics& physics) {
  return std::visit([&](const auto& t) { return words(t, physics); }, term);
}

}  // namespace evo
