// States of NEAT; what is accepted is written and read again as it was.
#include "formats/run/neat.h"
#include "target.h"

using namespace evo;

FUZZ_TARGET(text) {
  const std::string written = neat_state_to_text(parse_neat_state(text, "input"));
  expect(neat_state_to_text(parse_neat_state(written, "written")) == written);
}
