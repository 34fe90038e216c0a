#include "render/film/quantise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace evo::render {
namespace {

struct Sample {
  std::array<int, 3> rgb;
  double weight;
};

struct Box {
  std::size_t first, end;  // of the samples
  std::array<double, 3> mean{};
  std::array<double, 3> spread{};  // weighted squared distance to the mean
  double error() const { return spread[0] + spread[1] + spread[2]; }
};

Box measure(std::span<const Sample> samples, std::size_t first, std::size_t end) {
  Box box{first, end};
  double weight = 0;
  for (const Sample& s : samples.subspan(first, end - first)) {
    weight += s.weight;
    for (std::size_t c = 0; c < 3; ++c) box.mean[c] += s.weight * s.rgb[c];
  }
  for (double& m : box.mean) m /= weight;
  for (const Sample& s : samples.subspan(first, end - first))
    for (std::size_t c = 0; c < 3; ++c)
      box.spread[c] += s.weight * (s.rgb[c] - box.mean[c]) * (s.rgb[c] - box.mean[c]);
  return box;
}

// The box in two, at its mean along the channel that varies most.
std::array<Box, 2> cut(std::span<Sample> samples, const Box& box) {
  const auto channel = static_cast<std::size_t>(
      std::max_element(box.spread.begin(), box.spread.end()) - box.spread.begin());
  const auto part = samples.subspan(box.first, box.end - box.first);
  const auto middle = std::partition(part.begin(), part.end(), [&](const Sample& s) {
    return s.rgb[channel] <= box.mean[channel];
  });
  const std::size_t at = box.first + static_cast<std::size_t>(middle - part.begin());
  return {measure(samples, box.first, at), measure(samples, at, box.end)};
}

std::vector<Sample> sorted_samples(const Histogram& histogram) {
  std::vector<Sample> samples;
  samples.reserve(histogram.counts().size());
  for (const auto& [rgb, count] : histogram.counts())
    samples.push_back({{static_cast<int>(rgb >> 16U & 255U), static_cast<int>(rgb >> 8U & 255U),
                        static_cast<int>(rgb & 255U)},
                       static_cast<double>(count)});
  // The same order, and so the same palette, wherever the map is hashed.
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.rgb < b.rgb; });
  return samples;
}

Color rounded(const std::array<double, 3>& rgb) {
  const auto channel = [](double v) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 255.0)));
  };
  return {channel(rgb[0]), channel(rgb[1]), channel(rgb[2])};
}

std::size_t nearest(const std::vector<Color>& palette, int r, int g, int b) {
  std::size_t best = 0;
  int least = std::numeric_limits<int>::max();
  for (std::size_t k = 0; k < palette.size(); ++k) {
    const int dr = palette[k].r - r;
    const int dg = palette[k].g - g;
    const int db = palette[k].b - b;
    const int distance = dr * dr + dg * dg + db * db;
    if (distance < least) {
      least = distance;
      best = k;
    }
  }
  return best;
}

// One step of k-means.
void refine(const std::vector<Sample>& samples, std::vector<Color>& palette) {
  std::vector<std::array<double, 4>> sums(palette.size());
  for (const Sample& s : samples) {
    auto& sum = sums[nearest(palette, s.rgb[0], s.rgb[1], s.rgb[2])];
    for (std::size_t c = 0; c < 3; ++c) sum[c] += s.weight * s.rgb[c];
    sum[3] += s.weight;
  }
  for (std::size_t k = 0; k < palette.size(); ++k)
    if (sums[k][3] > 0)
      palette[k] =
          rounded({sums[k][0] / sums[k][3], sums[k][1] / sums[k][3], sums[k][2] / sums[k][3]});
}

}  // namespace

void Histogram::add(std::span<const std::uint8_t> rgba) {
  std::uint32_t run = 0;
  std::uint64_t length = 0;
  const auto flush = [&] {
    if (length > 0) counts_[run] += length;
  };
  for (std::size_t k = 0; k + 3 < rgba.size(); k += 4) {
    const std::uint32_t rgb = static_cast<std::uint32_t>(rgba[k]) << 16U |
                              static_cast<std::uint32_t>(rgba[k + 1]) << 8U | rgba[k + 2];
    if (length > 0 && rgb == run) {
      ++length;
      continue;
    }
    flush();
    run = rgb;
    length = 1;
  }
  flush();
}

std::vector<Color> make_palette(const Histogram& histogram, std::size_t most) {
  std::vector<Sample> samples = sorted_samples(histogram);
  std::vector<Color> palette;
  if (samples.size() <= most) {
    for (const Sample& s : samples)
      palette.push_back(rounded({static_cast<double>(s.rgb[0]), static_cast<double>(s.rgb[1]),
                                 static_cast<double>(s.rgb[2])}));
    return palette;
  }
  std::vector<Box> boxes{measure(samples, 0, samples.size())};
  while (boxes.size() < most) {
    const auto worst = std::max_element(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) {
      return a.error() < b.error();
    });
    if (worst->error() <= 0) break;
    const auto [low, high] = cut(samples, *worst);
    *worst = low;
    boxes.push_back(high);
  }
  for (const Box& box : boxes) palette.push_back(rounded(box.mean));
  refine(samples, palette);
  return palette;
}

PaletteMap::PaletteMap(std::vector<Color> palette)
    : palette_(std::move(palette)), known_(std::size_t{1} << 24U) {}

std::uint8_t PaletteMap::index(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  std::uint16_t& entry =
      known_[static_cast<std::size_t>(r) << 16U | static_cast<std::size_t>(g) << 8U | b];
  if (entry == 0) entry = static_cast<std::uint16_t>(nearest(palette_, r, g, b) + 1);
  return static_cast<std::uint8_t>(entry - 1);
}

}  // namespace evo::render
