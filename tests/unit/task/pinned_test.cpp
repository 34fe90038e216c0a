// The bits of the trajectories of all 32 tasks, pinned: the same for every
// instruction set, batch width and number of threads. A hash that changes is a
// change of results, to be explained. `UPDATE_GOLDEN=1 test_task "[pinned]"`
// writes tests/data/pinned/trajectories.tsv anew.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "formats/task/task.h"
#include "libevo/base/parallel.h"
#include "libevo/base/random.h"
#include "libevo/task/env.h"
#include "tests/unit/sim/fixtures.h"

using namespace evo;

namespace {

// Chains of random episodes of a task.
constexpr int chains = 4;         // of episodes, each begun again where one ends
constexpr int quick = 100;        // control steps of a chain
constexpr int whole = 500;        // as many as most tasks give an episode
constexpr double jitter = 0.001;  // voxels, of odd chains; even ones start in exact contact

const char* const table_file = "tests/data/pinned/trajectories.tsv";

struct Pinned {
  std::string task;
  std::uint64_t after_quick = 0;
  std::uint64_t after_whole = 0;
};

std::vector<Pinned> read_table() {
  std::ifstream file(table_file);
  std::string header;
  std::getline(file, header);
  std::vector<Pinned> rows;
  Pinned row;
  while (file >> row.task >> std::hex >> row.after_quick >> row.after_whole) rows.push_back(row);
  return rows;
}

// How the chains are run: nothing of this may show in the hashes.
struct Way {
  std::string isa;
  int width = 1;  // environments stepped together; beyond the chains, others beside them
  int threads = 1;
};

std::string name_of(const Way& way) {
  return way.isa + ", " + std::to_string(way.width) + " side by side, " +
         std::to_string(way.threads) + " threads";
}

// Every instruction set, every width and every number of threads, the slower
// the instruction set the less work.
std::vector<Way> quick_ways() {
  std::vector<std::string> isas = available_isas();
  std::reverse(isas.begin(), isas.end());
  std::vector<Way> ways{{isas[0], 8, 3}, {isas[0], 8, 1}};
  ways.push_back({isas[std::min<std::size_t>(1, isas.size() - 1)], 4, 2});
  for (std::size_t i = 2; i < isas.size(); ++i) ways.push_back({isas[i], 1, 1});
  if (isas.size() < 3) ways.push_back({isas.back(), 1, 1});
  return ways;
}

// Some chains of random episodes of one arena, side by side.
class Runner {
 public:
  Runner(const Arena& arena, int first_chain, int width)
      : arena_(arena),
        first_chain_(static_cast<std::uint64_t>(first_chain)),
        env_(arena, width),
        hashes_(static_cast<std::size_t>(width)),
        episodes_(static_cast<std::size_t>(width)) {
    for (int i = 0; i < width; ++i) {
      random_.emplace_back(1, "pinned/actions", first_chain_ + static_cast<std::uint64_t>(i));
      reset(i);
    }
  }

  void step(ThreadPool& pool) {
    const Physics& physics = arena_.task().physics;
    std::vector<double> actions;
    for (Stream& random : random_)
      for (int k = 0; k < arena_.action_length(); ++k)
        actions.push_back(physics.min_target +
                          (physics.max_target - physics.min_target) * random.uniform());
    env_.step(actions, {}, &pool);
    for (int i = 0; i < env_.environments(); ++i) {
      record(i);
      const auto e = static_cast<std::size_t>(i);
      if (env_.terminated()[e] || env_.truncated()[e]) reset(i);
    }
  }

  std::uint64_t hash(int i) const { return hashes_[static_cast<std::size_t>(i)].value(); }

 private:
  void reset(int i) {
    const std::uint64_t chain = first_chain_ + static_cast<std::uint64_t>(i);
    const std::uint64_t episode = 1000 * chain + episodes_[static_cast<std::size_t>(i)]++;
    env_.reset(i, {arena_.draw(1, episode), chain % 2 == 1 ? jitter : 0.0, episode});
  }

  void record(int i) {
    const auto e = static_cast<std::size_t>(i);
    const auto length = static_cast<std::size_t>(arena_.observation_length());
    Hash& hash = hashes_[e];
    for (const Vec2& p : env_.positions(i)) hash.add(p.x), hash.add(p.y);
    for (const Vec2& v : env_.velocities(i)) hash.add(v.x), hash.add(v.y);
    for (const double o : env_.observations().subspan(e * length, length)) hash.add(o);
    hash.add(env_.rewards()[e]);
    hash.add(std::uint64_t{env_.terminated()[e]} << 1U | env_.truncated()[e]);
  }

  const Arena& arena_;
  std::uint64_t first_chain_;
  VecEnv env_;
  std::vector<Hash> hashes_;
  std::vector<std::uint64_t> episodes_;
  std::vector<Stream> random_;
};

// After `quick` steps, and after `whole` ones if so many are asked for.
Pinned run(const std::string& task, const Way& way, int steps) {
  select_isa(way.isa);
  const Arena arena(load_task(task, {"tasks"}), body_a());
  ThreadPool pool(way.threads);
  Hash after_quick;
  Hash after_whole;
  for (int first = 0; first < chains; first += way.width) {
    Runner runner(arena, first, way.width);
    const int members = std::min(way.width, chains);
    for (int step = 1; step <= steps; ++step) {
      runner.step(pool);
      Hash* const hash = step == quick ? &after_quick : step == whole ? &after_whole : nullptr;
      for (int i = 0; hash && i < members; ++i) hash->add(runner.hash(i));
    }
  }
  return {task, after_quick.value(), steps >= whole ? after_whole.value() : 0};
}

void update_table() {
  std::ostringstream table;
  table << "task\tafter_" << quick << "\tafter_" << whole << "\n" << std::hex;
  for (const std::string& task : task_names({"tasks"})) {
    const Pinned row = run(task, {best_isa(), 8, 1}, whole);
    table << row.task << "\t0x" << row.after_quick << "\t0x" << row.after_whole << "\n";
  }
  std::ofstream(table_file) << table.str();
}

}  // namespace

TEST_CASE("the trajectories of all tasks keep their bits", "[pinned]") {
  const IsaGuard guard;
  if (std::getenv("UPDATE_GOLDEN")) update_table();
  const std::vector<Pinned> table = read_table();
  REQUIRE(table.size() == 32);
  for (const Pinned& row : table) {
    for (const Way& way : quick_ways()) {
      INFO(row.task << ", " << name_of(way));
      CHECK(run(row.task, way, quick).after_quick == row.after_quick);
    }
  }
}

TEST_CASE("whole episodes keep their bits in every way of running them", "[.slow][pinned]") {
  const IsaGuard guard;
  for (const Pinned& row : read_table()) {
    for (const std::string& isa : available_isas()) {
      for (const int width : {1, 4, 8}) {
        for (const int threads : {1, 2, 3}) {
          if (threads > width) continue;
          const Way way{isa, width, threads};
          INFO(row.task << ", " << name_of(way));
          const Pinned found = run(row.task, way, whole);
          CHECK(found.after_quick == row.after_quick);
          CHECK(found.after_whole == row.after_whole);
        }
      }
    }
  }
}
