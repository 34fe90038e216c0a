// Files that one command writes, and that they do not destroy each other.
#pragma once

#include <string>
#include <vector>

namespace evo::cli {

struct OutputName {
  std::string option;  // or what writes it: "--output", "the policy of robot 3f9c02d41b7a"
  std::string path;
};

// Throws Error(usage) when two name the same file. Standard output and what is no
// regular file, such as /dev/null, may be named often.
void check_outputs(const std::vector<OutputName>& outputs);

}  // namespace evo::cli
