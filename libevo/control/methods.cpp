#include "libevo/control/methods.h"

#include <optional>
#include <utility>

#include "libevo/base/alternatives.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

// Calls function(std::type_identity<T>{}) for the method of this algorithm.
template <typename Function>
void with_method(Algorithm algorithm, Function function) {
  for_each_alternative<Method>([&]<typename T>(std::type_identity<T> type) {
    static_assert(TrainingMethod<T>);
    if (algorithm == T::algorithm) function(type);
  });
}

}  // namespace

Abilities abilities(Algorithm algorithm) {
  Abilities abilities;
  with_method(algorithm, [&]<typename T>(std::type_identity<T>) { abilities = T::can; });
  return abilities;
}

std::string algorithm_that(bool Abilities::*can) {
  std::string name;
  for_each_alternative<Method>([&]<typename T>(std::type_identity<T>) {
    if (name.empty() && T::can.*can) name = word(T::algorithm);
  });
  return name;
}

void check(const TrainingSettings& s) {
  if (s.minibatches > s.batch())
    throw error(Failure::usage,
                "training: minibatches is {}; a rollout has fewer samples (environments x rollout)",
                s.minibatches);
  if (s.longest_period < s.shortest_period)
    throw error(Failure::usage, "training: longest_period is {}; it must be at least {}",
                s.longest_period, s.shortest_period);
  with_method(s.algorithm, [&]<typename T>(std::type_identity<T>) { T::check(s); });
}

Method make_method(const TrainingJob& job) {
  std::optional<Method> method;
  with_method(job.settings.algorithm,
              [&]<typename T>(std::type_identity<T>) { method.emplace(T(job)); });
  return std::move(method).value();
}

}  // namespace evo
