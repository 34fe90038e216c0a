#include "libevo/base/parallel.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <stdexcept>
#include <vector>

TEST_CASE("every index is run once, whatever the number of threads", "[threads]") {
  for (const int threads : {1, 2, 5}) {
    evo::ThreadPool pool(threads);
    REQUIRE(pool.threads() == threads);
    for (int round = 0; round < 50; ++round) {
      std::vector<std::atomic<int>> hits(97);
      std::atomic<int> strangers = 0;  // assertions are not for several threads
      pool.run(hits.size(), [&](std::size_t i, int worker) {
        if (worker < 0 || worker >= threads) ++strangers;
        ++hits[i];
      });
      REQUIRE(strangers == 0);
      for (const auto& hit : hits) REQUIRE(hit == 1);
    }
  }
}

TEST_CASE("the exception of the smallest index comes back", "[threads]") {
  evo::ThreadPool pool(3);
  for (int round = 0; round < 20; ++round) {
    try {
      pool.run(50, [](std::size_t i, int) {
        if (i % 10 == 7) throw std::runtime_error(std::to_string(i));
      });
      FAIL("no exception");
    } catch (const std::runtime_error& e) {
      CHECK(std::string(e.what()) == "7");
    }
  }
}
