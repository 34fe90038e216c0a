// evo-inspect --check: whether files are what they say.
#pragma once

#include <string>
#include <vector>

namespace evo::cli {

// Reads each file, or every file in a folder, whole: structure, ids and checksums;
// that a scored robot's policy is there, is its own and earned its fitness; with
// `replay` also that it earns it again, to the last bit. Prints a line a file. Throws
// Error(data) at the end when any was refused, Error(no_input) for a missing one.
void check_paths(const std::vector<std::string>& paths, bool replay);

}  // namespace evo::cli
