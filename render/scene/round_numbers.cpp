#include "render/scene/round_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace evo::render {

double round_number_from(double value) {
  const double least = value * (1 - 1e-9);  // 0.5 computed as 0.5000..1 is 0.5
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double digit : std::array{1.0, 2.0, 5.0})
    if (digit * power >= least) return digit * power;
  return 10 * power;
}

std::string axis_number(double value, double tick) {
  const int digits = std::max(0, static_cast<int>(-std::floor(std::log10(tick) + 1e-9)));
  return (value < -tick / 2 ? "\u2212" : "") + fmt::format("{:.{}f}", std::abs(value), digits);
}

}  // namespace evo::render
