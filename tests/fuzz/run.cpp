// What a run folder keeps: its settings, and the state of one without generations. What
// is accepted is written and read again as it was.
#include "formats/run/run.h"

#include "formats/run/steady.h"
#include "target.h"

using namespace evo;

FUZZ_TARGET(text) {
  if (text.starts_with('{')) {
    const std::string written = steady_state_to_text(parse_steady_state(text, "input"));
    expect(steady_state_to_text(parse_steady_state(written, "written")) == written);
  } else {
    const RunSettings settings = RunSettings::parse(text, "input");
    expect(RunSettings::parse(settings.to_yaml(), "written").list() == settings.list());
  }
}
