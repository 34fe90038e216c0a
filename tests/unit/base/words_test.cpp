#include "libevo/base/words.h"

#include <catch2/catch.hpp>

using namespace evo;

namespace {

enum class Fruit : unsigned char { apple, pear, quince };

constexpr const char* word(Fruit fruit) {
  switch (fruit) {
    case Fruit::apple:
      return "apple";
    case Fruit::pear:
      return "pear";
    case Fruit::quince:
      return "quince";
  }
  return nullptr;
}

}  // namespace

TEST_CASE("words and values lead to each other") {
  CHECK(values_of<Fruit>() == std::vector<Fruit>{Fruit::apple, Fruit::pear, Fruit::quince});
  CHECK(words_of<Fruit>() == std::vector<std::string>{"apple", "pear", "quince"});
  CHECK(from_word<Fruit>("pear") == Fruit::pear);
  CHECK_FALSE(from_word<Fruit>("plum"));
  CHECK_FALSE(from_word<Fruit>(""));
}
