// Enumerations whose values have words, as files and options write them. Such an
// enumeration counts from 0 and has its words beside it, in the same order:
//
//   enum class Fruit { apple, pear };
//   constexpr auto words_for(Fruit) { return std::array{"apple", "pear"}; }
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace evo {

template <typename E>
concept Worded = std::is_enum_v<E> && requires(E value) {
  words_for(value);
};

template <Worded E>
constexpr const char* word(E value) {
  return words_for(value).at(static_cast<std::size_t>(value));
}

// All of them, in the order of the enumeration.
template <Worded E>
std::vector<std::string> words_of() {
  const auto words = words_for(E{});
  return {words.begin(), words.end()};
}

// Nothing for a word that no value has.
template <Worded E>
std::optional<E> from_word(std::string_view text) {
  const auto words = words_for(E{});
  for (std::size_t i = 0; i < words.size(); ++i)
    if (text == words[i]) return static_cast<E>(i);
  return std::nullopt;
}

}  // namespace evo
