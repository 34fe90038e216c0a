// What environments cost: memory each, and none more for every episode.
#include <malloc.h>

#include <catch2/catch.hpp>

#include "formats/task/task.h"
#include "libevo/base/random.h"
#include "libevo/task/env.h"
#include "tests/unit/sim/fixtures.h"

namespace evo {
namespace {

const DataFolders data{"tasks"};

// Bytes given out by the allocator at present; 0 under sanitizers, which have one of
// their own (and look for leaks themselves).
std::size_t bytes_in_use() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

// Resets environments of a task, with a step between, and returns by how much the
// memory in use grew once everything had its size.
std::ptrdiff_t growth(const char* name, std::uint64_t resets) {
  constexpr std::uint64_t settle = 500;
  constexpr int environments = 4;
  const Arena arena(load_task(name, data), body_a());
  VecEnv envs(arena, environments);
  const std::vector<double> targets(static_cast<std::size_t>(environments * arena.action_length()),
                                    1.3);
  std::size_t before = 0;
  for (std::uint64_t k = 0; k < settle + resets; ++k) {
    if (k == settle) before = bytes_in_use();
    envs.reset(static_cast<int>(k % environments), {arena.draw(1, k % settle), 1e-3, k % settle});
    if (k % 64 == environments) envs.step(targets);
  }
  return static_cast<std::ptrdiff_t>(bytes_in_use()) - static_cast<std::ptrdiff_t>(before);
}

// Contact lists may still find a longer candidate list than ever before.
constexpr std::ptrdiff_t growth_allowed = 16'384;

}  // namespace

TEST_CASE("an environment of a 5x5 robot takes less than 200 kB in every task") {
  constexpr std::size_t limit = 200'000;
  for (const std::string& name : task_names(data)) {
    const Arena arena(load_task(name, data), body_a());
    const std::size_t before = bytes_in_use();
    Batch batch(8);
    Stream random(1, "targets");
    for (std::size_t lane = 0; lane < batch.lanes(); ++lane) batch.place(lane, arena.model());
    for (int t = 0; t < 50; ++t) {
      for (std::size_t lane = 0; lane < batch.lanes(); ++lane)
        for (double& target : batch.targets(lane)) target = 0.6 + random.uniform();
      batch.step();
    }
    INFO(name);
    CHECK((bytes_in_use() - before) / batch.lanes() < limit);
  }
}

TEST_CASE("resets do not grow memory: twenty thousand") {
  CHECK(growth("Walker-v0", 10'000) < growth_allowed);
  CHECK(growth("Catcher-v0", 10'000) < growth_allowed);
}

TEST_CASE("resets do not grow memory: a million", "[.slow]") {
  CHECK(growth("Walker-v0", 500'000) < growth_allowed);
  CHECK(growth("Catcher-v0", 500'000) < growth_allowed);
}

}  // namespace evo
