// Environments side by side that are not alike.
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "formats/task/task.h"
#include "libevo/base/error.h"
#include "libevo/base/random.h"
#include "libevo/task/env.h"
#include "tests/unit/sim/fixtures.h"

namespace evo {
namespace {

const DataFolders data{"tasks"};

std::vector<double> copy(std::span<const double> values) { return {values.begin(), values.end()}; }

}  // namespace

TEST_CASE("environments of different bodies and tasks share a VecEnv", "[threads]") {
  const Arena walk(load_task("Walker-v0", data), body_a());
  const Arena fetch(load_task("Catcher-v0", data), Body::from_rows({"HVH", "SSS", "V.V"}));
  const Arena climb(load_task("BidirectionalWalker-v0", data), body_a());
  const std::vector<const Arena*> arenas{&walk,  &fetch, &climb, &walk,
                                         &fetch, &walk,  &walk,  &fetch};
  VecEnv mixed(arenas);
  VecEnv pooled(arenas);
  ThreadPool pool(3);
  std::vector<VecEnv> alone;
  std::size_t length = 0;
  std::size_t targets = 0;
  for (int e = 0; e < mixed.environments(); ++e) {
    const Arena& arena = *arenas[static_cast<std::size_t>(e)];
    const auto k = static_cast<std::uint64_t>(e);
    CHECK(&mixed.arena(e) == &arena);
    CHECK(mixed.observation_offset(e) == length);
    CHECK(mixed.action_offset(e) == targets);
    length += static_cast<std::size_t>(arena.observation_length());
    targets += static_cast<std::size_t>(arena.action_length());
    alone.emplace_back(arena, 1).reset(0, {arena.draw(9, k), 0.01, k});
    mixed.reset(e, {arena.draw(9, k), 0.01, k});
    pooled.reset(e, {arena.draw(9, k), 0.01, k});
  }
  CHECK(mixed.observations().size() == length);
  Stream random(4, "test/actions");
  std::vector<double> all(targets);
  for (int step = 0; step < 10; ++step) {
    for (double& target : all) target = 0.5 + 1.2 * random.uniform();
    if (step == 5) pooled.load(mixed.save());
    mixed.step(all);
    pooled.step(all, {}, &pool);
    CHECK(copy(pooled.observations()) == copy(mixed.observations()));
    for (int e = 0; e < mixed.environments(); ++e) {
      const auto i = static_cast<std::size_t>(e);
      const auto count = static_cast<std::size_t>(arenas[i]->action_length());
      alone[i].step(std::span(all).subspan(mixed.action_offset(e), count));
      CHECK(copy(mixed.observations().subspan(mixed.observation_offset(e),
                                              alone[i].observations().size())) ==
            copy(alone[i].observations()));
      CHECK(mixed.rewards()[i] == alone[i].rewards()[0]);
      CHECK(mixed.truncated()[i] == alone[i].truncated()[0]);
    }
  }
}

TEST_CASE("an unstable environment says so and leaves the others alone") {
  TaskSpec wild = load_task("Walker-v0", data);
  wild.name = "Test-wild";
  wild.physics.substep = 0.05;  // far beyond what the springs bear
  const Arena unstable(wild, body_a());
  const Arena stable(load_task("Walker-v0", data), body_a());
  VecEnv env(std::vector<const Arena*>{&stable, &unstable, &stable, &stable});
  VecEnv alone(stable, 1);
  alone.reset(0, {});
  for (int e = 0; e < 4; ++e) env.reset(e, {});
  require_stable(env);
  int steps = 0;
  while (env.status(1) != LaneStatus::unstable) {
    REQUIRE(++steps < 100);
    const std::vector<double> targets(static_cast<std::size_t>(stable.action_length()), 1.3);
    std::vector<double> all;
    for (int e = 0; e < 4; ++e) all.insert(all.end(), targets.begin(), targets.end());
    env.step(all);
    alone.step(targets);
    for (const int e : {0, 2, 3}) {
      CHECK(env.status(e) == LaneStatus::done);
      CHECK(env.positions(e)[0].x == alone.positions(0)[0].x);
      CHECK(env.rewards()[static_cast<std::size_t>(e)] == alone.rewards()[0]);
    }
  }
  CHECK_THROWS_WITH(require_stable(env),
                    "task 'Test-wild': the simulation became unstable in step " +
                        std::to_string(steps) +
                        " of an episode: a value is not a number, or points fly further "
                        "than a voxel in a substep");
  env.reset(1, {});
  CHECK(env.status(1) == LaneStatus::done);
  require_stable(env);
}

}  // namespace evo
