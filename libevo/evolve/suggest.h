// Bayesian optimisation of bodies: the next batch of designs from all that were
// scored so far (docs/methods.md, "Bayesian optimisation").
//
// As the benchmark: standardised costs, Gaussian process with Matern 5/2,
// expected improvement, a batch by Thompson sampling. Instead of its relaxed
// L-BFGS, which leaves the designs that exist and hardly moves, each anchor is
// improved by changing one voxel at a time among valid designs not yet
// evaluated; so no invalid robot is ever proposed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libevo/base/parallel.h"
#include "libevo/body/body.h"
#include "libevo/evolve/gp.h"

namespace evo {

struct Observation {
  std::vector<Voxel> cells;  // rows*cols
  double fitness = 0.0;      // not finite: failed, counted as the worst of the others
};

struct SuggestSettings {
  int candidates = 25'000;     // random valid designs for Thompson sampling
  int anchors_per_design = 5;  // so many times the batch become anchors
  double ei_jitter = 0.01;     // least improvement counted, in standard deviations of the costs
  int local_steps = 1000;      // voxels changed from an anchor, at most
  GpFitSettings fit;
};

struct Suggestion {
  Body body;            // valid, all adjacent voxels linked
  double mean = 0.0;    // predicted fitness
  double stddev = 0.0;  // of a fitness observed there, noise included
};

struct SuggestedBatch {
  std::vector<Suggestion> designs;
  bool from_model = false;  // else random: no observation has succeeded yet
  GpParameters parameters;  // of the standardised costs, as fitted
};

// `count` valid designs, different from each other, from every observation and
// from every pending one. Designs that are pending (proposed before, not scored yet)
// count as observed at the value expected there, so that what is near them is worth
// less (the Kriging believer of Ginsbourger, Le Riche and Carraro, "Kriging is
// well-suited to parallelize optimization", 2010). Without a finite fitness to learn from they are
// random, every voxel uniform over the five kinds until valid. Throws Error(data) for observations
// of another shape, Error(work) when the shape has not so many designs left. With a
// pool its threads share the work; the batch does not depend on it.
SuggestedBatch suggest(int rows, int cols, std::span<const Observation> observations,
                       std::span<const Design> pending, int count, const SuggestSettings& settings,
                       std::uint64_t seed, ThreadPool* pool = nullptr);

// ---- parts ------------------------------------------------------------------------

double normal_density(double x);
double normal_distribution(double x);  // within 1e-14 of the true value

// Expected improvement of a cost distributed as N(mean, stddev^2) over `best`,
// counted from `jitter` below it. Not negative.
double expected_improvement(double mean, double stddev, double best, double jitter);

}  // namespace evo
