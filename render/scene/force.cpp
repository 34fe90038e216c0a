#include "render/scene/force.h"

#include <algorithm>

namespace evo::render {

Vec2 outside_force(std::span<const Vec2> centres, int step, const Physics& physics) {
  constexpr int around = 2;  // steps before and after; single ones tremble
  const int last = static_cast<int>(centres.size()) - 1;
  const int from = std::max(1, step - around);
  const int to = std::min(last - 1, step + around);
  if (to < from || physics.gravity <= 0) return {};
  const auto at = [&](int t) { return centres[static_cast<std::size_t>(t)]; };
  const double seconds = physics.substep * physics.substeps;  // raw time of a step
  const double count = to - from + 1;
  // The means of the accelerations and of the velocities from `from` to `to`.
  const auto mean = [&](auto of) {
    const double first = of(at(from)) - of(at(from - 1));
    const double end = of(at(to + 1)) - of(at(to));
    const double acceleration = (end - first) / count / (seconds * seconds);
    const double velocity = (of(at(to + 1)) - of(at(from - 1))) / (count + 1) / seconds;
    return physics.voxel_length * (acceleration + physics.drag * velocity) / physics.gravity;
  };
  return {mean([](Vec2 p) { return p.x; }), 1 + mean([](Vec2 p) { return p.y; })};
}

}  // namespace evo::render
