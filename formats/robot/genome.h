// The `genome` field of a robot document, to and from evo::Genome (docs/formats/robot.md). All
// fields of a gene are written and needed.
#pragma once

#include <optional>
#include <string>

#include "formats/robot/robot.h"
#include "libevo/evolve/genome.h"

namespace evo {

Json genome_to_json(const Genome& genome);

// Genes in any order; unknown fields are accepted. Throws Error(data) for anything that is
// missing, of the wrong type, there twice, or no feed-forward network with the inputs and
// outputs of a robot's.
Genome read_genome(const Node& genome);

// The genome of a robot, or nothing if it has none. `where` begins the message
// of the Error(data).
std::optional<Genome> genome_of(const Robot& robot, const std::string& where);

}  // namespace evo
