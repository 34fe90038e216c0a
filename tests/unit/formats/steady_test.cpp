#include "formats/run/steady.h"

#include <catch2/catch.hpp>

#include "formats/robot/genome.h"
#include "libevo/evolve/cppn_neat.h"

using namespace evo;

namespace {

SteadyState some_state() {
  SteadyState state;
  state.robots = 9;
  state.scores = 4;
  state.fitted = 3;
  state.parameters = GpParameters{0.1, 2.5, 1e-7};
  NeatSettings settings;
  settings.pop_size = 5;
  std::set<std::string> seen;
  std::vector<Scored> population;
  for (int k = 0; k < 4; ++k) {
    const CppnRobot made = next_robot(settings, 4, 4, population, seen, state.species, k, 7);
    Robot robot(made.body);
    robot.document["genome"] = genome_to_json(made.genome);
    robot.document["fitness"] = 0.1 * k;
    state.members.push_back(robot);
    join(settings, {made.genome, 0.1 * k}, population, state.species);
  }
  return state;
}

}  // namespace

TEST_CASE("a steady state comes back to the last bit") {
  const SteadyState state = some_state();
  const std::string text = steady_state_to_text(state);
  const SteadyState back = parse_steady_state(text, "steady.json");
  CHECK(back.robots == 9);
  CHECK(back.scores == 4);
  CHECK(back.fitted == 3);
  CHECK(back.parameters->noise == 1e-7);
  CHECK(back.species == state.species);
  REQUIRE(back.members.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(back.members[i].id == state.members[i].id);
    CHECK(*back.members[i].fitness() == *state.members[i].fitness());
    CHECK(genome_of(back.members[i], "") == genome_of(state.members[i], ""));
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
