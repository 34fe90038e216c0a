#include "render/film/workers.h"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cerrno>
#include <csignal>

#include "tests/unit/expect.h"

namespace evo::render {
namespace {

using Catch::Matchers::Contains;
using test::expect_error;

bool no_children() { return ::waitpid(-1, nullptr, WNOHANG) < 0 && errno == ECHILD; }

void put_number(std::size_t frame, std::span<std::uint8_t> slot) {
  slot[0] = static_cast<std::uint8_t>(frame);
}

TEST_CASE("frames arrive in order for any number of workers") {
  const int workers = GENERATE(1, 2, 3, 8);
  const std::size_t frames = GENERATE(0, 1, 2, 7, 40);
  std::vector<std::size_t> order;
  run_workers({frames, 1, workers,
               [](Painter&, std::size_t frame, std::span<std::uint8_t> slot) {
                 if (frame % 3 == 0) ::usleep(500);  // some are slower
                 put_number(frame, slot);
               },
               [&](std::size_t frame, std::span<const std::uint8_t> bytes) {
                 REQUIRE(bytes.size() == 1);
                 CHECK(bytes[0] == frame);
                 order.push_back(frame);
               }});
  CHECK(order.size() == frames);
  CHECK(std::is_sorted(order.begin(), order.end()));
  CHECK(no_children());
}

TEST_CASE("an error in a worker arrives with its kind and message, its death as an error") {
  struct Trouble {
    Failure kind;
    const char* words;
    void (*happens)();
  };
  const Trouble trouble = GENERATE(values<Trouble>(
      {{Failure::cannot_create, "no room", [] { throw Error(Failure::cannot_create, "no room"); }},
       {Failure::work, "signal 9", [] { ::raise(SIGKILL); }}}));
  const int workers = GENERATE(1, 2);
  expect_error(trouble.kind, Contains(trouble.words), [&] {
    run_workers({10, 4, workers,
                 [&](Painter&, std::size_t frame, std::span<std::uint8_t> slot) {
                   if (frame == 4) trouble.happens();
                   put_number(frame, slot);
                 },
                 [](std::size_t, std::span<const std::uint8_t>) {}});
  });
  CHECK(no_children());
}

TEST_CASE("the taker may throw") {
  std::size_t taken = 0;
  expect_error(Failure::io, Contains("full"), [&] {
    run_workers(
        {1000, 4, 2,
         [](Painter&, std::size_t frame, std::span<std::uint8_t> slot) { put_number(frame, slot); },
         [&](std::size_t, std::span<const std::uint8_t>) {
           if (++taken == 3) throw Error(Failure::io, "full");
         }});
  });
  CHECK(taken == 3);
  CHECK(no_children());
}

}  // namespace
}  // namespace evo::render
