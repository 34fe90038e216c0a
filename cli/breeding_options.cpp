#include "cli/breeding_options.h"

namespace evo::cli {

void add_breeding_options(Command& command, Breeding& breeding) {
  command.option("--rate", breeding.mutation.rate, "P", "chance of each voxel to be redrawn");
  command.option("--attempts", breeding.mutation.attempts, "N",
                 "tries to reach a valid body, each going on from the one before");
  command.option("--crossover", breeding.crossover, "P",
                 "chance of a child to mix two parents before it is mutated");
}

}  // namespace evo::cli
