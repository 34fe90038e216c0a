#include "render/scene/moments.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libevo/base/error.h"

namespace evo::render {
namespace {

constexpr int shortest_period = 3;  // steps
constexpr int longest_period = 80;

// Mean squared difference of the robot's shape, each about its own centre, from
// that `lag` steps later; voxels squared.
double difference(const Clip& clip, int from, int to, int lag) {
  double sum = 0;
  std::size_t count = 0;
  const auto points = static_cast<std::size_t>(clip.mesh().objects.front().points);
  for (int t = from; t + lag <= to; ++t) {
    const auto a = clip.points(t);
    const auto b = clip.points(t + lag);
    const Vec2 ca = clip.centre(t);
    const Vec2 cb = clip.centre(t + lag);
    for (std::size_t k = 0; k < points; ++k) {
      const double x = (b[k].x - cb.x) - (a[k].x - ca.x);
      const double y = (b[k].y - cb.y) - (a[k].y - ca.y);
      sum += x * x + y * y;
      ++count;
    }
  }
  return count == 0 ? std::numeric_limits<double>::infinity() : sum / static_cast<double>(count);
}

}  // namespace

std::optional<int> gait_period(const Clip& clip, int from, int to) {
  constexpr double alike = 0.35;  // of the mean difference of any two shapes
  constexpr double still = 1e-4;  // voxels squared; less is no gait
  const int most = std::min(longest_period, (to - from) / 2);
  std::vector<double> differences;
  for (int lag = 0; lag <= most; ++lag) differences.push_back(difference(clip, from, to, lag));
  double mean = 0;
  for (const double each : differences) mean += each / static_cast<double>(differences.size());
  if (most < shortest_period || mean < still) return std::nullopt;
  // The first dip: shapes a step apart are alike, too, but not before they differ.
  for (int lag = shortest_period; lag < most; ++lag) {
    const auto k = static_cast<std::size_t>(lag);
    if (differences[k] < alike * mean && differences[k] <= differences[k - 1] &&
        differences[k] <= differences[k + 1])
      return lag;
  }
  return std::nullopt;
}

std::vector<int> choose_moments(const Clip& clip, int from, int to, int count, Choice choice) {
  int period = 0;  // none
  if (choice == Choice::gait && count > 2) period = gait_period(clip, from, to).value_or(0);
  std::vector<int> steps;
  for (int k = 0; k < count; ++k) {
    const double share = count == 1 ? 1.0 : static_cast<double>(k) / (count - 1);
    int step = static_cast<int>(std::lround(from + share * (to - from)));
    if (period > 0 && k > 0 && k + 1 < count) {
      const int wanted = static_cast<int>(std::lround(share * period));
      int shift = (wanted - (step - from)) % period;
      if (shift > period / 2) shift -= period;
      if (shift < -(period / 2)) shift += period;
      step = std::clamp(step + shift, from, to);
    }
    steps.push_back(steps.empty() ? step : std::max(steps.back(), step));
  }
  return steps;
}

}  // namespace evo::render
