#include "formats/run/steady.h"

#include <catch2/catch.hpp>

#include "libevo/evolve/cppn_neat.h"

using namespace evo;

namespace {

SteadyState some_state() {
  EvolutionSettings settings;
  settings.pop = settings.neat.pop_size = 5;
  settings.rows = settings.cols = 4;
  settings.seed = 7;
  CppnNeat neat(settings);
  std::set<std::string> seen;
  for (int k = 0; k < 4; ++k) {
    const Proposal made = neat.propose(k, {}, seen);
    neat.tell({identity(made.body), made.body, 0.1 * k, made.genome, {}});
  }
  SteadyState state;
  state.robots = 9;
  state.method = neat.save();
  state.method.fitted = 3;
  state.method.parameters = GpParameters{0.1, 2.5, 1e-7};
  state.method.members.back().features = {0.25, -1.0 / 3.0};
  return state;
}

}  // namespace

TEST_CASE("a steady state comes back to the last bit") {
  const SteadyState state = some_state();
  const std::string text = steady_state_to_text(state);
  const SteadyState back = parse_steady_state(text, "steady.json");
  CHECK(back.robots == 9);
  CHECK(back.method.told == 4);
  CHECK(back.method.fitted == 3);
  CHECK(back.method.parameters->noise == 1e-7);
  CHECK(back.method.species == state.method.species);
  const auto& members = state.method.members;
  REQUIRE(back.method.members.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(back.method.members[i].id == members[i].id);
    CHECK(back.method.members[i].fitness == members[i].fitness);
    CHECK(back.method.members[i].genome == members[i].genome);
    CHECK(back.method.members[i].features == members[i].features);
  }
  CHECK(steady_state_to_text(back) == text);
}

TEST_CASE("a steady state that is damaged is refused with the place") {
  const std::string text = steady_state_to_text(some_state());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return changed;
  };
  CHECK_THROWS_WITH(parse_steady_state(with("\"scores\":4", "\"scores\":10"), "s"),
                    Catch::Contains("/scores"));
  CHECK_THROWS_WITH(parse_steady_state(with("\"version\":1", "\"version\":2"), "s"),
                    Catch::Contains("version"));
  CHECK_THROWS_WITH(parse_steady_state(with("evo/steady", "evo/robot"), "s"),
                    Catch::Contains("evo/steady"));
  CHECK_THROWS_WITH(parse_steady_state(text.substr(0, text.size() / 2), "s"),
                    Catch::Contains("s:"));
}
