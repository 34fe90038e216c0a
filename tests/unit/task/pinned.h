// Chains of random episodes of a task, and a hash of all that happens in them.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "libevo/base/parallel.h"
#include "libevo/base/random.h"
#include "libevo/task/env.h"

namespace evo::pinned {

inline constexpr int chains = 4;         // of episodes, each begun again where one ends
inline constexpr int quick = 100;        // control steps of a chain
inline constexpr int whole = 500;        // as many as most tasks give an episode
inline constexpr double jitter = 0.001;  // voxels, of odd chains; even ones start in exact contact

class Hash {  // FNV-1a, a word at a time
 public:
  void add(std::uint64_t word) {
    value_ = (value_ ^ word) * 0x100000001B3U;
    value_ ^= value_ >> 32;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }  // -0 and 0 differ
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325U;
};

// Some chains of random episodes of one arena, side by side.
class Runner {
 public:
  Runner(const Arena& arena, int first_chain, int width)
      : arena_(arena),
        first_chain_(static_cast<std::uint64_t>(first_chain)),
        env_(arena, width),
        hashes_(static_cast<std::size_t>(width)),
        episodes_(static_cast<std::size_t>(width)) {
    for (int i = 0; i < width; ++i) {
      random_.emplace_back(1, "pinned/actions", first_chain_ + static_cast<std::uint64_t>(i));
      reset(i);
    }
  }

  void step(ThreadPool& pool) {
    const Physics& physics = arena_.task().physics;
    std::vector<double> actions;
    for (Stream& random : random_)
      for (int k = 0; k < arena_.action_length(); ++k)
        actions.push_back(physics.min_target +
                          (physics.max_target - physics.min_target) * random.uniform());
    env_.step(actions, {}, &pool);
    for (int i = 0; i < env_.environments(); ++i) {
      record(i);
      const auto e = static_cast<std::size_t>(i);
      if (env_.terminated()[e] || env_.truncated()[e]) reset(i);
    }
  }

  std::uint64_t hash(int i) const { return hashes_[static_cast<std::size_t>(i)].value(); }

 private:
  void reset(int i) {
    const std::uint64_t chain = first_chain_ + static_cast<std::uint64_t>(i);
    const std::uint64_t episode = 1000 * chain + episodes_[static_cast<std::size_t>(i)]++;
    env_.reset(i, {arena_.draw(1, episode), chain % 2 == 1 ? jitter : 0.0, episode});
  }

  void record(int i) {
    const auto e = static_cast<std::size_t>(i);
    const auto length = static_cast<std::size_t>(arena_.observation_length());
    Hash& hash = hashes_[e];
    for (const Vec2& p : env_.positions(i)) hash.add(p.x), hash.add(p.y);
    for (const Vec2& v : env_.velocities(i)) hash.add(v.x), hash.add(v.y);
    for (const double o : env_.observations().subspan(e * length, length)) hash.add(o);
    hash.add(env_.rewards()[e]);
    hash.add(std::uint64_t{env_.terminated()[e]} << 1U | env_.truncated()[e]);
  }

  const Arena& arena_;
  std::uint64_t first_chain_;
  VecEnv env_;
  std::vector<Hash> hashes_;
  std::vector<std::uint64_t> episodes_;
  std::vector<Stream> random_;
};

struct Hashes {
  std::uint64_t after_quick = 0;
  std::uint64_t after_whole = 0;
};

// After `quick` steps, and after `whole` ones if so many are asked for.
inline Hashes run(TaskSpec task, int width, int threads, int steps) {
  const Body body = Body::from_rows({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"});
  const Arena arena(std::move(task), body);
  ThreadPool pool(threads);
  Hash after_quick;
  Hash after_whole;
  for (int first = 0; first < chains; first += width) {
    Runner runner(arena, first, width);
    const int members = std::min(width, chains);
    for (int step = 1; step <= steps; ++step) {
      runner.step(pool);
      Hash* const hash = step == quick ? &after_quick : step == whole ? &after_whole : nullptr;
      for (int i = 0; hash && i < members; ++i) hash->add(runner.hash(i));
    }
  }
  return {after_quick.value(), steps >= whole ? after_whole.value() : 0};
}

}  // namespace evo::pinned
