#include "libevo/body/operators.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"
#include "libevo/body/components.h"

namespace evo {
namespace {

// Cells drawn in vain before sampling gives up: seconds of work, thousands of
// times what any shape needs that has a fair chance.
constexpr std::int64_t most_cells_drawn = 200'000'000;

// Watches a matrix being filled row by row and says as early as possible that
// it cannot become connected: a component without a cell in the newest row can
// never be joined to another one.
class GrowingMatrix {
 public:
  GrowingMatrix(int rows, int cols)
      : cols_(cols),
        components_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols)),
        seen_in_row_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols), -1) {}

  // Before row 0 of another matrix.
  void clear() { count_ = 0; }

  // Rows 0 .. row of `cells` are filled. Whether they can be part of a
  // connected matrix.
  bool add_row(const std::vector<Voxel>& cells, int row) {
    const auto filled = [&](int cell) {
      return cells[static_cast<std::size_t>(cell)] != Voxel::empty;
    };
    for (int c = 0; c < cols_; ++c) {
      const int cell = row * cols_ + c;
      components_.reset(cell);
      seen_in_row_[static_cast<std::size_t>(cell)] = -1;
      if (!filled(cell)) continue;
      ++count_;
      if (c > 0 && filled(cell - 1) && components_.join(cell - 1, cell)) --count_;
      if (row > 0 && filled(cell - cols_) && components_.join(cell - cols_, cell)) --count_;
    }
    return count_ <= 1 || count_ == components_in(cells, row);
  }

  // After the last row.
  bool is_connected() const { return count_ == 1; }

 private:
  int components_in(const std::vector<Voxel>& cells, int row) {
    int found = 0;
    for (int cell = row * cols_; cell < (row + 1) * cols_; ++cell) {
      if (cells[static_cast<std::size_t>(cell)] == Voxel::empty) continue;
      int& seen = seen_in_row_[static_cast<std::size_t>(components_.root(cell))];
      if (seen != row) ++found;
      seen = row;
    }
    return found;
  }

  int cols_;
  int count_ = 0;  // components so far
  Components components_;
  std::vector<int> seen_in_row_;  // by root: the last row it was counted in
};

bool has_actuator(const std::vector<Voxel>& cells) {
  return std::any_of(cells.begin(), cells.end(), is_actuator);
}

// Valid with every adjacent pair linked; `matrix` is scratch of the same shape.
bool is_valid(const std::vector<Voxel>& cells, int rows, GrowingMatrix& matrix) {
  if (!has_actuator(cells)) return false;
  matrix.clear();
  for (int r = 0; r < rows; ++r)
    if (!matrix.add_row(cells, r)) return false;
  return matrix.is_connected();
}

Voxel draw_voxel(const VoxelWeights& weights, Stream& stream) {
  return static_cast<Voxel>(stream.discrete(weights));
}

void check_weights(const VoxelWeights& weights) {
  double sum = 0.0;
  for (const double w : weights) {
    if (!std::isfinite(w) || w < 0.0)
      throw error(Failure::usage, "voxel weight {}: a weight is 0 or a positive number", w);
    sum += w;
  }
  if (!(sum > 0.0) || !std::isfinite(sum))
    throw Error(Failure::usage, "voxel weights: at least one must be above 0");
}

void check_sampling(int rows, int cols, const VoxelWeights& weights) {
  if (rows < 1 || cols < 1 || rows > largest_side || cols > largest_side)
    throw error(Failure::usage, "shape {}x{}: rows and columns go from 1 to {}", rows, cols,
                largest_side);
  check_weights(weights);
  if (weights[static_cast<std::size_t>(Voxel::horizontal)] == 0.0 &&
      weights[static_cast<std::size_t>(Voxel::vertical)] == 0.0)
    throw Error(Failure::usage,
                "voxel weights: both actuators (the 4th and 5th weight, H and V) are 0, such a "
                "robot cannot move; give one of them a weight");
}

}  // namespace

Body sample_body(int rows, int cols, const VoxelWeights& weights, Stream& stream, int attempts) {
  check_sampling(rows, cols, weights);
  std::vector<Voxel> cells(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
  GrowingMatrix matrix(rows, cols);
  std::int64_t drawn = 0;
  int tried = 0;
  for (; tried < attempts && drawn < most_cells_drawn; ++tried) {
    matrix.clear();
    // The rest of a matrix that cannot become valid need not be drawn.
    bool possible = true;
    for (int r = 0; r < rows && possible; ++r) {
      for (int cell = r * cols; cell < (r + 1) * cols; ++cell)
        cells[static_cast<std::size_t>(cell)] = draw_voxel(weights, stream);
      drawn += cols;
      possible = matrix.add_row(cells, r);
    }
    if (possible && matrix.is_connected() && has_actuator(cells))
      return {rows, cols, std::move(cells)};
  }
  throw error(Failure::work,
              "no valid robot among {} random matrices of {}x{} cells; with {:.0f}% empty cells "
              "they are hardly ever connected: give empty (the first weight) less, or choose a "
              "smaller shape",
              tried, rows, cols,
              100.0 * weights[0] / std::accumulate(weights.begin(), weights.end(), 0.0));
}

std::optional<Body> mutate(const Body& parent, const MutationSettings& settings, Stream& stream) {
  if (!(settings.rate >= 0.0 && settings.rate <= 1.0))
    throw error(Failure::usage, "mutation rate {}: a rate lies between 0 and 1", settings.rate);
  check_weights(settings.weights);
  const std::array<double, 2> redraw_or_keep{settings.rate, 1.0 - settings.rate};
  std::vector<Voxel> cells = parent.cells;
  GrowingMatrix matrix(parent.rows, parent.cols);
  for (int attempt = 0; attempt < settings.attempts; ++attempt) {
    for (Voxel& cell : cells)
      if (stream.discrete(redraw_or_keep) == 0) cell = draw_voxel(settings.weights, stream);
    if (!is_valid(cells, parent.rows, matrix)) continue;
    std::vector<double> stiffness;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double factor = parent.stiffness_of(i);
      if (settings.stiffness_sigma > 0.0 && cells[i] != Voxel::empty)
        factor *= math::exp(settings.stiffness_sigma * stream.gaussian());
      stiffness.push_back(std::clamp(factor, softest, stiffest));
    }
    return with_stiffness({parent.rows, parent.cols, std::move(cells)}, std::move(stiffness));
  }
  return std::nullopt;
}

std::optional<Body> crossover(const Body& a, const Body& b, int attempts, Stream& stream) {
  if (a.rows != b.rows || a.cols != b.cols)
    throw error(Failure::data, "crossover of a {}x{} and a {}x{} body: the shapes must be equal",
                a.rows, a.cols, b.rows, b.cols);
  std::vector<Voxel> cells(a.cells.size());
  std::vector<double> stiffness(a.cells.size());
  GrowingMatrix matrix(a.rows, a.cols);
  for (int attempt = 0; attempt < attempts; ++attempt) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Body& from = stream.below(2) == 0 ? a : b;
      cells[i] = from.cells[i];
      stiffness[i] = from.stiffness_of(i);
    }
    if (is_valid(cells, a.rows, matrix))
      return with_stiffness({a.rows, a.cols, std::move(cells)}, std::move(stiffness));
  }
  return std::nullopt;
}

}  // namespace evo
