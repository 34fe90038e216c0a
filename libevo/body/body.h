// A body: a matrix of voxels and the links between them. Everything that is
// made of voxels is one: robots, packages, terrain (docs/methods.md, "Robots").
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace evo {

enum class Voxel : std::uint8_t { empty, rigid, soft, horizontal, vertical, fixed };

// One letter per voxel: . R S H V # in the order of the enumeration.
char letter(Voxel voxel);
std::optional<Voxel> voxel_from_letter(char letter);
const char* kind_name(Voxel voxel);  // "rigid"; "empty"
// Those of robots, in the order of every list of them.
inline constexpr std::array voxel_kinds{Voxel::rigid, Voxel::soft, Voxel::horizontal,
                                        Voxel::vertical};
inline bool is_actuator(Voxel v) { return v == Voxel::horizontal || v == Voxel::vertical; }

// Robots are refused beyond this many rows or columns.
inline constexpr int largest_side = 1000;

// Two adjacent cells joined to each other, as row-major indices of the whole
// matrix, the smaller one first.
struct Link {
  int a = 0;
  int b = 0;
  auto operator<=>(const Link&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14
};

struct Body {
  int rows = 0;
  int cols = 0;
  std::vector<Voxel> cells;  // rows*cols, row-major, row 0 on top
  std::vector<Link> links;   // sorted, unique; both ends non-empty and adjacent
  // rows*cols factors of the stiffness of each voxel's springs, 1 in empty cells; none: all 1.
  // A spring that two voxels share has the mean of theirs (docs/physics.md, "Springs").
  std::vector<double> stiffness;

  Body() = default;
  // All adjacent pairs of non-empty cells linked.
  Body(int rows, int cols, std::vector<Voxel> cells);
  // As drawn: one string per row, top row first. Throws Error(data) naming the
  // cell for ragged rows or unknown letters.
  static Body from_rows(const std::vector<std::string>& rows);

  Voxel at(int row, int col) const {
    return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) +
                 static_cast<std::size_t>(col)];
  }
  int index(int row, int col) const { return row * cols + col; }
  std::vector<std::string> to_rows() const;
  double stiffness_of(std::size_t cell) const { return stiffness.empty() ? 1.0 : stiffness[cell]; }
  bool operator==(const Body&) const = default;
};

// The least and the greatest factor of a voxel's stiffness.
inline constexpr double softest = 0.1;
inline constexpr double stiffest = 10.0;

// The body with these factors, [rows*cols]; those of empty cells do not count. Throws
// Error(data) for another number of them, or naming the cell of one out of range.
Body with_stiffness(Body body, std::vector<double> stiffness);

// Every adjacent pair of non-empty cells, sorted.
std::vector<Link> full_links(int rows, int cols, const std::vector<Voxel>& cells);

int count_voxels(const Body& body);     // non-empty cells
int count_actuators(const Body& body);  // length of an action vector

// The links join all non-empty cells; there is at least one.
bool is_connected(const Body& body);
// Connected and has an actuator: what every operator on robots keeps true.
bool is_valid_robot(const Body& body);

// What is wrong with the body, in words that name the cell ("row 2, column 3",
// counted from 1 at the top left), or nothing. `needs_actuator` for robots.
std::optional<std::string> defect(const Body& body, bool needs_actuator);
// The same for the links alone: one that names no cell, an empty cell, or two
// cells that are not adjacent.
std::optional<std::string> link_defect(const Body& body);

// First 12 hex digits of the SHA-256 of the canonical text of body, links and stiffness
// (docs/formats/robot.md). Equal bodies have equal ids on any machine.
std::string identity(const Body& body);

}  // namespace evo
