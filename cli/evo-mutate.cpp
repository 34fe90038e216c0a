// evo-mutate: children of the robots read.
#include <set>

#include "cli/command.h"
#include "cli/robots.h"
#include "libevo/base/random.h"
#include "libevo/body/operators.h"

namespace {

using namespace evo;

constexpr int max_draws = 10'000;  // of parents for one child

struct Settings {
  MutationSettings mutation;
  double crossover = 0.0;
};

// The child of one parent, or of two with the chance of crossover; parents is
// filled with those it came from.
std::optional<Body> make_body(const std::vector<Robot>& robots, const Settings& settings,
                              Stream& stream, std::vector<const Robot*>& parents) {
  const auto draw_parent = [&]() -> const Robot& {
    return robots[stream.below(static_cast<std::uint32_t>(robots.size()))];
  };
  parents = {&draw_parent()};
  if (settings.crossover <= 0.0 || stream.uniform() >= settings.crossover)
    return mutate(parents[0]->body, settings.mutation, stream);
  parents.push_back(&draw_parent());
  const Body& a = parents[0]->body;
  const Body& b = parents[1]->body;
  if (a.rows != b.rows || a.cols != b.cols) return std::nullopt;
  const std::optional<Body> mixed = crossover(a, b, settings.mutation.attempts, stream);
  return mixed ? mutate(*mixed, settings.mutation, stream) : std::nullopt;
}

Robot new_child(const std::vector<Robot>& robots, const Settings& settings, std::uint64_t seed,
                int index, std::set<std::string>& seen) {
  Stream stream(seed, "mutate", static_cast<std::uint64_t>(index));
  std::vector<const Robot*> parents;
  for (int draw = 0; draw < max_draws; ++draw) {
    std::optional<Body> body = make_body(robots, settings, stream, parents);
    if (!body) continue;
    std::vector<std::string> ids;
    ids.reserve(parents.size());
    for (const Robot* parent : parents) ids.push_back(parent->id);
    Robot child =
        make_child(std::move(*body), ids, "evo-mutate", seed, static_cast<std::uint64_t>(index));
    if (!seen.insert(child.id).second) continue;
    return child;
  }
  throw error(Failure::work,
              "no new body for child {} in {} draws of a parent; raise --rate or --attempts", index,
              max_draws);
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-mutate", "children of the robots read");
  Settings settings;
  std::optional<int> count;
  std::vector<std::string> avoid;
  std::vector<std::string> files;
  command.arguments(files, "FILE", "robots (JSON, JSON Lines, YAML, letters) [standard input]");
  command.option("-n,--count", count, "N", "children to make [as many as robots read]");
  command.option("--rate", settings.mutation.rate, "P", "chance of each voxel to be redrawn");
  command.option("--attempts", settings.mutation.attempts, "N",
                 "tries to reach a valid body, each going on from the one before");
  command.option("--crossover", settings.crossover, "P",
                 "chance of a child to mix two parents before it is mutated");
  command.option("--avoid", avoid, "FILE", "robots that must not come again (repeatable)");
  command.seed_option();
  command.output_option("where the children go, one JSON document per line");
  command.example("evo-sample -n 10 | evo-mutate -n 50 --seed 4", "fifty children of ten robots");
  command.example("evo-mutate best.json -n 3 --avoid history.jsonl",
                  "three bodies near the best that were never tried");

  return command.run(argc, argv, [&] {
    if (count.value_or(0) < 0)
      throw error(Failure::usage, "--count must not be negative, got {}", *count);
    for (const auto& [name, p] : {std::pair{"--rate", settings.mutation.rate},
                                  std::pair{"--crossover", settings.crossover}})
      if (!(p >= 0.0 && p <= 1.0))
        throw error(Failure::usage, "{} must be between 0 and 1, got {}", name, p);
    if (settings.mutation.attempts < 1)
      throw error(Failure::usage, "--attempts must be at least 1, got {}",
                  settings.mutation.attempts);
    const std::vector<Robot> robots = cli::read_robots(files);
    const int children = count.value_or(static_cast<int>(robots.size()));
    if (robots.empty() && children > 0)
      throw error(Failure::data, "no robots to make children of; pipe some in or name a file");
    std::set<std::string> seen = cli::read_ids(avoid);
    for (const Robot& robot : robots) seen.insert(robot.id);
    cli::RobotWriter out(command.output);
    for (int i = 0; i < children; ++i)
      out.write(new_child(robots, settings, command.seed, i, seen));
    out.finish();
    return 0;
  });
}
