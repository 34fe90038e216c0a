// Files damaged at random.
#pragma once

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "libevo/base/error.h"
#include "libevo/base/random.h"

namespace evo::test {

const std::string any_byte;  // none in particular
const std::string text_signs = "{}[]\",:#&*!|>-\n\\ 0123456789eH.\xFF";

// How many of `count` files `read` refuses, with Error(data) in one line; it throws nothing else.
// Each file is one of `originals`: cut short, or with some bytes replaced by others of `signs`;
// text has some between its own, too.
template <typename Read>
int refusals(const std::vector<std::string>& originals, std::uint64_t count,
             const std::string& signs, Read read) {
  int refused = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    Stream random(2, "test/damage", i);
    const auto below = [&](std::size_t n) { return random.below(static_cast<std::uint32_t>(n)); };
    std::string file = originals[i % originals.size()];
    if (below(4) == 0) {
      file.resize(below(file.size()));
    } else {
      for (std::uint32_t k = 1 + below(4); k > 0; --k) {
        const char sign =
            signs.empty() ? static_cast<char>(below(256)) : signs[below(signs.size())];
        if (!signs.empty() && below(2) == 0)
          file.insert(below(file.size()), 1, sign);
        else
          file[below(file.size())] = sign;
      }
    }
    try {
      read(file);
    } catch (const Error& e) {
      REQUIRE(e.kind() == Failure::data);
      INFO(e.what());
      REQUIRE(std::string(e.what()).find('\n') == std::string::npos);
      ++refused;
    }
  }
  return refused;
}

}  // namespace evo::test
