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

// In the order of the enumeration.
template <Worded E>
std::vector<std::string> words_of() {
  std::vector<std::string> words;
  for (int i = 0; const char* found = word(static_cast<E>(i)); ++i) words.emplace_back(found);
  return words;
}

// Nothing for a word that no value has.
template <Worded E>
std::optional<E> from_word(std::string_view text) {
  for (int i = 0; const char* found = word(static_cast<E>(i)); ++i)
    if (text == found) return static_cast<E>(i);
  return std::nullopt;
}

}  // namespace evo
