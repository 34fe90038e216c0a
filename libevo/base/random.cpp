#include "libevo/base/random.h"

#include "libevo/base/elementary.h"

namespace evo {
namespace {

// SplitMix64's finaliser: every input bit reaches every output bit.
std::uint64_t mix(std::uint64_t z) {
  z += 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31);
}

// FNV-1a over the text, started from a mixed seed, mixed again at the end.
std::uint64_t hash(std::uint64_t seed, std::string_view text) {
  std::uint64_t h = mix(seed) ^ 0xCBF29CE484222325U;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  return mix(h);
}

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> c,
                                    std::array<std::uint32_t, 2> k) {
  constexpr std::uint64_t m0 = 0xD2511F53U;
  constexpr std::uint64_t m1 = 0xCD9E8D57U;
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = m0 * c[0];
    const std::uint64_t p1 = m1 * c[2];
    c = {static_cast<std::uint32_t>(p1 >> 32) ^ c[1] ^ k[0], static_cast<std::uint32_t>(p1),
         static_cast<std::uint32_t>(p0 >> 32) ^ c[3] ^ k[1], static_cast<std::uint32_t>(p0)};
    k[0] += 0x9E3779B9U;
    k[1] += 0xBB67AE85U;
  }
  return c;
}

}  // namespace

Stream::Stream(std::uint64_t seed, std::string_view purpose, std::uint64_t index) : index_(index) {
  const std::uint64_t h = hash(seed, purpose);
  key_ = {static_cast<std::uint32_t>(h), static_cast<std::uint32_t>(h >> 32)};
}

Stream::Stream(std::uint64_t seed, std::string_view purpose, std::string_view name,
               std::uint64_t index)
    : Stream(hash(seed, name), purpose, index) {}

void Stream::refill() {
  block_ = philox({static_cast<std::uint32_t>(position_.block),
                   static_cast<std::uint32_t>(position_.block >> 32),
                   static_cast<std::uint32_t>(index_), static_cast<std::uint32_t>(index_ >> 32)},
                  key_);
}

void Stream::seek(const Position& position) {
  position_ = position;
  if (position_.used < 4) {  // the block in hand is the one before `block`
    --position_.block;
    refill();
    ++position_.block;
  }
}

std::uint32_t Stream::bits() {
  if (position_.used == 4) {
    refill();
    ++position_.block;
    position_.used = 0;
  }
  return block_[position_.used++];
}

double Stream::uniform() {
  const std::uint64_t high = bits() >> 5;
  const std::uint64_t low = bits() >> 6;
  return static_cast<double>(high << 26 | low) * 0x1p-53;
}

std::uint32_t Stream::below(std::uint32_t n) {
  // Lemire's multiplication method; the rejected zone is empty for powers of two.
  std::uint64_t product = std::uint64_t{bits()} * n;
  if (static_cast<std::uint32_t>(product) < n) {
    const std::uint32_t threshold = (0U - n) % n;
    while (static_cast<std::uint32_t>(product) < threshold) product = std::uint64_t{bits()} * n;
  }
  return static_cast<std::uint32_t>(product >> 32);
}

int Stream::integer(int low, int high) {
  const auto span = static_cast<std::uint32_t>(high - low) + 1U;
  return low + static_cast<int>(below(span));
}

double Stream::gaussian() {
  // Box-Muller, one of the pair: a draw costs the same amount of stream always.
  const double u = 1.0 - uniform();  // in (0, 1]
  const double v = uniform();
  constexpr double two_pi = 6.283185307179586;
  return math::sqrt(-2.0 * math::log(u)) * math::cos(two_pi * v);
}

std::size_t Stream::discrete(std::span<const double> weights) {
  double total = 0.0;
  for (const double w : weights) total += w;
  const double u = uniform();
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i] / total;
    if (u <= sum && weights[i] > 0.0) return i;
  }
  for (std::size_t i = weights.size(); i-- > 0;)
    if (weights[i] > 0.0) return i;  // rounding left the sum just below u
  return 0;
}

std::uint64_t derive_seed(std::uint64_t seed, std::string_view purpose, std::uint64_t index) {
  return mix(hash(seed, purpose) ^ mix(index));
}

}  // namespace evo
