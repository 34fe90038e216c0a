// evo-sample: random valid robots.
#include <algorithm>

#include "cli/command.h"
#include "cli/robots.h"
#include "formats/io/values.h"
#include "formats/robot/children.h"
#include "formats/robot/writer.h"
#include "libevo/evolve/cppn_neat.h"

namespace {

using namespace evo;

VoxelWeights parse_weights(const std::string& text) {
  const std::vector<double> numbers = parse_numbers(text, "--weights");
  VoxelWeights weights{};
  if (numbers.size() != weights.size())
    throw error(Failure::usage,
                "--weights: expected {} numbers (empty, rigid, soft, horizontal, vertical), got {}",
                weights.size(), numbers.size());
  std::copy(numbers.begin(), numbers.end(), weights.begin());
  return weights;
}

// Bodies painted by random networks, ready for evo-neat's genomes.
void sample_cppn(const Shape& shape, int count, std::uint64_t seed, std::set<std::string>& seen,
                 RobotWriter& out) {
  NeatSettings settings;
  settings.pop_size = std::max(count, 2);  // NEAT's least
  NeatState state;
  int index = 0;
  for (const CppnRobot& made : first_robots(settings, shape.rows, shape.cols, seen, state, seed)) {
    if (index == count) break;
    out.write(robot_of({made.body, "evo-sample", {}, made.genome}, seed, index));
    ++index;
  }
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-sample");
  int count = 25;
  std::string shape_text = "5x5";
  std::string weights_text = "0.6,0.2,0.2,0.2,0.2";
  bool painted = false;
  std::vector<std::string> avoid;
  command.option("-n,--count", count, "N", "how many, no two alike").at_least(0);
  command.option("--shape", shape_text, "ROWSxCOLS", "size of the body's matrix, in voxels");
  command.option("--weights", weights_text, "E,R,S,H,V",
                 "relative weights of empty, rigid, soft, horizontal and vertical voxels");
  command.choice(
      "--encoding", painted, "NAME", {{"voxel", false}, {"cppn", true}},
      "voxel: every cell drawn; cppn: painted by a random network, whose genome is kept");
  command.option("--avoid", avoid, "FILE", "robots or ids that must not come again (repeatable)");
  command.seed_option();
  command.output_option("where the robots go, one JSON document per line");
  command.example("evo-sample -n 5 --seed 1 | jq -r '.body[]'", "five robots, drawn as text");
  command.example("evo-sample -n 25 --shape 5x7 --seed 2 -o population.jsonl",
                  "a first population for Lifter-v0");

  return command.run(argc, argv, [&] {
    const Shape shape = parse_shape(shape_text);
    const VoxelWeights weights = parse_weights(weights_text);
    command.only(!painted, {"--weights"}, "--encoding voxel");
    std::set<std::string> seen = cli::read_ids(avoid);
    RobotWriter out(command.output);
    if (painted) {
      sample_cppn(shape, count, command.seed, seen, out);
      count = 0;
    }
    // Output k comes from the stream of its own number, so that -n 10 prints the
    // first ten lines of -n 100.
    for (int i = 0; i < count; ++i)
      out.write(robot_of({sample_new(shape.rows, shape.cols, weights, command.seed, i, seen)},
                         command.seed, i));
    out.finish();
    return 0;
  });
}
