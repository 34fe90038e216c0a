#pragma once

#include <catch2/catch.hpp>

#include "libevo/base/error.h"

namespace evo {

// `f` throws an Error of this kind whose message matches.
template <typename Matcher, typename F>
void expect_error(Failure kind, const Matcher& matcher, F f) {
  try {
    f();
    FAIL("no error was thrown");
  } catch (const Error& error) {
    CHECK(error.kind() == kind);
    CHECK_THAT(error.what(), matcher);
  }
}

}  // namespace evo
