// The options that say how children are made; a run keeps them as mutate_options.
#pragma once

#include "cli/command.h"
#include "formats/robot/children.h"

namespace evo::cli {

// --rate, --attempts and --crossover.
void add_breeding_options(Command& command, Breeding& breeding);

}  // namespace evo::cli
