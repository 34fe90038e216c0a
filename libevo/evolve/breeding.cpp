#include "libevo/evolve/breeding.h"

#include <optional>
#include <utility>

#include "libevo/base/error.h"

namespace evo {
namespace {

constexpr int max_draws = 10'000;  // of one robot, before giving up on a new body

// The child of one parent, or of two with the chance of crossover.
std::optional<Child> try_child(std::span<const Body> bodies, const Breeding& breeding,
                               Stream& stream) {
  const auto draw_parent = [&]() -> std::size_t {
    return stream.below(static_cast<std::uint32_t>(bodies.size()));
  };
  Child child;
  child.parents = {draw_parent()};
  const Body& a = bodies[child.parents[0]];
  std::optional<Body> body;
  if (breeding.crossover <= 0.0 || stream.uniform() >= breeding.crossover) {
    body = mutate(a, breeding.mutation, stream);
  } else {
    child.parents.push_back(draw_parent());
    const Body& b = bodies[child.parents[1]];
    if (a.rows != b.rows || a.cols != b.cols) return std::nullopt;
    const std::optional<Body> mixed = crossover(a, b, breeding.mutation.attempts, stream);
    if (mixed) body = mutate(*mixed, breeding.mutation, stream);
  }
  if (!body) return std::nullopt;
  child.body = *std::move(body);
  return child;
}

}  // namespace

Body sample_new(int rows, int cols, const VoxelWeights& weights, std::uint64_t seed, int index,
                std::set<std::string>& seen) {
  Stream stream(seed, "sample", static_cast<std::uint64_t>(index));
  for (int draw = 0; draw < max_draws; ++draw) {
    Body body = sample_body(rows, cols, weights, stream);
    if (seen.insert(identity(body)).second) return body;
  }
  throw error(Failure::work,
              "no new {}x{} body for robot {} in {} draws; ask for fewer robots or a larger shape",
              rows, cols, index, max_draws);
}

Child breed_new(std::span<const Body> parents, const Breeding& breeding, std::uint64_t seed,
                int index, std::set<std::string>& seen) {
  Stream stream(seed, "mutate", static_cast<std::uint64_t>(index));
  for (int draw = 0; draw < max_draws; ++draw)
    if (auto child = try_child(parents, breeding, stream);
        child && seen.insert(identity(child->body)).second)
      return *std::move(child);
  throw error(Failure::work,
              "no new body for child {} in {} draws of a parent; raise --rate or --attempts", index,
              max_draws);
}

}  // namespace evo
