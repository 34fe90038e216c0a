#include "libevo/body/body.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "libevo/base/digest.h"
#include "libevo/base/error.h"
#include "libevo/body/components.h"

namespace evo {
namespace {

constexpr std::string_view letters = ".RSHV#";

std::string place(int row, int col) { return fmt::format("row {}, column {}", row + 1, col + 1); }

std::string place(const Body& body, int cell) { return place(cell / body.cols, cell % body.cols); }

bool in_matrix(const Body& body, int cell) {
  return cell >= 0 && static_cast<std::size_t>(cell) < body.cells.size();
}

bool is_voxel(const Body& body, int cell) {
  return body.cells[static_cast<std::size_t>(cell)] != Voxel::empty;
}

bool are_adjacent(const Body& body, int a, int b) {
  const bool side_by_side = b == a + 1 && a / body.cols == b / body.cols;
  return side_by_side || b == a + body.cols;
}

// What keeps the body from being one that the other functions may look at.
std::optional<std::string> structural_defect(const Body& body) {
  if (body.rows < 1 || body.cols < 1)
    return fmt::format("a body of {} rows and {} columns has no cells", body.rows, body.cols);
  if (body.cells.size() !=
      static_cast<std::size_t>(body.rows) * static_cast<std::size_t>(body.cols))
    return fmt::format("{} rows of {} columns need {} cells, there are {}", body.rows, body.cols,
                       static_cast<std::size_t>(body.rows) * static_cast<std::size_t>(body.cols),
                       body.cells.size());
  for (std::size_t i = 0; i < body.cells.size(); ++i)
    if (static_cast<std::size_t>(body.cells[i]) >= letters.size())
      return fmt::format("unknown voxel type {} at {}", static_cast<int>(body.cells[i]),
                         place(body, static_cast<int>(i)));
  return std::nullopt;
}

// A voxel that no chain of links joins to the first one, as a message.
std::optional<std::string> connection_defect(const Body& body) {
  Components components(body.cells.size());
  for (const Link& link : body.links) components.join(link.a, link.b);
  int first = -1;
  for (int cell = 0; std::cmp_less(cell, body.cells.size()); ++cell) {
    if (!is_voxel(body, cell)) continue;
    if (first < 0) first = cell;
    if (components.root(cell) != components.root(first))
      return fmt::format("the voxel at {} is not connected to the one at {}", place(body, cell),
                         place(body, first));
  }
  if (first < 0) return "there is no voxel, all cells are empty";
  return std::nullopt;
}

}  // namespace

char letter(Voxel voxel) { return letters[static_cast<std::size_t>(voxel)]; }

const char* kind_name(Voxel voxel) {
  constexpr std::array names{"empty", "rigid", "soft", "horizontal", "vertical", "fixed"};
  return names.at(static_cast<std::size_t>(voxel));
}

std::optional<Voxel> voxel_from_letter(char letter) {
  const std::size_t i = letters.find(letter);
  if (i == std::string_view::npos) return std::nullopt;
  return static_cast<Voxel>(i);
}

Body::Body(int rows_, int cols_, std::vector<Voxel> cells_)
    : rows(rows_), cols(cols_), cells(std::move(cells_)), links(full_links(rows, cols, cells)) {}

Body Body::from_rows(const std::vector<std::string>& rows) {
  if (rows.empty() || rows.front().empty()) throw Error(Failure::data, "a body without cells");
  const std::size_t width = rows.front().size();
  std::vector<Voxel> cells;
  cells.reserve(rows.size() * width);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].size() != width)
      throw error(Failure::data, "row {} has {} cells, but row 1 has {}", r + 1, rows[r].size(),
                  width);
    for (std::size_t c = 0; c < width; ++c) {
      const auto voxel = voxel_from_letter(rows[r][c]);
      if (!voxel)
        throw error(Failure::data, "unknown letter {:?} at row {}, column {}; allowed . R S H V #",
                    rows[r][c], r + 1, c + 1);
      cells.push_back(*voxel);
    }
  }
  return {static_cast<int>(rows.size()), static_cast<int>(width), std::move(cells)};
}

std::vector<std::string> Body::to_rows() const {
  std::vector<std::string> drawn(static_cast<std::size_t>(rows));
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < cols; ++c) drawn[static_cast<std::size_t>(r)] += letter(at(r, c));
  return drawn;
}

Body with_stiffness(Body body, std::vector<double> stiffness) {
  if (stiffness.size() != body.cells.size())
    throw error(Failure::data, "{} factors of stiffness for {} cells", stiffness.size(),
                body.cells.size());
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    if (body.cells[i] == Voxel::empty) stiffness[i] = 1.0;
    if (!(stiffness[i] >= softest && stiffness[i] <= stiffest))
      throw error(Failure::data, "stiffness {} at {}: a factor from {} to {} is expected",
                  stiffness[i], place(body, static_cast<int>(i)), softest, stiffest);
  }
  const bool plain =
      std::all_of(stiffness.begin(), stiffness.end(), [](double s) { return s == 1.0; });
  body.stiffness = plain ? std::vector<double>() : std::move(stiffness);
  return body;
}

std::vector<Link> full_links(int rows, int cols, const std::vector<Voxel>& cells) {
  std::vector<Link> links;
  links.reserve(2 * cells.size());
  const auto filled = [&](int cell) {
    return cells[static_cast<std::size_t>(cell)] != Voxel::empty;
  };
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const int cell = r * cols + c;
      if (!filled(cell)) continue;
      if (c + 1 < cols && filled(cell + 1)) links.push_back({cell, cell + 1});
      if (r + 1 < rows && filled(cell + cols)) links.push_back({cell, cell + cols});
    }
  }
  return links;  // made in sorted order
}

int count_voxels(const Body& body) {
  const auto empty = std::count(body.cells.begin(), body.cells.end(), Voxel::empty);
  return static_cast<int>(body.cells.size()) - static_cast<int>(empty);
}

int count_actuators(const Body& body) {
  return static_cast<int>(std::count_if(body.cells.begin(), body.cells.end(), is_actuator));
}

bool is_connected(const Body& body) { return !connection_defect(body); }

bool is_valid_robot(const Body& body) { return count_actuators(body) > 0 && is_connected(body); }

std::optional<std::string> link_defect(const Body& body) {
  for (const Link& link : body.links) {
    for (const int end : {link.a, link.b}) {
      if (!in_matrix(body, end))
        return fmt::format("connection {}-{} names cell {}, but cells are numbered 0 to {}", link.a,
                           link.b, end, body.cells.size() - 1);
      if (!is_voxel(body, end))
        return fmt::format("connection {}-{} names the empty cell at {}", link.a, link.b,
                           place(body, end));
    }
    if (!are_adjacent(body, std::min(link.a, link.b), std::max(link.a, link.b)))
      return fmt::format("connection {}-{} joins cells that are not adjacent: {} and {}", link.a,
                         link.b, place(body, link.a), place(body, link.b));
  }
  return std::nullopt;
}

std::optional<std::string> defect(const Body& body, bool needs_actuator) {
  if (auto found = structural_defect(body)) return found;
  if (auto found = link_defect(body)) return found;
  if (auto found = connection_defect(body)) return found;
  if (needs_actuator && count_actuators(body) == 0)
    return "there is no actuator (H or V), nothing can move this robot";
  return std::nullopt;
}

std::string identity(const Body& body) {
  std::vector<Link> links = body.links;
  for (Link& link : links)
    if (link.a > link.b) std::swap(link.a, link.b);
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());

  std::string text = fmt::format("evo1\n{}x{}\n", body.rows, body.cols);
  for (const std::string& row : body.to_rows()) text.append(row).push_back('\n');
  for (const Link& link : links) text += fmt::format("{}-{}\n", link.a, link.b);
  for (const double factor : body.stiffness) text += fmt::format("{}\n", factor);

  constexpr std::size_t identity_digits = 12;
  return sha256_hex(text).substr(0, identity_digits);
}

}  // namespace evo
