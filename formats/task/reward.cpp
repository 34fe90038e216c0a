// Reward terms: how each is read, written and told.

#include "formats/io/number.h"
#include "formats/task/pieces.h"
#include "formats/task/world.h"
#include "libevo/base/join.h"
#include "libevo/base/overloaded.h"

namespace evo {
namespace {

using namespace reward;

// read: from YAML; write: its value in YAML, "" for none; words: a formula (d is
// the change in a step) and what it rewards.
template <typename Term>
struct Form;

// ---- centres and shapes ---------------------------------------------------------------

template <typename Term>
struct OfAxisForm {
  static Term read(const PieceNode& piece) {
    const Mapping mapping(piece.value(), piece.word(), {"of", "axis"});
    return {read_object(mapping.at("of"), piece.scope), read_axis(mapping.at("axis"))};
  }
  static std::string write(const Term& t) {
    return fmt::format("{{of: {}, axis: {}}}", yaml_scalar(t.of), word(t.axis));
  }
};

template <>
struct Form<Displacement> : OfAxisForm<Displacement> {
  static TermWords words(const Displacement& t, const Physics&) {
    return {fmt::format("d{}({})", axis_letter(t.axis), t.of),
            fmt::format("how far {} moves {}", t.of, t.axis == Axis::x ? "to the right" : "up")};
  }
};

template <>
struct Form<Distance> : OfAxisForm<Distance> {
  static TermWords words(const Distance& t, const Physics&) {
    return {fmt::format("|d{}({})|", axis_letter(t.axis), t.of),
            fmt::format("how far {} moves {}", t.of,
                        t.axis == Axis::x ? "left or right" : "up or down")};
  }
};

template <>
struct Form<Extent> : OfAxisForm<Extent> {
  static TermWords words(const Extent& t, const Physics&) {
    const char* side = t.axis == Axis::x ? "width" : "height";
    return {fmt::format("d{}({})", side, t.of), fmt::format("growth of {}'s {}", t.of, side)};
  }
};

template <>
struct Form<Approach> {
  static Approach read(const PieceNode& piece) {
    const Mapping mapping(piece.value(), piece.word(), {"of", "axis", "to"});
    Approach approach;
    approach.of = read_object(mapping.at("of"), piece.scope);
    approach.axis = read_axis(mapping.at("axis"));
    const Node to = mapping.at("to");
    if (to.is_scalar() && finite_number(to.string()))
      approach.to = read_length(to);
    else
      approach.to = read_object(to, piece.scope);
    return approach;
  }
  static std::string write(const Approach& t) {
    const std::string to =
        std::visit(Overloaded{[](double place) { return fmt::format("{}", place); },
                              [](const std::string& object) { return yaml_scalar(object); }},
                   t.to);
    return fmt::format("{{of: {}, axis: {}, to: {}}}", yaml_scalar(t.of), word(t.axis), to);
  }
  static TermWords words(const Approach& t, const Physics& physics) {
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
};

template <typename Term>
struct OfForm {
  static Term read(const PieceNode& piece) { return {piece.object()}; }
  static std::string write(const Term& t) { return yaml_scalar(t.of); }
};

template <>
struct Form<HullArea> : OfForm<HullArea> {
  static TermWords words(const HullArea& t, const Physics&) {
    return {fmt::format("dA({})", t.of),
            fmt::format("growth of the area of {}'s convex hull", t.of)};
  }
};

template <>
struct Form<Rotation> : OfForm<Rotation> {
  static TermWords words(const Rotation& t, const Physics&) {
    return {fmt::format("dangle({})", t.of),
            fmt::format("radians that {} turns counter-clockwise", t.of)};
  }
};

// ---- goals ------------------------------------------------------------------------------

template <>
struct Form<GoalApproach> {
  static GoalApproach read(const PieceNode& piece) {
    piece.needs_goals();
    return {};
  }
  static std::string write(const GoalApproach&) { return ""; }
  static TermWords words(const GoalApproach&, const Physics&) {
    return {"-d|goal - X(robot)|", "how much nearer the robot comes to the current goal"};
  }
};

// ---- actions ----------------------------------------------------------------------------

template <typename Term>
struct OfActionsForm {
  static Term read(const PieceNode& piece) {
    piece.no_value();
    return {};
  }
  static std::string write(const Term&) { return ""; }
};

template <>
struct Form<Effort> : OfActionsForm<Effort> {
  static TermWords words(const Effort&, const Physics&) {
    return {"sum (a - 1)^2", "squared distance of the targets from the rest lengths"};
  }
};

template <>
struct Form<ActionChange> : OfActionsForm<ActionChange> {
  static TermWords words(const ActionChange&, const Physics&) {
    return {"sum (da)^2", "squared change of the targets"};
  }
};

// The one key of a list item that is neither `weight` nor `when`.
PieceNode read_term_key(const Node& node, const Scope& scope) {
  std::optional<PieceNode> piece;
  for (const auto& [key, value] : node.entries()) {
    if (key.string() == "weight" || key.string() == "when") continue;
    if (piece) throw key.error("one reward term is expected in a list item, found a second");
    piece.emplace(PieceNode{key, value, scope});
  }
  if (!piece)
    throw node.error(fmt::format("a reward term is expected: {}", joined(names_of<Term>(), ", ")));
  return *piece;
}

}  // namespace

// ---- any of them --------------------------------------------------------------------------

RewardTerm read_reward(const Node& node, const Scope& scope) {
  if (node.is_scalar()) {
    node.choice("reward term", names_of<Term>());
    return {1.0, read_form<Form, Term>({node, std::nullopt, scope}), {}};
  }
  std::vector<std::string> allowed = names_of<Term>();
  allowed.insert(allowed.end(), {"weight", "when"});
  const Mapping mapping(node, "reward term", allowed);
  RewardTerm term{1.0, read_form<Form, Term>(read_term_key(node, scope)), {}};
  if (const auto weight = mapping.find("weight")) term.weight = weight->number();
  if (const auto when = mapping.find("when")) term.when = read_conditions(*when, scope);
  return term;
}

std::string term_to_yaml(const Term& term) {
  return std::visit(
      []<typename T>(const T& t) {
        const std::string value = Form<T>::write(t);
        return T::name + (value.empty() ? ":" : ": " + value);
      },
      term);
}

TermWords term_to_words(const Term& term, const Physics& physics) {
  return std::visit([&]<typename T>(const T& t) { return Form<T>::words(t, physics); }, term);
}

}  // namespace evo
