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
#include "tests/unit/sim/fixtures.h"
#include "tests/unit/task/pinned.h"

using namespace evo;
using pinned::quick;
using pinned::whole;

namespace {

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

Pinned run(const std::string& task, const Way& way, int steps) {
  select_isa(way.isa);
  const pinned::Hashes hashes =
      pinned::run(load_task(task, {"tasks"}), way.width, way.threads, steps);
  return {task, hashes.after_quick, hashes.after_whole};
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
