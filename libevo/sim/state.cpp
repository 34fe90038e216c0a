#include "libevo/sim/state.h"

#include "libevo/base/random.h"
#include "libevo/sim/compiled.h"

namespace evo {

State initial_state(const Model& model) {
  const Model::Compiled& world = model.compiled();
  const auto n = static_cast<std::size_t>(world.moving_points);
  State state;
  state.positions.resize(n);
  for (std::size_t i = 0; i < world.point_indices.size(); ++i) {
    const auto r = static_cast<std::size_t>(world.point_indices[i]);
    if (r < n) state.positions[r] = world.initial_positions[i];
  }
  state.previous = state.positions;
  state.velocities.resize(n);
  state.targets.assign(static_cast<std::size_t>(world.dynamics.actuators), 1.0);
  return state;
}

void perturb(State& state, double amount, std::uint64_t seed) {
  Stream stream(seed, "perturb");
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const double dx = amount * (2.0 * stream.uniform() - 1.0);
    const double dy = amount * (2.0 * stream.uniform() - 1.0);
    state.positions[i] += {dx, dy};
    state.previous[i] += {dx, dy};
  }
}

void translate(const Model& model, std::size_t object, Vec2 by, State& state) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < object; ++k)
    if (!model.objects()[k].is_static) first += static_cast<std::size_t>(model.objects()[k].points);
  const std::size_t end = first + static_cast<std::size_t>(model.objects()[object].points);
  for (std::size_t i = first; i < end; ++i) {
    state.positions[i] += by;
    state.previous[i] += by;
  }
}

}  // namespace evo
