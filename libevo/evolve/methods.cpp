#include "libevo/evolve/methods.h"

#include <fmt/ranges.h>

#include <optional>

#include "libevo/base/error.h"

namespace evo {
namespace {

template <typename Visit, EvolutionMethod... Method>
void for_each(const std::variant<Method...>* /*list*/, Visit&& visit) {
  (visit.template operator()<Method>(), ...);
}

template <typename Visit>
void for_each_method(Visit&& visit) {
  for_each(static_cast<const AnyEvolution*>(nullptr), visit);
}

}  // namespace

std::vector<std::string> evolution_names() {
  std::vector<std::string> names;
  for_each_method([&]<typename Method>() { names.emplace_back(Method::name); });
  return names;
}

AnyEvolution make_evolution(std::string_view name, const EvolutionSettings& settings) {
  std::optional<AnyEvolution> made;
  for_each_method([&]<typename Method>() {
    if (name == Method::name) made = Method(settings);
  });
  if (!made)
    throw error(Failure::usage, "method '{}' is none of {}{}", name,
                fmt::join(evolution_names(), ", "),
                did_you_mean(std::string(name), evolution_names()));
  return *std::move(made);
}

}  // namespace evo
