// The Makefile of a run: plain rules by file name over the tools, one generation after the
// other, as a person would write them. A proposer is a filter: scored robots and a state in,
// new robots and a state out, each a file. With generations a population waits for the scores
// of the one before; with a window it waits for those of robots long before it. That is all
// the difference.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/run/run.h"

namespace evo::cli {

// Robots that a run begins with.
struct Founders {
  std::string robots;    // their file
  bool scored = false;   // the best of them are taken, else all
  std::string policies;  // a policy or a folder of such, to continue from; "" where there is none
};

// What the Makefile says of this machine.
struct Surroundings {
  std::string tools;   // the folder of the tools; "" where PATH has them
  std::string here;    // where programs of one's own are started
  std::string python;  // a command line: Python with the package evo_robots
  std::optional<Founders> founders;
};

// Throws Error(usage) for settings that do not go together.
std::string run_makefile(const RunSettings& settings, const Surroundings& around);

// Whether a task is a class in Python, FILE.py:CLASS.
bool is_python_task(const std::string& task);

// Command lines that try the options which a run hands on to tools, without making anything.
struct Trial {
  std::vector<std::string> words;
  std::string input;  // standard input
};
std::vector<Trial> trials(const RunSettings& settings, const Surroundings& around);

// Words of a line as a shell splits them, without expansions. Throws Error(usage) for a quote
// that is not closed; `where` begins the message.
std::vector<std::string> option_words(const std::string& line, const std::string& where);

// A word for a recipe of make: quoted for the shell, and for make, to which a dollar is "$$"
// and # is in a variable ("hash").
std::string make_word(const std::string& text);

}  // namespace evo::cli
