#include "formats/io/lock.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>

#include "tests/unit/expect.h"

using namespace evo;

TEST_CASE("a byte is taken by one at a time, and given back") {
  const test::ScratchFolder scratch;
  const auto file = scratch / "lock";
  const LockFile one(file);
  CHECK(one.take(7));
  CHECK(one.take(7));  // it has it
  {
    const LockFile other(file);
    CHECK_FALSE(other.take(7));
    CHECK(other.take(8));
    CHECK_FALSE(one.take(8));
  }
  CHECK(one.take(8));
  CHECK(std::filesystem::file_size(file) == 0);
}

TEST_CASE("a process that is killed gives back what it held") {
  const test::ScratchFolder scratch;
  const auto file = scratch / "lock";
  std::array<int, 2> ready{};
  REQUIRE(::pipe(ready.data()) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const LockFile lock(file);
    const char held = lock.take(0) ? 'y' : 'n';
    if (::write(ready[1], &held, 1) != 1) ::_exit(1);
    ::pause();
  }
  char held = '?';
  REQUIRE(::read(ready[0], &held, 1) == 1);
  CHECK(held == 'y');
  const LockFile lock(file);
  CHECK_FALSE(lock.take(0));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK(lock.take(0));
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_CASE("where nothing can be locked, everything is granted") {
  const test::ScratchFolder scratch;
  std::filesystem::create_directory(scratch / "lock");
  for (const auto& file : {scratch / "lock", scratch / "nowhere" / "lock"}) {
    const LockFile one(file);
    const LockFile other(file);
    CHECK(one.take(0));
    CHECK(other.take(0));
  }
}
