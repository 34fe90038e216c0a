// Structures in .npz; what is accepted is written and read again as it was.
#include "formats/foreign/npz.h"

#include "target.h"

using namespace evo;

FUZZ_TARGET(bytes) {
  const Body body = body_from_npz(std::string(bytes), "input");
  expect(body_from_npz(body_to_npz(body), "written") == body);
}
