// The settings of a run. What is accepted is written and read again as it was.
#include "formats/run/run.h"

#include "target.h"

using namespace evo;

FUZZ_TARGET(text) {
  const RunSettings settings = RunSettings::parse(text, "input");
  expect(RunSettings::parse(settings.to_yaml(), "written").list() == settings.list());
}
