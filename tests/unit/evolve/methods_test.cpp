#include "libevo/evolve/methods.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libevo/evolve/select.h"

using namespace evo;

namespace {

constexpr int window = 5;

EvolutionSettings brief() {
  EvolutionSettings settings;
  settings.pop = settings.neat.pop_size = 6;
  settings.evals = 24;
  settings.rows = settings.cols = 4;
  settings.seed = 11;
  settings.axes = {{"filled", 3}, {"actuated", 3}};
  return settings;
}

// As if trained: more actuators are better, every seventh robot fails.
ScoredRobot scored(const Proposal& proposal, int number) {
  const double fitness = number % 7 == 6 ? std::numeric_limits<double>::quiet_NaN()
                                         : count_actuators(proposal.body) + 0.01 * number;
  ScoredRobot robot{identity(proposal.body), proposal.body, fitness, proposal.genome, {}};
  for (const char* axis : {"filled", "actuated"})
    robot.features.push_back(*body_feature(proposal.body, axis));
  return robot;
}

// A run in which the method is saved and another one goes on from there before every
// `pieces`-th robot; 0: never. What robots from `forgotten` on scored is another number.
std::vector<Proposal> evolve(const std::string& name, int pieces, int forgotten = 1000) {
  const EvolutionSettings settings = brief();
  std::vector<Proposal> robots;
  std::vector<Body> bodies;
  std::set<std::string> seen;
  int told = 0;
  const auto score_of = [&](int number) {
    ScoredRobot robot = scored(robots[static_cast<std::size_t>(number)], number);
    if (number >= forgotten) robot.fitness = 100.0 - number;
    return robot;
  };
  AnyEvolution method = make_evolution(name, settings);
  for (int number = 0; number < settings.evals; ++number) {
    if (pieces > 0 && number % pieces == 0) {
      MethodState state = std::visit([](auto& it) { return it.save(); }, method);
      CHECK(state.told == told);
      method = make_evolution(name, settings);
      std::visit(
          [&](auto& it) {
            it.load(std::move(state));
            if (it.told_again)
              for (int k = 0; k < told; ++k) it.tell(score_of(k));
          },
          method);
    }
    std::visit(
        [&](auto& it) {
          for (; told < known_scores(number, window, settings.pop); ++told) it.tell(score_of(told));
          const auto pending =
              std::span<const Body>(bodies).subspan(static_cast<std::size_t>(told));
          robots.push_back(it.propose(number, pending, seen));
        },
        method);
    bodies.push_back(robots.back().body);
  }
  return robots;
}

std::vector<std::string> ids(const std::vector<Proposal>& robots) {
  std::vector<std::string> list;
  for (const Proposal& robot : robots) list.push_back(identity(robot.body));
  return list;
}

}  // namespace

TEST_CASE("every method goes on from its saved state as if it had never stopped") {
  for (const std::string& name : evolution_names()) {
    INFO(name);
    const std::vector<Proposal> whole = evolve(name, 0);
    const std::vector<Proposal> parts = evolve(name, 1);
    CHECK(ids(whole) == ids(parts));
    CHECK(ids(whole) == ids(evolve(name, 7)));
    for (std::size_t k = 0; k < whole.size(); ++k) {
      CHECK(whole[k].parents == parts[k].parents);
      CHECK(whole[k].genome == parts[k].genome);
    }
  }
}

TEST_CASE("every method proposes valid bodies that are new, whose parents were scored") {
  for (const std::string& name : evolution_names()) {
    INFO(name);
    const std::vector<Proposal> robots = evolve(name, 0);
    const std::vector<std::string> all = ids(robots);
    CHECK(std::set<std::string>(all.begin(), all.end()).size() == all.size());
    for (std::size_t k = 0; k < robots.size(); ++k) {
      CHECK(is_valid_robot(robots[k].body));
      const auto known = all.begin() + known_scores(static_cast<int>(k), window, brief().pop);
      for (const std::string& parent : robots[k].parents)
        CHECK(std::find(all.begin(), known, parent) != known);
    }
  }
}

TEST_CASE("a robot depends on the scores that it knows, and on no other") {
  for (const std::string& name : evolution_names()) {
    INFO(name);
    constexpr int forgotten = 8;
    const std::vector<std::string> one = ids(evolve(name, 0));
    const std::vector<std::string> other = ids(evolve(name, 0, forgotten));
    const int first = forgotten + window + 1;  // that knows such a score
    CHECK(std::equal(one.begin(), one.begin() + first, other.begin()));
    CHECK(one != other);
  }
}

TEST_CASE("an unknown method of evolution is named with the nearest one") {
  CHECK_THROWS_WITH(make_evolution("gaa", brief()),
                    Catch::Contains("none of ga, neat, bo, map") && Catch::Contains("'ga'"));
}
