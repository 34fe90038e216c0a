// Contact between objects and of an object with itself, and self-folding, for
// one environment at the positions at the start of a substep (docs/physics.md,
// "Contact" and "Self-folding").
//
// Two steps. Finding (contact_search.h): which corners may come to touch which cells. Pushing: of
// those candidates, looked at side by side (contact_look-inl.h), the ones inside a cell, with their
// forces (contact_push.h), which are scalar code: contacts are few and never alike in two lanes.
#pragma once

#include <cstddef>

#include "libevo/sim/compiled.h"
#include "libevo/sim/contact_lists.h"

namespace evo {

// Lists hold what is nearer than the skin; they are good while no point moved
// by more than the limit, which is a little smaller than the skins allow. For voxels
// of 0.1; Model::Compiled::length_scale times as long for others.
inline constexpr double terrain_skin = 0.02;       // raw length: cell against static cell
inline constexpr double moving_skin = 0.04;        // cells of two moving objects
inline constexpr double self_skin = 0.05;          // cells of one object
inline constexpr double pair_move_limit = 0.0199;  // of any point, for pairs of objects
inline constexpr double self_move_limit = 0.0498;  // of two points of one object, relative

// One environment's points in the kernels' arrays: site s has its x at
// [2*s*stride] and its y at [2*s*stride + stride]. Block b has travelled [b*stride] in this control
// step: the sum over substeps of the longest way of any of its points. After the blocks comes the
// travel of what never moves, 0, then the sum of the fastest block's.
struct PointView {
  const double* position = nullptr;
  const double* previous = nullptr;  // one substep ago
  double* force = nullptr;           // contact forces are added here
  const double* travel = nullptr;    // of each block of the plan, as above
  std::size_t stride = 1;
};

// Sizes the lists for the model; they start empty and invalid.
void prepare_lists(const Model::Compiled& world, ContactLists& lists);

}  // namespace evo
