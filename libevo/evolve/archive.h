// Archives of what is good in its own way: a grid over features of robots, the fittest
// kept in each cell (MAP-Elites: Mouret and Clune, "Illuminating search spaces by
// mapping elites", arXiv:1504.04909, 2015, section 3).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libevo/body/body.h"

namespace evo {

// An axis of the grid: `bins` equal parts of [low, high]; what lies beyond an end counts
// to the bin there.
struct FeatureAxis {
  std::string name;
  int bins = 5;
  double low = 0.0;
  double high = 1.0;
};

class GridArchive {
 public:
  using Cell = std::vector<int>;  // bin on each axis, from 0

  // Throws Error(usage) without axes, for no bins, for an empty range, or for more
  // than 10^9 cells.
  explicit GridArchive(std::vector<FeatureAxis> axes);

  // Where these features [axes] lie; nowhere if one is not a number.
  std::optional<Cell> cell(std::span<const double> features) const;
  // Puts an individual, by a number of the caller's, into its cell if that is empty or
  // its elite is less fit. True if it is in. A fitness that is not a number never is.
  bool add(std::size_t individual, std::span<const double> features, double fitness);

  struct Elite {
    std::size_t individual = 0;
    double fitness = 0.0;
  };
  const std::map<Cell, Elite>& elites() const { return elites_; }  // by cell
  const std::vector<FeatureAxis>& axes() const { return axes_; }
  std::size_t cells() const;

 private:
  std::vector<FeatureAxis> axes_;
  std::map<Cell, Elite> elites_;
};

// ---- features of bodies, all in [0, 1] ---------------------------------------------

//   filled      cells with a voxel, of all cells
//   actuated    actuators, of the voxels
//   horizontal  horizontal actuators, of the actuators
//   rigid       rigid voxels, of the voxels
//   height      rows between the lowest and the highest voxel, of all rows
//   width       the same of columns
//   feet        runs of voxels in the lowest row that has any, of as many as fit there
//   symmetry    cells that equal their mirror image left to right, of all cells
// Nothing for another name.
std::optional<double> body_feature(const Body& body, const std::string& name);
const std::vector<std::string>& body_features();

}  // namespace evo
