// Enumerations whose values have words, as files and options write them. Such an
// enumeration counts from 0 and has beside it
//
//   constexpr const char* word(Fruit fruit) {
//     switch (fruit) {
//       case Fruit::apple: return "apple";
//       case Fruit::pear: return "pear";
//     }
//     return nullptr;
//   }
//
// whose switch has no default, so that the compiler points at a value without a
// word. Lists and look-ups follow from it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace evo {

template <typename E>
concept Worded = std::is_enum_v<E> && requires(E value) {
  word(value);
};

// All of them, in the order of the enumeration.
template <Worded E>
std::vector<E> values_of() {
  std::vector<E> values;
  for (int i = 0; word(static_cast<E>(i)) != nullptr; ++i) values.push_back(static_cast<E>(i));
  return values;
}

template <Worded E>
std::vector<std::string> words_of() {
  std::vector<std::string> words;
  for (const E value : values_of<E>()) words.emplace_back(word(value));
  return words;
}

// Nothing for a word that no value has.
template <Worded E>
std::optional<E> from_word(std::string_view text) {
  for (const E value : values_of<E>())
    if (text == word(value)) return value;
  return std::nullopt;
}

}  // namespace evo
