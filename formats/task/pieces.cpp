#include "formats/task/pieces.h"

namespace evo {
namespace {

constexpr double largest_length = 1e6;  // voxels

}  // namespace

Node PieceNode::value() const {
  if (given) return *given;
  throw name.error(fmt::format("'{}' needs a value", word()));
}

std::string PieceNode::object() const { return read_object(value(), scope); }

void PieceNode::no_value() const {
  if (given && !given->is_null()) throw given->error(fmt::format("'{}' takes no value", word()));
}

void PieceNode::needs_goals() const {
  no_value();
  if (!scope.has_goals) throw name.error(word() + " needs the task to have `goals`");
}

PieceNode read_piece(const Node& node, const std::string& what, const Scope& scope) {
  if (node.is_scalar()) return {node, std::nullopt, scope};
  const auto& entries = node.entries();
  if (entries.size() != 1)
    throw node.error(
        fmt::format("{} with one name is expected, found {} keys", what, entries.size()));
  return {entries[0].key, entries[0].value, scope};
}

std::string read_object(const Node& node, const Scope& scope) {
  return node.choice("object", scope.objects);
}

Axis read_axis(const Node& node) { return node.choice<Axis>("axis"); }

double read_length(const Node& node) { return node.number(-largest_length, largest_length); }

const char* axis_letter(Axis axis) { return axis == Axis::x ? "X" : "Y"; }

std::string number_text(double value) { return fmt::format("{:.6g}", value); }

std::string length_text(double voxels, const Physics& physics) {
  return fmt::format("{} ({} voxel{})", number_text(voxels * physics.voxel_length),
                     number_text(voxels), voxels == 1.0 ? "" : "s");
}

std::string piece_to_yaml(const std::string& name, const std::string& value, const char* alone) {
  return name + (value.empty() ? alone : ": " + value);
}

}  // namespace evo
