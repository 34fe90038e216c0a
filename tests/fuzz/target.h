// One reader under any bytes: it accepts them or throws Error(data), nothing else.
// Built with libFuzzer by `scripts/fuzz`, and with a driver of our own (driver.cpp)
// for the regressions and a quick run in CI.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "libevo/base/error.h"

namespace evo::fuzz {

void read(std::string_view input);

inline void expect(bool holds) {
  if (!holds) std::abort();
}

// Errors of the kinds a file's content can cause.
inline void run(std::string_view input) {
  try {
    read(input);
  } catch (const Error& error) {
    // A name in a file can be unknown, and a file that it names missing.
    expect(error.kind() == Failure::data || error.kind() == Failure::usage ||
           error.kind() == Failure::no_input);
  }
}

}  // namespace evo::fuzz

using evo::fuzz::expect;

#define FUZZ_TARGET(input) void evo::fuzz::read(std::string_view input)

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
