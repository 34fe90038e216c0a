// Operators on bodies: random bodies, mutation, crossover (docs/methods.md,
// "Robots" and "Mutation"). Each takes its randomness as a stream.
#pragma once

#include <array>
#include <optional>

#include "libevo/base/random.h"
#include "libevo/body/body.h"

namespace evo {

// Relative weights of empty, rigid, soft, horizontal, vertical.
using VoxelWeights = std::array<double, 5>;
inline constexpr VoxelWeights default_weights{0.6, 0.2, 0.2, 0.2, 0.2};

// A random valid robot: cells drawn row by row until the matrix is connected
// and has an actuator. Throws Error(usage) for a shape or weights that cannot
// give one, Error(work) after `attempts` failures, or when so many cells were
// drawn in vain that no robot is to be expected (large shapes with many empty
// cells are practically never connected).
Body sample_body(int rows, int cols, const VoxelWeights& weights, Stream& stream,
                 int attempts = 1'000'000);

struct MutationSettings {
  double rate = 0.1;  // probability that a voxel is redrawn
  int attempts = 50;  // each continues from the matrix of the one before
  VoxelWeights weights = default_weights;
  double stiffness_sigma = 0.0;  // of the change of every factor's logarithm
};

// A valid child, or nothing after `attempts` failures. It may equal the parent
// in its cells; its cells are fully linked, whatever links the parent had. Its voxels
// have the stiffness of the parent's cells, times exp(stiffness_sigma N(0, 1)), within
// its range. Throws Error(usage) for a rate outside [0, 1] or weights without a sum.
std::optional<Body> mutate(const Body& parent, const MutationSettings& settings, Stream& stream);

// Uniform crossover: every voxel, with its stiffness, from either parent with probability 1/2,
// until valid; nothing after `attempts` failures. The child is fully linked. Throws Error(data) for
// parents of different shapes.
std::optional<Body> crossover(const Body& a, const Body& b, int attempts, Stream& stream);

}  // namespace evo
