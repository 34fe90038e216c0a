// evo: one name for the suite. `evo train ARGUMENTS` becomes evo-train, which is looked for
// beside this program and then in PATH, so that a tool of one's own is a command, too.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/data.h"
#include "cli/process.h"
#include "cli/tools.h"
#include "formats/io/values.h"
#include "libevo/base/error.h"
#include "libevo/sim/isa.h"

namespace {

using namespace evo;
namespace fs = std::filesystem;

void print_help() {
  fmt::print(
      "evo - co-design of soft robots: bodies and controllers evolved together\n\n"
      "Usage: evo COMMAND [ARGUMENT]...\n\n"
      "  Each command is a tool of its own: `evo train` and `evo-train` are the same.\n");
  for (const cli::Chapter& chapter : cli::chapters()) {
    fmt::print("\n{}:\n", chapter.title);
    for (const cli::Tool& tool : chapter.tools) fmt::print("  {:<10}{}\n", tool.name, tool.purpose);
  }
  fmt::print(
      "\nHelp:\n"
      "  help COMMAND, COMMAND --help   what a command does, and its options\n"
      "  --version                      version, commit, instruction set\n"
      "\nExamples:\n"
      "  # how far a travelling wave carries random robots; the best five\n"
      "  evo sample -n 100 | evo eval --task Walker-v0 --actions sine:0.5,20,0.7 |\n"
      "    evo select --keep 5\n"
      "  # a whole evolution, over the same tools\n"
      "  evo evolve ga --run runs/walker --task Walker-v0 -j8\n"
      "\nExit status: that of the command; 2 for one that does not exist.\n");
}

// Where evo-COMMAND is: beside this program, else in PATH; empty where it is nowhere.
fs::path tool_of(const std::string& command) {
  std::error_code unknown;
  std::vector<fs::path> folders{cli::own_folder()};
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split_list(path == nullptr ? "" : path, ':'))
    folders.emplace_back(folder);
  for (const fs::path& folder : folders) {
    const fs::path tool = folder / ("evo-" + command);
    if (fs::is_regular_file(tool, unknown) && ::access(tool.c_str(), X_OK) == 0) return tool;
  }
  return {};
}

std::vector<std::string> command_names() {
  std::vector<std::string> names{"help"};
  for (const cli::Chapter& chapter : cli::chapters())
    for (const cli::Tool& tool : chapter.tools) names.push_back(tool.name);
  return names;
}

// This process becomes the tool: signals, standard streams and exit status are the tool's.
[[noreturn]] void become(const std::string& command, std::vector<std::string> arguments) {
  const bool is_name = command.find('/') == std::string::npos && !command.empty();
  const fs::path tool = is_name ? tool_of(command) : fs::path();
  if (tool.empty())
    throw error(Failure::usage, "'{}' is not a command{}; see evo help", command,
                did_you_mean(command, command_names()));
  arguments.insert(arguments.begin(), tool.string());
  ::execv(tool.c_str(), cli::pointers(arguments).data());
  throw error(Failure::io, "{} cannot be started: {}", tool.string(), std::strerror(errno));
}

int answer(const std::vector<std::string>& words) {
  const std::string first = words.empty() ? "help" : words[0];
  if (first == "--version") {
    fmt::print("{} {}\n", cli::created_by("evo"), best_isa());
    return 0;
  }
  const bool helps = first == "help" || first == "--help" || first == "-h";
  if (helps && words.size() > 1) become(words[1], {"--help"});
  if (!helps) become(first, {words.begin() + 1, words.end()});
  print_help();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return cli::run_as("evo", [&] { return answer({argv + 1, argv + argc}); });
}
