#include "libevo/evolve/archive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libevo/base/error.h"
#include "libevo/body/extent.h"

namespace evo {

// ---- the grid ----------------------------------------------------------------------

GridArchive::GridArchive(std::vector<FeatureAxis> axes) : axes_(std::move(axes)) {
  constexpr double most_cells = 1e9;
  if (axes_.empty()) throw Error(Failure::usage, "an archive needs a feature");
  double cells = 1.0;
  for (const FeatureAxis& axis : axes_) {
    if (axis.bins < 1)
      throw error(Failure::usage, "feature {}: {} bins make no grid", axis.name, axis.bins);
    if (!(axis.low < axis.high) || !std::isfinite(axis.high - axis.low))
      throw error(Failure::usage, "feature {}: nothing lies between {} and {}", axis.name, axis.low,
                  axis.high);
    cells *= axis.bins;
  }
  if (cells > most_cells) throw error(Failure::usage, "an archive of {} cells is too large", cells);
}

std::optional<GridArchive::Cell> GridArchive::cell(std::span<const double> features) const {
  Cell cell;
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    const FeatureAxis& axis = axes_[k];
    if (std::isnan(features[k])) return std::nullopt;
    const double share =
        (std::clamp(features[k], axis.low, axis.high) - axis.low) / (axis.high - axis.low);
    cell.push_back(std::min(static_cast<int>(share * axis.bins), axis.bins - 1));
  }
  return cell;
}

bool GridArchive::add(std::size_t individual, std::span<const double> features, double fitness) {
  if (std::isnan(fitness)) return false;
  const std::optional<Cell> where = cell(features);
  if (!where) return false;
  const auto [elite, is_first] = elites_.try_emplace(*where, Elite{individual, fitness});
  if (!is_first && fitness > elite->second.fitness) elite->second = {individual, fitness};
  return elite->second.individual == individual;
}

std::size_t GridArchive::cells() const {
  std::size_t cells = 1;
  for (const FeatureAxis& axis : axes_) cells *= static_cast<std::size_t>(axis.bins);
  return cells;
}

// ---- features of bodies ---------------------------------------------------------------

namespace {

double share(int part, int whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

int count(const Body& body, Voxel kind) {
  return static_cast<int>(std::count(body.cells.begin(), body.cells.end(), kind));
}

bool has_voxel(const Body& body, int row, int col) { return body.at(row, col) != Voxel::empty; }

int feet(const Body& body) {
  const int lowest = extent(body).bottom;
  int runs = 0;
  for (int col = 0; lowest >= 0 && col < body.cols; ++col)
    if (has_voxel(body, lowest, col) && (col == 0 || !has_voxel(body, lowest, col - 1))) ++runs;
  return runs;
}

int mirrored_cells(const Body& body) {
  int same = 0;
  for (int row = 0; row < body.rows; ++row)
    for (int col = 0; col < body.cols; ++col)
      if (body.at(row, col) == body.at(row, body.cols - 1 - col)) ++same;
  return same;
}

struct Feature {
  const char* name;
  double (*measure)(const Body&);
};
constexpr std::array features{
    Feature{"filled", [](const Body& b) { return share(count_voxels(b), b.rows * b.cols); }},
    Feature{"actuated", [](const Body& b) { return share(count_actuators(b), count_voxels(b)); }},
    Feature{"horizontal",
            [](const Body& b) { return share(count(b, Voxel::horizontal), count_actuators(b)); }},
    Feature{"rigid", [](const Body& b) { return share(count(b, Voxel::rigid), count_voxels(b)); }},
    Feature{"height", [](const Body& b) { return share(extent(b).rows(), b.rows); }},
    Feature{"width", [](const Body& b) { return share(extent(b).cols(), b.cols); }},
    Feature{"feet", [](const Body& b) { return share(feet(b), (b.cols + 1) / 2); }},
    Feature{"symmetry", [](const Body& b) { return share(mirrored_cells(b), b.rows * b.cols); }},
};

}  // namespace

std::optional<double> body_feature(const Body& body, const std::string& name) {
  for (const Feature& feature : features)
    if (name == feature.name) return feature.measure(body);
  return std::nullopt;
}

const std::vector<std::string>& body_features() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Feature& feature : features) list.emplace_back(feature.name);
    return list;
  }();
  return names;
}

}  // namespace evo
