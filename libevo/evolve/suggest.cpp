#include "libevo/evolve/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"
#include "libevo/body/operators.h"

namespace evo {
namespace {

constexpr VoxelWeights uniform_weights{1.0, 1.0, 1.0, 1.0, 1.0};
constexpr double smallest_stddev = 1e-10;
// Draws in a row that bring no new design before the shape counts as exhausted.
constexpr int max_vain_draws = 10'000;

struct Shape {
  int rows;
  int cols;
};

Body body_of(const Shape& shape, const Design& design) { return {shape.rows, shape.cols, design}; }

// Up to `count` random valid designs that are not in `known`, which they join.
std::vector<Design> random_designs(const Shape& shape, std::size_t count, std::set<Design>& known,
                                   Stream& stream) {
  std::vector<Design> designs;
  int vain = 0;
  while (designs.size() < count && vain < max_vain_draws) {
    Design design = sample_body(shape.rows, shape.cols, uniform_weights, stream).cells;
    if (known.insert(design).second) {
      designs.push_back(std::move(design));
      vain = 0;
    } else {
      ++vain;
    }
  }
  return designs;
}

// ---- the model ----------------------------------------------------------------------

// Costs are -fitness, standardised to mean 0 and standard deviation 1.
struct Scale {
  double mean = 0.0;
  double stddev = 1.0;
};

// -fitness, with failures as the greatest cost there was.
Eigen::VectorXd costs_of(std::span<const Observation> observations) {
  double greatest = -std::numeric_limits<double>::infinity();
  for (const Observation& o : observations)
    if (std::isfinite(o.fitness)) greatest = std::max(greatest, -o.fitness);
  Eigen::VectorXd costs(static_cast<Eigen::Index>(observations.size()));
  for (std::size_t i = 0; i < observations.size(); ++i)
    costs(static_cast<Eigen::Index>(i)) =
        std::isfinite(observations[i].fitness) ? -observations[i].fitness : greatest;
  return costs;
}

Scale scale_of(const Eigen::VectorXd& costs) {
  Scale scale;
  const auto n = static_cast<double>(costs.size());
  double sum = 0.0;
  for (const double cost : costs) sum += cost;
  scale.mean = sum / n;
  double squares = 0.0;
  for (const double cost : costs) squares += (cost - scale.mean) * (cost - scale.mean);
  const double stddev = math::sqrt(squares / n);
  if (stddev > 0.0) scale.stddev = stddev;
  return scale;
}

GpData standardised(std::span<const Observation> observations, const Scale& scale) {
  std::vector<Design> designs;
  for (const Observation& o : observations) designs.push_back(o.cells);
  return {std::move(designs),
          ((costs_of(observations).array() - scale.mean) / scale.stddev).matrix()};
}

// The process as if each of these designs had been observed at its mean.
GaussianProcess believing(GaussianProcess process, std::span<const Design> pending) {
  if (pending.empty()) return process;
  const GpData& data = process.data();
  std::vector<Design> designs = data.designs();
  designs.insert(designs.end(), pending.begin(), pending.end());
  Eigen::VectorXd outputs(static_cast<Eigen::Index>(designs.size()));
  outputs << data.outputs(), process.predict(pending).mean;
  return {GpData(std::move(designs), std::move(outputs)), process.parameters()};
}

// Mean and standard deviation of what would be observed.
struct Prediction {
  Eigen::VectorXd mean;
  Eigen::VectorXd stddev;
};

Prediction observe(const GaussianProcess& process, std::span<const Design> designs) {
  auto [mean, variance] = process.predict(designs);
  return {std::move(mean),
          (variance.array() + process.parameters().noise).sqrt().max(smallest_stddev).matrix()};
}

// ---- the search ---------------------------------------------------------------------

class Acquisition {
 public:
  Acquisition(const GaussianProcess& process, double jitter)
      : process_(process),
        jitter_(jitter),
        best_(process.predict(process.data().designs()).mean.minCoeff()) {}

  std::vector<double> operator()(std::span<const Design> designs) const {
    const Prediction prediction = observe(process_, designs);
    std::vector<double> values;
    for (Eigen::Index i = 0; i < prediction.mean.size(); ++i)
      values.push_back(
          expected_improvement(prediction.mean(i), prediction.stddev(i), best_, jitter_));
    return values;
  }

 private:
  const GaussianProcess& process_;
  double jitter_;
  double best_;  // smallest posterior mean at an evaluated design
};

// Valid designs one voxel away that are not known.
std::vector<Design> neighbours(const Shape& shape, const Design& design,
                               const std::set<Design>& known) {
  constexpr std::array kinds{Voxel::empty, Voxel::rigid, Voxel::soft, Voxel::horizontal,
                             Voxel::vertical};
  std::vector<Design> found;
  Design changed = design;
  for (Voxel& voxel : changed) {
    const Voxel old = voxel;
    for (const Voxel kind : kinds) {
      if (kind == old) continue;
      voxel = kind;
      if (is_valid_robot(body_of(shape, changed)) && !known.contains(changed))
        found.push_back(changed);
    }
    voxel = old;
  }
  return found;
}

// Steepest ascent of the acquisition from an anchor.
Design improve(const Shape& shape, Design design, const Acquisition& acquisition,
               const std::set<Design>& known, int steps) {
  double value = acquisition(std::span(&design, 1)).front();
  for (int step = 0; step < steps; ++step) {
    std::vector<Design> around = neighbours(shape, design, known);
    const std::vector<double> values = acquisition(around);
    const auto best = std::max_element(values.begin(), values.end());
    if (best == values.end() || !(*best > value)) break;
    value = *best;
    design = std::move(around[static_cast<std::size_t>(best - values.begin())]);
  }
  return design;
}

// One independent normal draw for each candidate, ascending costs.
std::vector<Design> by_thompson_sampling(const GaussianProcess& process,
                                         std::vector<Design> candidates, Stream& stream,
                                         ThreadPool& pool) {
  constexpr std::size_t piece = 256;  // candidates, whatever the number of threads
  std::vector<Prediction> predictions((candidates.size() + piece - 1) / piece);
  pool.run(predictions.size(), [&](std::size_t k, int /*worker*/) {
    const std::size_t first = k * piece;
    predictions[k] = observe(
        process, std::span(candidates).subspan(first, std::min(piece, candidates.size() - first)));
  });
  std::vector<std::pair<double, std::size_t>> draws;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Prediction& prediction = predictions[i / piece];
    const auto at = static_cast<Eigen::Index>(i % piece);
    draws.emplace_back(prediction.mean(at) + prediction.stddev(at) * stream.gaussian(), i);
  }
  std::sort(draws.begin(), draws.end());
  std::vector<Design> sorted;
  sorted.reserve(draws.size());
  for (const auto& [draw, i] : draws) sorted.push_back(std::move(candidates[i]));
  return sorted;
}

// The improved anchors, in their order; an anchor itself where its improvement is
// in the batch already. Should that not be enough, the best of the other draws.
std::vector<Design> pick(const Shape& shape, const std::vector<Design>& draws,
                         const Acquisition& acquisition, const std::set<Design>& known,
                         std::size_t count, const SuggestSettings& settings, ThreadPool& pool) {
  const std::size_t anchors =
      std::min(draws.size(), count * static_cast<std::size_t>(settings.anchors_per_design));
  std::vector<Design> batch;
  std::set<Design> chosen;
  const auto take = [&](const Design& design) {
    if (!chosen.insert(design).second) return false;
    batch.push_back(design);
    return true;
  };
  // A few anchors more may be improved than are taken: as many as there are threads.
  const auto together = static_cast<std::size_t>(pool.threads());
  std::vector<Design> improved(together);
  for (std::size_t first = 0; first < anchors && batch.size() < count; first += together) {
    const std::size_t n = std::min(together, anchors - first);
    pool.run(n, [&](std::size_t k, int /*worker*/) {
      improved[k] = improve(shape, draws[first + k], acquisition, known, settings.local_steps);
    });
    for (std::size_t k = 0; k < n && batch.size() < count; ++k)
      if (!take(improved[k])) take(draws[first + k]);
  }
  for (std::size_t i = 0; i < draws.size() && batch.size() < count; ++i) take(draws[i]);
  return batch;
}

void check(const Shape& shape, std::span<const Observation> observations,
           std::span<const Design> pending, int count) {
  if (shape.rows < 1 || shape.cols < 1)
    throw error(Failure::usage, "shape {}x{}: at least 1x1 needed", shape.rows, shape.cols);
  if (count < 1) throw error(Failure::usage, "{} designs asked for: at least 1 needed", count);
  const auto cells = static_cast<std::size_t>(shape.rows) * static_cast<std::size_t>(shape.cols);
  for (std::size_t i = 0; i < observations.size(); ++i)
    if (observations[i].cells.size() != cells)
      throw error(Failure::data, "observation {} has {} voxels, not the {} of {}x{}", i + 1,
                  observations[i].cells.size(), cells, shape.rows, shape.cols);
  for (const Design& design : pending)
    if (design.size() != cells)
      throw error(Failure::data, "a pending design has {} voxels, not the {} of {}x{}",
                  design.size(), cells, shape.rows, shape.cols);
}

void check_complete(const Shape& shape, std::size_t found, int count) {
  if (found < static_cast<std::size_t>(count))
    throw error(Failure::work,
                "only {} of {} designs found: the shape {}x{} has hardly any left that are new",
                found, count, shape.rows, shape.cols);
}

}  // namespace

// ---- normal distribution ------------------------------------------------------------

double normal_density(double x) {
  constexpr double one_over_sqrt_two_pi = 0.3989422804014327;
  return one_over_sqrt_two_pi * math::exp(-0.5 * x * x);
}

// Hart's rational approximation in double precision, with a continued fraction in
// the tails (West, "Better approximations to cumulative normal functions", Wilmott
// Magazine, May 2005). The C library's erfc differs between processors.
double normal_distribution(double x) {
  constexpr std::array numerator{3.52624965998911e-02, 0.700383064443688, 6.37396220353165,
                                 33.912866078383,      112.079291497871,  221.213596169931,
                                 220.206867912376};
  constexpr std::array denominator{8.83883476483184e-02, 1.75566716318264, 16.064177579207,
                                   86.7807322029461,     296.564248779674, 637.333633378831,
                                   793.826512519948,     440.413735824752};
  constexpr double tail_begins = 7.07106781186547;
  constexpr double tail_ends = 37.0;  // below the smallest double
  const double a = std::fabs(x);
  const auto polynomial = [a](const auto& coefficients) {
    double value = 0.0;
    for (const double c : coefficients) value = value * a + c;
    return value;
  };
  double upper = 0.0;  // the probability beyond a
  if (a < tail_begins) {
    upper = math::exp(-0.5 * a * a) * polynomial(numerator) / polynomial(denominator);
  } else if (a < tail_ends) {
    double fraction = a + 0.65;
    for (const double k : {4.0, 3.0, 2.0, 1.0}) fraction = a + k / fraction;
    upper = normal_density(a) / fraction;
  }
  return x > 0.0 ? 1.0 - upper : upper;
}

double expected_improvement(double mean, double stddev, double best, double jitter) {
  const double u = (best - mean - jitter) / stddev;
  return std::max(0.0, stddev * (u * normal_distribution(u) + normal_density(u)));
}

// ---- suggest ------------------------------------------------------------------------

SuggestedBatch suggest(int rows, int cols, std::span<const Observation> observations,
                       std::span<const Design> pending, int count, const SuggestSettings& settings,
                       std::uint64_t seed, ThreadPool* pool) {
  const Shape shape{rows, cols};
  check(shape, observations, pending, count);
  const auto wanted = static_cast<std::size_t>(count);
  std::set<Design> known(pending.begin(), pending.end());
  for (const Observation& o : observations) known.insert(o.cells);
  // Streams are numbered by what was there, so that one seed serves all batches.
  const std::uint64_t index = observations.size() + pending.size();
  Stream candidates(seed, "suggest/candidates", index);

  SuggestedBatch batch;
  batch.from_model = std::any_of(observations.begin(), observations.end(),
                                 [](const Observation& o) { return std::isfinite(o.fitness); });
  if (!batch.from_model) {
    for (const Design& design : random_designs(shape, wanted, known, candidates))
      batch.designs.push_back({body_of(shape, design)});
    check_complete(shape, batch.designs.size(), count);
    return batch;
  }

  const Scale scale = scale_of(costs_of(observations));
  const GpData data = standardised(observations, scale);
  Stream restarts(seed, "suggest/restarts", observations.size());
  batch.parameters = fit(data, settings.fit, restarts);
  const GaussianProcess process = believing(GaussianProcess(data, batch.parameters), pending);

  ThreadPool alone(1);
  ThreadPool& threads = pool != nullptr ? *pool : alone;
  std::set<Design> drawn = known;
  const auto tried = std::max(wanted, static_cast<std::size_t>(settings.candidates));
  Stream thompson(seed, "suggest/thompson", index);
  const std::vector<Design> draws = by_thompson_sampling(
      process, random_designs(shape, tried, drawn, candidates), thompson, threads);
  const Acquisition acquisition(process, settings.ei_jitter);
  const std::vector<Design> chosen =
      pick(shape, draws, acquisition, known, wanted, settings, threads);
  check_complete(shape, chosen.size(), count);

  const Prediction prediction = observe(process, chosen);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    batch.designs.push_back({body_of(shape, chosen[i]),
                             -(scale.mean + scale.stddev * prediction.mean(at)),
                             scale.stddev * prediction.stddev(at)});
  }
  return batch;
}

}  // namespace evo
