#include "libevo/control/settings.h"

#include <cmath>
#include <type_traits>
#include <vector>

#include "libevo/base/error.h"
#include "libevo/control/methods.h"

namespace evo {
namespace {

void require(bool holds, const char* key, double value, const char* allowed) {
  if (!holds) throw error(Failure::usage, "training: {} is {}; {}", key, value, allowed);
}

void at_least(const char* key, double value, double minimum) {
  if (!(value >= minimum))
    throw error(Failure::usage, "training: {} is {}; it must be at least {}", key, value, minimum);
}

template <typename Number>
requires(std::is_arithmetic_v<Number> &&
         !std::is_same_v<Number, bool>) void check_range(const char* key, Number number,
                                                         const NumberRange& range) {
  const auto value = static_cast<double>(number);
  if (range.open)
    require(value > range.least, key, value, "it must be positive");
  else if (std::isfinite(range.most))
    require(value >= range.least && value <= range.most, key, value, "it must lie in [0, 1]");
  else if (std::isfinite(range.least))
    at_least(key, value, range.least);
}
void check_range(const char* key, const std::vector<int>& values, const NumberRange& range) {
  for (const int value : values) check_range(key, value, range);
}
// What is no number.
template <typename Value>
requires(!std::is_arithmetic_v<Value> ||
         std::is_same_v<Value, bool>) void check_range(const char* /*key*/, const Value& /*value*/,
                                                       const NumberRange& /*range*/) {}

}  // namespace

void check(const TrainingSettings& s) {
  using namespace number_range;
#define SETTING(type, name, initial, baseline, range, paper, meaning) \
  check_range(#name, s.name, range);
#include "libevo/control/training_settings.def"
#undef SETTING
  // Together.
  require(s.minibatches <= s.batch(), "minibatches", s.minibatches,
          "a rollout has fewer samples (environments x rollout)");
  at_least("longest_period", s.longest_period, s.shortest_period);
  require(s.noise_correlation < 1.0, "noise_correlation", s.noise_correlation,
          "it must be below 1");
  if (s.attempts.empty())
    throw Error(Failure::usage, "training: attempts is []; name one kind at least");
  check_method(s);
}

}  // namespace evo
