#include "evolution/breeding.h"

#include <utility>

#include "formats/io/files.h"
#include "formats/robot/genome.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

// As documents name where a robot comes from.
const char* tool_of(MadeBy made_by) {
  switch (made_by) {
    case MadeBy::sampling:
      return "evo-sample";
    case MadeBy::mutation:
      return "evo-mutate";
    case MadeBy::neat:
      return "evo-neat";
    case MadeBy::suggestion:
      return "evo-suggest";
  }
  return "";
}

}  // namespace

void check(const Breeding& breeding) {
  const MutationSettings& mutation = breeding.mutation;
  for (const auto& [name, p] :
       {std::pair{"--rate", mutation.rate}, std::pair{"--crossover", breeding.crossover}})
    if (!(p >= 0.0 && p <= 1.0))
      throw error(Failure::usage, "{} must be between 0 and 1, got {}", name, p);
  if (mutation.attempts < 1)
    throw error(Failure::usage, "--attempts must be at least 1, got {}", mutation.attempts);
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

Robot robot_of(Proposal proposal, std::uint64_t seed, int index) {
  Robot robot = make_child(std::move(proposal.body), proposal.parents, tool_of(proposal.made_by),
                           seed, static_cast<std::uint64_t>(index));
  if (proposal.genome) robot.document["genome"] = genome_to_json(*proposal.genome);
  return robot;
}

}  // namespace evo
