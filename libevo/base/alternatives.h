// A variant as a list of types: what is done once for every alternative, such
// as finding one by its name, without a list that could be forgotten.
#pragma once

#include <type_traits>
#include <variant>

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

}  // namespace evo
