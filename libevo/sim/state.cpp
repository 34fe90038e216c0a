#include "libevo/sim/state.h"

#include "libevo/base/random.h"
#include "libevo/sim/compiled.h"

namespace evo {

State initial_state(const Model& model) {
  const Model::Compiled& world = model.compiled();
  const auto n = static_cast<std::size_t>(world.moving_points);
  State state;
  state.x.resize(n);
  state.y.resize(n);
  for (std::size_t i = 0; i < world.point_indices.size(); ++i) {
    const auto r = static_cast<std::size_t>(world.point_indices[i]);
    if (r >= n) continue;
    state.x[r] = world.initial_positions[i].x;
    state.y[r] = world.initial_positions[i].y;
  }
  state.previous_x = state.x;
  state.previous_y = state.y;
  state.vx.assign(n, 0.0);
  state.vy.assign(n, 0.0);
  state.targets.assign(static_cast<std::size_t>(world.dynamics.actuators), 1.0);
  return state;
}

void perturb(State& state, double amount, std::uint64_t seed) {
  Stream stream(seed, "perturb");
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const double dx = amount * (2.0 * stream.uniform() - 1.0);
    const double dy = amount * (2.0 * stream.uniform() - 1.0);
    state.x[i] += dx;
    state.y[i] += dy;
    state.previous_x[i] += dx;
    state.previous_y[i] += dy;
  }
}

void translate(const Model& model, std::size_t object, Vec2 by, State& state) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < object; ++k)
    if (!model.objects()[k].is_static) first += static_cast<std::size_t>(model.objects()[k].points);
  const std::size_t end = first + static_cast<std::size_t>(model.objects()[object].points);
  for (std::size_t i = first; i < end; ++i) {
    state.x[i] += by.x;
    state.y[i] += by.y;
    state.previous_x[i] += by.x;
    state.previous_y[i] += by.y;
  }
}

}  // namespace evo
