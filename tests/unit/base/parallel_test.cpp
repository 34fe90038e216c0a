#include "libevo/base/parallel.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <stdexcept>
#include <vector>

TEST_CASE("every index is run once, whatever the number of threads") {
  for (const int threads : {1, 2, 5}) {
    evo::ThreadPool pool(threads);
    REQUIRE(pool.threads() == threads);
    for (int round = 0; round < 50; ++round) {
      std::vector<std::atomic<int>> hits(97);
      pool.run(hits.size(), [&](std::size_t i, int worker) {
        REQUIRE(worker >= 0);
        REQUIRE(worker < threads);
        ++hits[i];
      });
      for (const auto& hit : hits) REQUIRE(hit == 1);
    }
  }
}

TEST_CASE("the exception of the smallest index comes back") {
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
