// The mutable part of one simulation as a value: to read, save, perturb and put
// back. What advances simulations is a Batch (batch.h).
#pragma once

#include <cstdint>
#include <vector>

#include "libevo/sim/model.h"

namespace evo {

// Of the points that can move, in world order (static objects have none here).
struct State {
  std::vector<Vec2> positions;   // raw length
  std::vector<Vec2> velocities;  // the integrator's
  std::vector<Vec2> previous;    // positions one substep ago
  std::vector<double> targets;   // per actuator of any robot, share of rest length

  bool operator==(const State&) const = default;
};

// Calls `visit` with each of its arrays: one list for all who save, load or compare a state.
template <typename AnyState, typename Visit>
void for_each_array(AnyState& state, const Visit& visit) {
  visit(state.positions);
  visit(state.velocities);
  visit(state.previous);
  visit(state.targets);
}

// At rest at the model's initial positions (docs/physics.md, "Reset").
State initial_state(const Model& model);

// Moves all points of an object that can move, as they are; velocities stay.
void translate(const Model& model, std::size_t object, Vec2 by, State& state);
// Moves every point by up to `amount`, raw length, in each coordinate; velocities stay.
void perturb(State& state, double amount, std::uint64_t seed);

}  // namespace evo
