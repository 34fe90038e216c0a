// Observation parts: how each is read, written and told.

#include <concepts>

#include "formats/task/pieces.h"
#include "libevo/base/join.h"

namespace evo {
namespace {

using namespace observation;

constexpr int widest_clearance = 1000;  // bins to either side

std::string words(const Velocity& part, const Physics&) {
  return fmt::format("mean velocity of {} (x, y)", part.of);
}

std::string words(const Orientation& part, const Physics&) {
  return fmt::format("how far {} is turned, radians in [0, 2 pi)", part.of);
}

std::string words(const RelativePositions& part, const Physics&) {
  return fmt::format("points of {} relative to its centre: all x, then all y", part.of);
}

void read(const PieceNode& piece, Offset& part) {
  const Mapping mapping(piece.value(), piece.word(), {"of", "from"});
  part.of = read_object(mapping.at("of"), piece.scope);
  part.from = read_object(mapping.at("from"), piece.scope);
}

std::string write(const Offset& part) {
  return fmt::format("{{of: {}, from: {}}}", yaml_scalar(part.of), yaml_scalar(part.from));
}

std::string words(const Offset& part, const Physics&) {
  return fmt::format("centre of {} minus centre of {} (x, y)", part.of, part.from);
}

// ---- clearance from terrain -----------------------------------------------------------

std::vector<std::string> read_terrain(const Node& node, const Scope& scope) {
  if (node.is_scalar()) return {read_object(node, scope)};
  std::vector<std::string> objects;
  for (const Node& item : node.items()) objects.push_back(read_object(item, scope));
  if (objects.empty())
    throw node.error("at least one object is expected; leave `over` out for all but the robot");
  return objects;
}

template <typename T>
concept Clearance = std::same_as<T, Floor> || std::same_as<T, Ceiling>;

template <Clearance T>
void read(const PieceNode& piece, T& part) {
  const Mapping mapping(piece.value(), piece.word(), {"width", "range", "over"});
  part.width = mapping.at("width").integer(0, widest_clearance);
  if (const auto range = mapping.find("range")) part.range = range->positive();
  if (const auto over = mapping.find("over")) part.over = read_terrain(*over, piece.scope);
}

template <Clearance T>
std::string write(const T& part) {
  std::vector<std::string> over;
  for (const std::string& object : part.over) over.push_back(yaml_scalar(object));
  return fmt::format("{{width: {}, range: {}{}}}", part.width, part.range,
                     over.empty() ? "" : fmt::format(", over: [{}]", joined(over, ", ")));
}

template <Clearance T>
std::string words(const T& part, const Physics& physics) {
  return fmt::format(
      "distance {} the robot's centre to the nearest point of {}, in {} columns one voxel wide, "
      "at most {}",
      std::same_as<T, Floor> ? "below" : "above",
      part.over.empty() ? "all objects but the robot" : joined(part.over, ", "), 2 * part.width + 1,
      length_text(part.range, physics));
}

// ---- goals ------------------------------------------------------------------------------

void read(const PieceNode& piece, GoalIndex&) { piece.needs_goals(); }
std::string words(const GoalIndex&, const Physics&) { return "how many goals have been reached"; }

void read(const PieceNode& piece, GoalPosition&) { piece.needs_goals(); }
std::string words(const GoalPosition&, const Physics&) { return "the current goal's x"; }

void read(const PieceNode& piece, GoalOffset&) { piece.needs_goals(); }
std::string words(const GoalOffset&, const Physics&) {
  return "the current goal's x minus that of the robot's centre";
}

}  // namespace

// ---- any of them --------------------------------------------------------------------------

ObservationPart read_part(const Node& node, const Scope& scope) {
  const PieceNode piece = read_piece(node, "an observation part", scope);
  piece.name.choice("observation part", names_of<ObservationPart>());
  return read_named<ObservationPart>(piece, [&](auto& part) { read(piece, part); });
}

std::string part_to_yaml(const ObservationPart& part) {
  return std::visit(
      []<typename Part>(const Part& p) { return piece_to_yaml(Part::name, write(p)); }, part);
}

std::string part_to_words(const ObservationPart& part, const Physics& physics) {
  return std::visit([&](const auto& p) { return words(p, physics); }, part);
}

}  // namespace evo
