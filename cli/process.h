// Other programs, run from this one.
#pragma once

#include <string>
#include <vector>

namespace evo::cli {

struct Ended {
  int status = 0;      // as of a shell: 128 + the signal that ended it
  std::string output;  // standard output
};

// The program, found in PATH, with this text as its standard input. It does not outlive this
// process, and is ended where this one is interrupted. Throws Error(io).
Ended run_program(std::vector<std::string> words, const std::string& input);

// The words as execvp takes them, valid as long as they are.
std::vector<char*> pointers(std::vector<std::string>& words);

}  // namespace evo::cli
