#include "evolution/breeding.h"

#include "formats/io/files.h"
#include "formats/robot/genome.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

constexpr int max_draws = 10'000;  // of one robot, before giving up on a new body

// The child of one parent, or of two with the chance of crossover; parents is
// filled with those it came from.
std::optional<Body> child_body(const std::vector<Robot>& robots, const Breeding& breeding,
                               Stream& stream, std::vector<const Robot*>& parents) {
  const auto draw_parent = [&]() -> const Robot& {
    return robots[stream.below(static_cast<std::uint32_t>(robots.size()))];
  };
  parents = {&draw_parent()};
  if (breeding.crossover <= 0.0 || stream.uniform() >= breeding.crossover)
    return mutate(parents[0]->body, breeding.mutation, stream);
  parents.push_back(&draw_parent());
  const Body& a = parents[0]->body;
  const Body& b = parents[1]->body;
  if (a.rows != b.rows || a.cols != b.cols) return std::nullopt;
  const std::optional<Body> mixed = crossover(a, b, breeding.mutation.attempts, stream);
  return mixed ? mutate(*mixed, breeding.mutation, stream) : std::nullopt;
}

}  // namespace

void Breeding::check() const {
  for (const auto& [name, p] :
       {std::pair{"--rate", mutation.rate}, std::pair{"--crossover", crossover}})
    if (!(p >= 0.0 && p <= 1.0))
      throw error(Failure::usage, "{} must be between 0 and 1, got {}", name, p);
  if (mutation.attempts < 1)
    throw error(Failure::usage, "--attempts must be at least 1, got {}", mutation.attempts);
}

Robot sample_robot(const Shape& shape, const VoxelWeights& weights, std::uint64_t seed, int index,
                   std::set<std::string>& seen) {
  Stream stream(seed, "sample", static_cast<std::uint64_t>(index));
  for (int draw = 0; draw < max_draws; ++draw) {
    Robot robot = make_child(sample_body(shape.rows, shape.cols, weights, stream), {}, "evo-sample",
                             seed, static_cast<std::uint64_t>(index));
    if (seen.insert(robot.id).second) return robot;
  }
  throw error(Failure::work,
              "no new {}x{} body for robot {} in {} draws; ask for fewer robots or a larger shape",
              shape.rows, shape.cols, index, max_draws);
}

Robot breed_robot(const std::vector<Robot>& parents, const Breeding& breeding, std::uint64_t seed,
                  int index, std::set<std::string>& seen) {
  Stream stream(seed, "mutate", static_cast<std::uint64_t>(index));
  std::vector<const Robot*> chosen;
  for (int draw = 0; draw < max_draws; ++draw) {
    std::optional<Body> body = child_body(parents, breeding, stream, chosen);
    if (!body) continue;
    std::vector<std::string> ids;
    ids.reserve(chosen.size());
    for (const Robot* parent : chosen) ids.push_back(parent->id);
    Robot child =
        make_child(std::move(*body), ids, "evo-mutate", seed, static_cast<std::uint64_t>(index));
    if (seen.insert(child.id).second) return child;
  }
  throw error(Failure::work,
              "no new body for child {} in {} draws of a parent; raise --rate or --attempts", index,
              max_draws);
}

NeatSettings neat_settings(const std::optional<std::string>& file, std::optional<int> count,
                           const DataFolders& folders) {
  NeatSettings settings;
  if (file) {
    settings = load_neat_settings(*file);
    if (!settings.no_fitness_termination)
      throw error(Failure::data,
                  "{}: no_fitness_termination is false, but runs end by their number of robots; "
                  "set it to true",
                  input_label(*file));
  } else if (const auto found = find_data_file(folders, "", "neat")) {
    settings = load_neat_settings(found->string());
  }
  if (count || !file) settings.pop_size = count.value_or(default_population);
  return settings;
}

Robot cppn_robot(const CppnRobot& made, const std::vector<std::string>& parents, std::uint64_t seed,
                 int index) {
  Robot robot = make_child(made.body, parents, "evo-neat", seed, static_cast<std::uint64_t>(index));
  robot.document["genome"] = genome_to_json(made.genome);
  return robot;
}

}  // namespace evo
