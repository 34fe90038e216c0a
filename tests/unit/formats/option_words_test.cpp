#include "formats/run/option_words.h"

#include <catch2/catch.hpp>

#include "libevo/base/error.h"

namespace evo {

TEST_CASE("option_words: quotes keep words together, nothing is expanded") {
  using Words = std::vector<std::string>;
  CHECK(option_words("", "x").empty());
  CHECK(option_words(" \t ", "x").empty());
  CHECK(option_words("--rate 0.2  --attempts 3", "x") == Words{"--rate", "0.2", "--attempts", "3"});
  CHECK(option_words("--train-set 'hidden=8, 8'", "x") == Words{"--train-set", "hidden=8, 8"});
  CHECK(option_words("a\"b c\"d '' \\'", "x") == Words{"ab cd", "", "'"});
  CHECK(option_words("$HOME * ~ $(touch here)", "x") ==
        Words{"$HOME", "*", "~", "$(touch", "here)"});
  CHECK(option_words("'\\n' \"\\\"\"", "x") == Words{"\\n", "\""});
  CHECK_THROWS_AS(option_words("--set 'hidden=8", "run.yaml: train_options"), Error);
}

}  // namespace evo
