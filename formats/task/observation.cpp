// Observation parts: how each is read, written and told.

#include "formats/task/pieces.h"
#include "formats/task/world.h"
#include "libevo/base/join.h"

namespace evo {
namespace {

using namespace observation;

constexpr int widest_clearance = 1000;  // bins to either side

// read: from YAML; write: its value in YAML, "" for none; words: what it is.
template <typename Part>
struct Form;

template <>
struct Form<Velocity> {
  static Velocity read(const PieceNode& piece) { return {piece.object()}; }
  static std::string write(const Velocity& part) { return yaml_scalar(part.of); }
  static std::string words(const Velocity& part, const Physics&) {
    return fmt::format("mean velocity of {} (x, y)", part.of);
  }
};

template <>
struct Form<Orientation> {
  static Orientation read(const PieceNode& piece) { return {piece.object()}; }
  static std::string write(const Orientation& part) { return yaml_scalar(part.of); }
  static std::string words(const Orientation& part, const Physics&) {
    return fmt::format("how far {} is turned, radians in [0, 2 pi)", part.of);
  }
};

template <>
struct Form<RelativePositions> {
  static RelativePositions read(const PieceNode& piece) { return {piece.object()}; }
  static std::string write(const RelativePositions& part) { return yaml_scalar(part.of); }
  static std::string words(const RelativePositions& part, const Physics&) {
    return fmt::format("points of {} relative to its centre: all x, then all y", part.of);
  }
};

template <>
struct Form<Offset> {
  static Offset read(const PieceNode& piece) {
    const Mapping mapping(piece.value(), piece.word(), {"of", "from"});
    return {read_object(mapping.at("of"), piece.scope),
            read_object(mapping.at("from"), piece.scope)};
  }
  static std::string write(const Offset& part) {
    return fmt::format("{{of: {}, from: {}}}", yaml_scalar(part.of), yaml_scalar(part.from));
  }
  static std::string words(const Offset& part, const Physics&) {
    return fmt::format("centre of {} minus centre of {} (x, y)", part.of, part.from);
  }
};

// ---- clearance from terrain -----------------------------------------------------------

std::vector<std::string> read_terrain(const Node& node, const Scope& scope) {
  if (node.is_scalar()) return {read_object(node, scope)};
  std::vector<std::string> objects;
  for (const Node& item : node.items()) objects.push_back(read_object(item, scope));
  if (objects.empty())
    throw node.error("at least one object is expected; leave `over` out for all but the robot");
  return objects;
}

template <typename Clearance>
struct ClearanceForm {
  static Clearance read(const PieceNode& piece) {
    const Mapping mapping(piece.value(), piece.word(), {"width", "range", "over"});
    Clearance part;
    part.width = mapping.at("width").integer(0, widest_clearance);
    if (const auto range = mapping.find("range")) part.range = range->positive();
    if (const auto over = mapping.find("over")) part.over = read_terrain(*over, piece.scope);
    return part;
  }
  static std::string write(const Clearance& part) {
    std::vector<std::string> over;
    for (const std::string& object : part.over) over.push_back(yaml_scalar(object));
    return fmt::format("{{width: {}, range: {}{}}}", part.width, part.range,
                       over.empty() ? "" : fmt::format(", over: [{}]", joined(over, ", ")));
  }
  static std::string words(const Clearance& part, const char* side, const Physics& physics) {
    return fmt::format(
        "distance {} the robot's centre to the nearest point of {}, in {} columns one voxel wide, "
        "at most {}",
        side, part.over.empty() ? "all objects but the robot" : joined(part.over, ", "),
        2 * part.width + 1, length_text(part.range, physics));
  }
};

template <>
struct Form<Floor> : ClearanceForm<Floor> {
  static std::string words(const Floor& part, const Physics& physics) {
    return ClearanceForm::words(part, "below", physics);
  }
};

template <>
struct Form<Ceiling> : ClearanceForm<Ceiling> {
  static std::string words(const Ceiling& part, const Physics& physics) {
    return ClearanceForm::words(part, "above", physics);
  }
};

// ---- goals ------------------------------------------------------------------------------

template <typename Part>
struct GoalForm {
  static Part read(const PieceNode& piece) {
    piece.needs_goals();
    return {};
  }
  static std::string write(const Part&) { return ""; }
};

template <>
struct Form<GoalIndex> : GoalForm<GoalIndex> {
  static std::string words(const GoalIndex&, const Physics&) {
    return "how many goals have been reached";
  }
};

template <>
struct Form<GoalPosition> : GoalForm<GoalPosition> {
  static std::string words(const GoalPosition&, const Physics&) { return "the current goal's x"; }
};

template <>
struct Form<GoalOffset> : GoalForm<GoalOffset> {
  static std::string words(const GoalOffset&, const Physics&) {
    return "the current goal's x minus that of the robot's centre";
  }
};

}  // namespace

// ---- any of them --------------------------------------------------------------------------

ObservationPart read_part(const Node& node, const Scope& scope) {
  const PieceNode piece = read_piece(node, "an observation part", scope);
  piece.name.choice("observation part", names_of<ObservationPart>());
  return read_form<Form, ObservationPart>(piece);
}

std::string part_to_yaml(const ObservationPart& part) {
  return std::visit(
      []<typename Part>(const Part& p) {
        const std::string value = Form<Part>::write(p);
        return Part::name + (value.empty() ? "" : ": " + value);
      },
      part);
}

std::string part_to_words(const ObservationPart& part, const Physics& physics) {
  return std::visit([&]<typename Part>(const Part& p) { return Form<Part>::words(p, physics); },
                    part);
}

}  // namespace evo
