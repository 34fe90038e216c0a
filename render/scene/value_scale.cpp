#include "render/scene/value_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/scene/theme.h"

namespace evo::render {

Color color_of(const ValueScale& scale, double value) {
  using Ramp = std::array<Color, 4>;  // from the middle outwards
  static constexpr Ramp below{
      {{247, 247, 244, 255}, {158, 202, 225, 255}, {66, 133, 190, 255}, {12, 53, 112, 255}}};
  static constexpr Ramp above{
      {{247, 247, 244, 255}, {250, 187, 145, 255}, {222, 87, 63, 255}, {120, 8, 28, 255}}};
  const bool low = value < scale.middle;
  const double span = low ? scale.middle - scale.low : scale.high - scale.middle;
  const double share = span > 0 ? std::min(1.0, std::abs(value - scale.middle) / span) : 0.0;
  const Ramp& ramp = low ? below : above;
  const double at = share * static_cast<double>(ramp.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(at), ramp.size() - 2);
  return mix(ramp[k], ramp[k + 1], at - static_cast<double>(k));
}

ValueScale widest(const ValueScale& a, const ValueScale& b) {
  return {a.title, std::min(a.low, b.low), a.middle, std::max(a.high, b.high), a.powers};
}

}  // namespace evo::render
