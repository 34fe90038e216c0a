// Counter-based random streams. A stream is named by (seed, purpose, index):
// the same name gives the same numbers on any machine, in any thread, in any
// order of use. The generator is Philox4x32-10 (Salmon et al., "Parallel Random
// Numbers: As Easy as 1, 2, 3", SC 2011); no state but a position.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace evo {

class Stream {
 public:
  // `purpose` says what the numbers are for ("sample", "train/noise", ...), so
  // that two uses of one seed never share numbers. `index` counts the robots,
  // environments or episodes of that purpose.
  Stream(std::uint64_t seed, std::string_view purpose, std::uint64_t index = 0);
  // As above, for something named rather than numbered (a robot id, a task).
  Stream(std::uint64_t seed, std::string_view purpose, std::string_view name,
         std::uint64_t index = 0);

  std::uint32_t bits();                  // 32 uniform bits
  double uniform();                      // in [0, 1), 53 bits
  std::uint32_t below(std::uint32_t n);  // in {0, .., n-1}, unbiased; n > 0
  int integer(int low, int high);        // in {low, .., high}
  double gaussian();                     // standard normal
  // First index whose running share of the weights is >= one uniform draw
  // (docs/methods.md, "Robots"). Weights are non-negative and not all zero.
  std::size_t discrete(std::span<const double> weights);

  // Position in the stream, for checkpoints: seek(tell()) changes nothing.
  struct Position {
    std::uint64_t block = 0;
    std::uint32_t used = 4;
    bool operator==(const Position&) const = default;
  };
  Position tell() const { return position_; }
  void seek(const Position& position);

 private:
  void refill();

  std::array<std::uint32_t, 2> key_{};
  std::uint64_t index_ = 0;
  Position position_;
  std::array<std::uint32_t, 4> block_{};
};

// A seed for a named child of a computation, well mixed.
std::uint64_t derive_seed(std::uint64_t seed, std::string_view purpose, std::uint64_t index = 0);

}  // namespace evo
