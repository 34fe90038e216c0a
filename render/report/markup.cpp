#include "render/report/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include "formats/io/base64.h"

namespace evo::report {
namespace {

// Horizontal runs of one kind, as strokes one voxel thick: "M1 0.5h3".
std::string strokes(const Body& body, Voxel kind) {
  std::string path;
  for (int row = 0; row < body.rows; ++row)
    for (int col = 0; col < body.cols;) {
      int end = col;
      while (end < body.cols && body.at(row, end) == kind) ++end;
      if (end > col) path += fmt::format("M{} {}.5h{}", col, row, end - col);
      col = std::max(end, col + 1);
    }
  return path;
}

std::string grid_lines(const Body& body) {
  std::string path;
  for (int row = 1; row < body.rows; ++row) path += fmt::format("M0 {}h{}", row, body.cols);
  for (int col = 1; col < body.cols; ++col) path += fmt::format("M{} 0v{}", col, body.rows);
  return path;
}

// Sides between neighbours that are not linked.
std::string open_sides(const Body& body) {
  std::string path;
  for (const Link& side : full_links(body.rows, body.cols, body.cells)) {
    if (std::binary_search(body.links.begin(), body.links.end(), side)) continue;
    const bool horizontal = side.b == side.a + 1;
    path +=
        fmt::format("M{} {}{}", side.b % body.cols, side.b / body.cols, horizontal ? "v1" : "h1");
  }
  return path;
}

}  // namespace

std::string data_uri(const std::string& media_type, std::string_view bytes) {
  return "data:" + media_type + ";base64," + base64(bytes);
}

std::string fill(std::string_view page, const std::map<std::string, std::string>& values) {
  std::string filled;
  for (std::size_t at = 0;;) {
    const std::size_t open = page.find("{{", at);
    filled += page.substr(at, open - at);
    if (open == std::string_view::npos) return filled;
    const std::size_t close = page.find("}}", open);
    const auto value = values.find(std::string(page.substr(open + 2, close - open - 2)));
    if (value == values.end()) throw std::logic_error("a page names a value that is not there");
    filled += value->second;
    at = close + 2;
  }
}

std::string shown(const std::optional<double>& fitness) {
  return fitness ? fmt::format("{:.4g}", *fitness) : "failed";
}

std::string with_error(double value, double error) {
  if (!(error > 0)) return fmt::format("{:.4g}", value);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(error))), 0, 9);
  return fmt::format("{:.{}f} ± {:.{}f}", value, decimals, error, decimals);
}

const char* kind_name(Voxel voxel) {
  constexpr std::array names{"empty", "rigid", "soft", "horizontal", "vertical", "fixed"};
  return names.at(static_cast<std::size_t>(voxel));
}

std::string symbol(const std::string& id, const Body& body) {
  std::string paths;
  for (const Voxel kind : {Voxel::rigid, Voxel::soft, Voxel::horizontal, Voxel::vertical})
    if (const std::string path = strokes(body, kind); !path.empty())
      paths += fmt::format("<path class=\"{}\" d=\"{}\"/>", letter(kind), path);
  const std::string open = open_sides(body);
  return fmt::format(
      "<symbol id=\"b-{}\" viewBox=\"0 0 {} {}\">{}<path class=\"grid\" d=\"{}\"/>{}"
      "</symbol>\n",
      id, body.cols, body.rows, paths, grid_lines(body),
      open.empty() ? "" : "<path class=\"open\" d=\"" + open + "\"/>");
}

std::string picture(const std::string& id, const Body& body, const std::vector<Change>& changed) {
  std::string marks;
  for (const Change& change : changed)
    marks += fmt::format("M{} {}h1v1h-1z", change.col, change.row);
  if (!marks.empty()) marks = "<path class=\"changed\" d=\"" + marks + "\"/>";
  return fmt::format(
      "<svg class=\"body\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"robot "
      "{}\"><use href=\"#b-{}\"/>{}</svg>",
      body.cols, body.rows, id, id, marks);
}

}  // namespace evo::report
