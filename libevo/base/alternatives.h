// A variant as a list of types: what is done once for every alternative, such
// as finding one by its name, without a list that could be forgotten.
#pragma once

#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace evo {

namespace detail {
template <typename Variant>
struct Alternatives;
template <typename... Types>
struct Alternatives<std::variant<Types...>> {
  template <typename Function>
  static void each(Function& function) {
    (function(std::type_identity<Types>{}), ...);
  }
};
}  // namespace detail

// Calls function(std::type_identity<T>{}) for every alternative T, in order.
template <typename Variant, typename Function>
void for_each_alternative(Function function) {
  detail::Alternatives<Variant>::each(function);
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
