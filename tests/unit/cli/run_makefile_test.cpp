#include "cli/run_makefile.h"

#include <catch2/catch.hpp>

#include "formats/run/settings.h"
#include "libevo/base/error.h"

using namespace evo;

namespace {

// The settings of a method as evo-evolve completes them.
RunSettings settings_of(const std::string& method, std::vector<RunSetting> given) {
  const auto setting = [&](const std::string& name) {
    for (const RunSetting& one : given)
      if (one.name == name) return one.value;
    return std::string();
  };
  for (const RunSettingInfo& info : run_settings())
    if (info.belongs_to(method) && setting(info.name).empty())
      if (const std::string value = initial_value(info, method, setting); !value.empty())
        given.push_back({info.name, value});
  return {method, given};
}

bool has(const std::string& text, const std::string& line) {
  return ("\n" + text).find("\n" + line + "\n") != std::string::npos;
}

}  // namespace

TEST_CASE("option_words: quotes keep words together, nothing is expanded") {
  using cli::option_words;
  using Words = std::vector<std::string>;
  CHECK(option_words("", "x").empty());
  CHECK(option_words(" \t ", "x").empty());
  CHECK(option_words("--rate 0.2  --attempts 3", "x") == Words{"--rate", "0.2", "--attempts", "3"});
  CHECK(option_words("--train 'hidden=8, 8'", "x") == Words{"--train", "hidden=8, 8"});
  CHECK(option_words("a\"b c\"d '' \\'", "x") == Words{"ab cd", "", "'"});
  CHECK(option_words("$HOME * ~ $(touch here)", "x") ==
        Words{"$HOME", "*", "~", "$(touch", "here)"});
  CHECK(option_words("'\\n' \"\\\"\"", "x") == Words{"\\n", "\""});
  CHECK_THROWS_AS(option_words("--train 'hidden=8", "--train-options"), Error);
}

TEST_CASE("make_word: a shell below make sees what was meant") {
  using cli::make_word;
  CHECK(make_word("Walker-v0") == "Walker-v0");
  CHECK(make_word("") == "''");
  CHECK(make_word("a b") == "'a b'");
  CHECK(make_word("it's") == "'it'\\''s'");
  CHECK(make_word("$(touch x)") == "'$$(touch x)'");
  CHECK(make_word("a#b\\") == "'a$(hash)b\\'");
}

TEST_CASE("generations: each population waits for the scores before it") {
  const std::string text =
      cli::run_makefile(settings_of("ga", {{"pop", "4"}, {"evals", "9"}, {"seed", "3"}}),
                        {"", "/here", "python3", {}});
  CHECK(has(text, "SLOTS = 00 01 02 03"));
  CHECK(has(text, "gen-000/population.jsonl: | same"));
  CHECK(has(text, "\tevo-sample -n 4 --shape 5x5 --seed 3000000 -o $@"));
  CHECK(has(text, "gen-001/population.jsonl: | gen-000/scores.jsonl seen.txt"));
  CHECK(has(text, "\t$(call breed,gen-000,2,2,3000001)"));
  CHECK(has(text, "$(SLOTS:%=gen-001/%.json): gen-001/%.json: | gen-001/population.jsonl"));
  CHECK(has(text, "gen-001/scores.jsonl: | $(SLOTS:%=gen-001/%.json)"));
  CHECK(has(text,
            "$(patsubst %,gen-003/%.json,$(wordlist 1,3,$(SLOTS))): gen-003/%.json: | "
            "gen-003/population.jsonl"));
  CHECK(has(text, "GENERATIONS = 000 001 002 003"));
}

TEST_CASE("a window: each robot waits for the scores that it knows, and for no others") {
  const std::string text =
      cli::run_makefile(settings_of("ga", {{"pop", "4"}, {"evals", "9"}, {"window", "2"}}),
                        {"", "/here", "python3", {}});
  // Robot 4 knows robots 0 and 1, robot 5 one more, robot 8 knows 0 to 5.
  CHECK(has(text,
            "gen-001/population.jsonl: | gen-000/population.jsonl seen.txt "
            "gen-000/00.json gen-000/01.json"));
  CHECK(has(text, "\t$(call breed,gen-000,gen-000/00.json gen-000/01.json,2,1,1)"));
  CHECK(has(text, "gen-002/population.jsonl: | gen-001/population.jsonl seen.txt gen-000/02.json"));
  CHECK(has(text, "\t$(call breed,gen-001,gen-001/parents.jsonl gen-000/02.json,2,1,2)"));
  CHECK(has(text, "gen-005/population.jsonl: | gen-004/population.jsonl seen.txt gen-002/00.json"));
}

// More in evolve.bats, as users see it.
TEST_CASE("what does not go together is refused") {
  const auto refused = [](const std::string& method, const std::vector<RunSetting>& given) {
    CHECK_THROWS_AS(cli::run_makefile(settings_of(method, given), {"", "/here", "python3", {}}),
                    Error);
  };
  refused("ga", {{"pop", "5"}, {"evals", "4"}});
  refused("neat", {{"pop", "1"}});
  refused("race", {{"task", "mine.py:Task"}});
}
