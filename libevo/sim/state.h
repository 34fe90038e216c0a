// The mutable part of a simulation and the function that advances it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libevo/sim/contact_lists.h"
#include "libevo/sim/model.h"

namespace evo {

// Plain arrays over the points that can move, in world order (static objects
// have none here). Copy, save or perturb them as you like; after changing
// positions by hand call restart_contacts().
struct State {
  std::vector<double> x, y;                    // positions, raw length
  std::vector<double> vx, vy;                  // the integrator's velocity
  std::vector<double> previous_x, previous_y;  // positions one substep ago
  std::vector<double> targets;                 // one a actuator, share of rest length
  // Contact candidates kept between substeps. Derived data: it changes how
  // fast the next step is, never its result, and need not be saved.
  ContactLists contacts;

  void restart_contacts() { contacts.invalidate(); }
};

// At rest at the model's initial positions (spec: physics, section 9).
State initial_state(const Model& model);

// Position and velocity of every point of the world, static ones included, in
// world order: `positions` and `velocities` hold model.points() entries.
void read_positions(const Model& model, const State& state, std::span<Vec2> positions);
void read_velocities(const Model& model, const State& state, std::span<Vec2> velocities);

enum class StepResult : std::uint8_t { done, self_folding };

// One environment of a batch: set state->targets, call step.
struct Lane {
  const Model* model = nullptr;
  State* state = nullptr;
  StepResult result = StepResult::done;
};

// Instruction sets of this processor that the stepping kernels were compiled for,
// slowest first: "x86-64", "x86-64-v2", "x86-64-v3", "x86-64-v4".
std::vector<std::string> available_isas();
std::string best_isa();
// Restricts the process to one of available_isas(); Error(usage) otherwise.
void select_isa(const std::string& isa);

// One control step (spec: physics, sections 1 and 3) of every lane. Lanes whose
// models share their moving objects run side by side in vector registers. The
// bits of each lane's result do not depend on its neighbours, on the width of
// the batch, or on the instruction set (in fast arithmetic only on whether it
// fuses multiply-adds). Targets are clipped to the physics' range. A lane that
// folds stops after the folding substep.
void step(std::span<Lane> lanes);

// Memory that stepping takes for an environment: its state, with the contact lists
// it has now, and its share of the arrays it is stepped in.
std::size_t bytes_per_lane(const Model& model, const State& state);

}  // namespace evo
