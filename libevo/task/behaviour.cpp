#include "libevo/task/behaviour.h"

#include <algorithm>
#include <vector>

#include "libevo/task/contacts.h"
#include "libevo/task/measure.h"

namespace evo {

void BehaviourMeter::add(const Model& model, std::span<const Vec2> positions) {
  std::vector<Vec2> points(positions.begin(), positions.end());
  for (Vec2& p : points) p = p / model.physics().voxel_length;
  const ModelObject& robot = model.objects().front();
  const std::span<const Vec2> own = PointRange{robot.first_point, robot.points}.of(points);
  now_ = mean(own);
  ++steps_;
  if (steps_ == 0) {
    start_ = now_;
    highest_ = now_.y;
    start_width_ = width(own);
    return;
  }
  highest_ = std::max(highest_, now_.y);
  if (contacts_of(model.objects(), model.cells(), points).points.empty()) ++aloft_;
  widths_ += width(own);
}

Behaviour BehaviourMeter::behaviour() const {
  if (steps_ < 1) return {};
  return {now_.x - start_.x, highest_ - start_.y, static_cast<double>(aloft_) / steps_,
          widths_ / steps_ / start_width_};
}

}  // namespace evo
