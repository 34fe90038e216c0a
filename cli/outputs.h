// Files that one command writes, and that they do not destroy each other.
#pragma once

#include <string>
#include <vector>

namespace evo::cli {

struct FileName {
  std::string option;  // or what it is: "--output", "the policy of robot 3f9c02d41b7a"
  std::string path;
};

// Throws Error(usage) when two outputs name the same file, or one names an input that is
// to stay. Standard streams and files that are not regular, such as /dev/null, may be named
// often.
void check_outputs(const std::vector<FileName>& outputs, const std::vector<FileName>& inputs = {});

// Throws Error(usage) when --output names one of the files that it is made of.
void keep_inputs(const std::string& output, const std::vector<std::string>& files);

}  // namespace evo::cli
