// The one exception type of the project: what went wrong, in words for a user,
// and what kind of failure it is. cli/ turns it into one line on standard error
// and an exit status; nothing else catches it except to add context.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace evo {

// The values are the exit statuses of the tools (docs/tools.md, "Exit status").
enum class Failure : int {
  work = 1,            // the work itself failed
  usage = 2,           // an unknown option, task, physics key or value
  data = 65,           // input that was read but makes no sense
  no_input = 66,       // an input file is missing
  cannot_create = 73,  // an output cannot be created, or belongs to other settings
  io = 74,             // reading or writing failed halfway
};

class Error : public std::runtime_error {
 public:
  Error(Failure kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}

  Failure kind() const { return kind_; }

  // The same failure, said with where it happened: "<where>: <message>".
  Error at(const std::string& where) const { return {kind_, where + ": " + what()}; }

 private:
  Failure kind_;
};

// error(Failure::data, "row {} has {} cells", 3, 4)
template <typename... Args>
Error error(Failure kind, fmt::format_string<Args...> format, Args&&... args) {
  return {kind, fmt::format(format, std::forward<Args>(args)...)};
}

// The candidate nearest to a misspelt word (Damerau-Levenshtein, case folded; its beginning
// counts as one slip), or an empty string when none is close enough to be worth suggesting.
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);

// " (did you mean 'X'?)" for the nearest candidate, or "".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace evo
