// A palette for formats that have no more than 256 colours.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "render/painters/image.h"

namespace evo::render {

// Colours counted over some frames of an animation.
class Histogram {
 public:
  void add(std::span<const std::uint8_t> rgba);
  const std::unordered_map<std::uint32_t, std::uint64_t>& counts() const { return counts_; }

 private:
  std::unordered_map<std::uint32_t, std::uint64_t> counts_;  // 0xRRGGBB
};

// At most `most` colours: all that occur, if they are that few, else the means of
// boxes cut where the squared error is largest (variance-based median cut: Wan,
// Wong, Prusinkiewicz, ACM TOMS 14, 1988), then moved to the mean of the colours
// nearest to each.
std::vector<Color> make_palette(const Histogram& histogram, std::size_t most);

// Nearest palette entry of any colour, remembered for each of the 2^24.
class PaletteMap {
 public:
  explicit PaletteMap(std::vector<Color> palette);
  const std::vector<Color>& palette() const { return palette_; }
  std::uint8_t index(std::uint8_t r, std::uint8_t g, std::uint8_t b);

 private:
  std::vector<Color> palette_;
  std::vector<std::uint16_t> known_;  // entry + 1, 0: not looked up yet
};

}  // namespace evo::render
