// Worlds of the design tool; what is accepted is written and read again as it was.
#include "formats/robot/evogym.h"
#include "target.h"

using namespace evo;

FUZZ_TARGET(text) {
  const World world = read_evogym_world(Node::json(text, "input"));
  const World again = read_evogym_world(Node::json(evogym_world_to_json(world), "written"));
  expect(again.objects.size() == world.objects.size());
  for (std::size_t i = 0; i < world.objects.size(); ++i)
    expect(again.objects[i].body == world.objects[i].body);
}
