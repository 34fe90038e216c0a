// What decides the fitness of a run's robots, as a digest: another one, between two commands of
// a run, would mix two fitness functions in one history.
#pragma once

#include "formats/run/run.h"

namespace evo::cli {

// Sources are the text that a task resolves to; for FILE.py:CLASS the file and what it imports from
// beside it; for a program the first word of --evaluate that is a file; and the files of
// --physics, --train, --mutate and --propose. Throws what a damaged task throws.
void set_source(RunSettings& settings);

// Throws Error(cannot_create) where it is another one than when the run began. A file that has
// gone is not looked for: whatever needs it says so. `where` begins the message.
void check_source(const RunSettings& settings, const std::string& where);

}  // namespace evo::cli
