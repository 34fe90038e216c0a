// The mutable part of one simulation as a value: to read, save, perturb and put
// back. What advances simulations is a Batch (batch.h).
#pragma once

#include <cstdint>
#include <vector>

#include "libevo/sim/model.h"

namespace evo {

// Plain arrays over the points that can move, in world order (static objects
// have none here): [M] each, M of them.
struct State {
  std::vector<double> x, y;                    // positions, raw length
  std::vector<double> vx, vy;                  // the integrator's velocity
  std::vector<double> previous_x, previous_y;  // positions one substep ago
  std::vector<double> targets;                 // per actuator of any robot, share of rest length

  bool operator==(const State&) const = default;
};

// Calls `visit` with each of its arrays: one list for all who save, load or compare a state.
template <typename AnyState, typename Visit>
void for_each_array(AnyState& state, const Visit& visit) {
  visit(state.x);
  visit(state.y);
  visit(state.vx);
  visit(state.vy);
  visit(state.previous_x);
  visit(state.previous_y);
  visit(state.targets);
}

// At rest at the model's initial positions (docs/physics.md, "Reset").
State initial_state(const Model& model);

// Moves all points of an object that can move, as they are; velocities stay.
void translate(const Model& model, std::size_t object, Vec2 by, State& state);
// Moves every point by up to `amount`, raw length, in each coordinate; velocities stay.
void perturb(State& state, double amount, std::uint64_t seed);

}  // namespace evo
