// A variant as a list of types: what is done once for every alternative, such
// as finding one by its name, without a list that could be forgotten.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace evo {

// Calls function(std::type_identity<T>{}) for every alternative T, in order.
template <typename Variant, typename Function>
void for_each_alternative(Function function) {
  const auto call = [&]<std::size_t... k>(std::index_sequence<k...>) {
    (function(std::type_identity<std::variant_alternative_t<k, Variant>>{}), ...);
  };
  call(std::make_index_sequence<std::variant_size_v<Variant>>{});
}

// T::name of every alternative T, in order.
template <typename Variant>
std::vector<std::string> names_of() {
  std::vector<std::string> names;
  for_each_alternative<Variant>(
      [&]<typename T>(std::type_identity<T>) { names.emplace_back(T::name); });
  return names;
}

}  // namespace evo
