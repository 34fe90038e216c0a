#include "render/scene/moments.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evo::render {
namespace {

constexpr int shortest_period = 3;  // steps
constexpr int longest_period = 80;

// Mean squared difference of the robot's shape, each about its own centre, from
// that `lag` steps later; voxels squared.
double difference(const Clip& clip, int from, int to, int lag) {
  double sum = 0;
  std::size_t count = 0;
  const ModelObject& robot = clip.mesh().objects.front();
  for (int t = from; t + lag <= to; ++t) {
    const auto a = clip.points(t, robot);
    const auto b = clip.points(t + lag, robot);
    for (std::size_t k = 0; k < a.size(); ++k) {
      const Vec2 off = (b[k] - clip.centre(t + lag)) - (a[k] - clip.centre(t));
      sum += dot(off, off);
      ++count;
    }
  }
  return count == 0 ? std::numeric_limits<double>::infinity() : sum / static_cast<double>(count);
}

// ---- parts of an episode -----------------------------------------------------------------

// What a step looks like, as numbers whose squared differences count: every point of what
// moves, an object as much as a robot, and the return.
class Looks {
 public:
  Looks(const Clip& clip, int from, int to) : from_(from) {
    for (int t = from; t <= to; ++t) rows_.push_back(row(clip, t));
    length_ = rows_.front().size();
    add_return(clip, to);
    sums_.assign(length_, 0.0);
    squares_.push_back(0.0);
    for (const auto& look : rows_) {
      double square = squares_.back();
      for (std::size_t d = 0; d < length_; ++d) {
        sums_.push_back(sums_[sums_.size() - length_] + look[d]);
        square += look[d] * look[d];
      }
      squares_.push_back(square);
    }
  }

  int steps() const { return static_cast<int>(rows_.size()); }

  // Squared distances of the steps [first, end) from their mean, summed.
  double spread(int first, int end) const {
    const auto a = static_cast<std::size_t>(first);
    const auto b = static_cast<std::size_t>(end);
    double square = 0;
    for (std::size_t d = 0; d < length_; ++d) {
      const double sum = sums_[b * length_ + d] - sums_[a * length_ + d];
      square += sum * sum;
    }
    return squares_[b] - squares_[a] - square / (end - first);
  }

  // Of [first, end), the step that is nearest to their mean.
  int middle(int first, int end) const {
    int best = first;
    double least = std::numeric_limits<double>::infinity();
    for (int t = first; t < end; ++t) {
      double distance = 0;
      for (std::size_t d = 0; d < length_; ++d) {
        const double mean = (sums_[static_cast<std::size_t>(end) * length_ + d] -
                             sums_[static_cast<std::size_t>(first) * length_ + d]) /
                            (end - first);
        const double off = rows_[static_cast<std::size_t>(t)][d] - mean;
        distance += off * off;
      }
      if (distance >= least) continue;
      least = distance;
      best = t;
    }
    return best;
  }

 private:
  static std::vector<double> row(const Clip& clip, int t) {
    std::vector<double> look;
    for (const ModelObject& object : clip.mesh().objects) {
      if (object.is_static) continue;
      const double weight = 1 / std::sqrt(object.points);
      for (const Vec2& p : clip.points(t, object))
        look.insert(look.end(), {weight * p.x, weight * p.y});
    }
    return look;
  }

  // Its whole range counts as much as a way of four voxels.
  void add_return(const Clip& clip, int to) {
    constexpr double voxels = 4.0;
    double low = clip.score(from_);
    double high = low;
    for (int t = from_; t <= to; ++t) {
      low = std::min(low, clip.score(t));
      high = std::max(high, clip.score(t));
    }
    const double weight = high > low ? voxels / (high - low) : 0.0;
    for (int t = from_; t <= to; ++t)
      rows_[static_cast<std::size_t>(t - from_)].push_back(weight * clip.score(t));
    ++length_;
  }

  int from_;
  std::size_t length_ = 0;
  std::vector<std::vector<double>> rows_;  // [steps][length]
  std::vector<double> sums_;               // [steps + 1][length], of all rows before
  std::vector<double> squares_;            // [steps + 1]
};

// Ends of `count` parts of all steps with the least spread (dynamic programming).
std::vector<int> best_parts(const Looks& looks, int count) {
  const int n = looks.steps();
  const auto at = [n](int part, int end) {
    return static_cast<std::size_t>(part) * static_cast<std::size_t>(n + 1) +
           static_cast<std::size_t>(end);
  };
  constexpr double never = std::numeric_limits<double>::infinity();
  std::vector<double> least(at(count, n) + 1, never);  // of so many parts, up to there
  std::vector<int> begin(least.size(), 0);             // of the last of them
  least[at(0, 0)] = 0;
  for (int end = 1; end <= n; ++end)
    for (int first = 0; first < end; ++first) {
      const double spread = looks.spread(first, end);
      for (int part = 1; part <= std::min(count, first + 1); ++part) {
        const double sum = least[at(part - 1, first)] + spread;
        if (sum >= least[at(part, end)]) continue;
        least[at(part, end)] = sum;
        begin[at(part, end)] = first;
      }
    }
  std::vector<int> ends(static_cast<std::size_t>(count), n);
  for (int part = count; part > 1; --part)
    ends[static_cast<std::size_t>(part - 2)] =
        begin[at(part, ends[static_cast<std::size_t>(part - 1)])];
  return ends;
}

std::vector<int> events(const Clip& clip, int from, int to, int count) {
  const Looks looks(clip, from, to);
  const std::vector<int> ends = best_parts(looks, count);
  std::vector<int> steps{from};
  for (std::size_t k = 1; k + 1 < ends.size(); ++k)
    steps.push_back(from + looks.middle(ends[k - 1], ends[k]));
  steps.push_back(to);
  return steps;
}

std::vector<int> evenly(int from, int to, int count) {
  std::vector<int> steps;
  for (int k = 0; k < count; ++k) {
    const double share = count == 1 ? 1.0 : static_cast<double>(k) / (count - 1);
    steps.push_back(static_cast<int>(std::lround(from + share * (to - from))));
  }
  return steps;
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
  const bool by_event = choice == Choice::event && count > 2 && count <= to - from;
  std::vector<int> steps = by_event ? events(clip, from, to, count) : evenly(from, to, count);
  if (choice == Choice::time || count <= 2) return steps;
  const int period = gait_period(clip, from, to).value_or(0);
  if (period == 0) return steps;
  for (std::size_t k = 1; k + 1 < steps.size(); ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(steps.size() - 1);
    int shift = (static_cast<int>(std::lround(share * period)) - (steps[k] - from)) % period;
    if (shift > period / 2) shift -= period;
    if (shift < -(period / 2)) shift += period;
    steps[k] = std::max(steps[k - 1], std::clamp(steps[k] + shift, from, to));
  }
  return steps;
}

}  // namespace evo::render
