#include "libevo/base/parallel.h"

#include <sys/resource.h>

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

TEST_CASE("after a failure nothing further is begun") {
  evo::ThreadPool pool(2);
  std::atomic<int> begun = 0;
  CHECK_THROWS_AS(pool.run(100'000,
                           [&](std::size_t, int) {
                             ++begun;
                             throw std::runtime_error("no");
                           }),
                  std::runtime_error);
  CHECK(begun <= 2);
}

#ifndef __SANITIZE_ADDRESS__  // which itself needs more address space than that
TEST_CASE("fewer threads than asked for share the work") {
  // Room for the stacks of a few threads only.
  rlimit before{};
  REQUIRE(getrlimit(RLIMIT_AS, &before) == 0);
  rlimit small = before;
  small.rlim_cur = rlim_t{1} << 29;
  REQUIRE(setrlimit(RLIMIT_AS, &small) == 0);
  {
    evo::ThreadPool pool(1000);
    CHECK(pool.threads() < 1000);
    std::atomic<int> done = 0;
    pool.run(5000, [&](std::size_t, int) { ++done; });
    CHECK(done == 5000);
  }
  setrlimit(RLIMIT_AS, &before);
}
#endif
