// Worlds of the design tool; what is accepted is written and read again as it was.
#include "formats/foreign/evogym.h"
#include "target.h"

using namespace evo;

FUZZ_TARGET(text) {
  const World world = evogym_world_from_json(parse_json(text, "input"), "input");
  const World again =
      evogym_world_from_json(parse_json(evogym_world_to_json(world), "written"), "written");
  expect(again.objects.size() == world.objects.size());
  for (std::size_t i = 0; i < world.objects.size(); ++i)
    expect(again.objects[i].body == world.objects[i].body);
}
