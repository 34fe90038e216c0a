// What every tool shares: options, help, version, messages (log.h), exit statuses
// (docs/tools.md). A tool describes itself to a Command, which is over CLI11, and hands over
// its work; main() is then one call.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/log.h"
#include "cli/progress.h"
#include "libevo/base/error.h"
#include "libevo/base/parallel.h"

namespace CLI {
class Option;
}

namespace evo::cli {

// An option that was declared: what its value may be and what it goes with. Wrong values and
// combinations end in one line and status 2.
class Option {
 public:
  using Words = std::function<std::vector<std::string>()>;
  Option(CLI::Option* option, std::map<std::string, Words>* completions)
      : option_(option), completions_(completions) {}

  Option& required();
  Option& at_least(double low);
  Option& between(double low, double high);
  Option& one_of(const std::vector<std::string>& words);
  Option& needs(const Option& other);
  Option& excludes(const std::vector<Option>& others);

 private:
  CLI::Option* option_;
  std::map<std::string, Words>* completions_;
};

// What the text of an option's value means: a std::string, int, std::uint64_t or double. An empty
// text is an unset shell variable, and never meant. Throws Error(usage).
template <typename T>
T option_value(const std::string& text, const std::string& names);

class Command {
 public:
  explicit Command(const std::string& executable);  // one of cli/tools.h
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  // A command within the tool, "evo-tool NAME", with an argument and options of its own; those of
  // the tool hold for all. At most one is given.
  Command& subcommand(const std::string& name, const std::string& purpose);
  bool given() const;                    // this is the subcommand that was
  std::string subcommand_given() const;  // its name, or nothing

  // An option that takes a value: `names` is "-n,--count" or "--rate", `value` the word for
  // it in the help. T is std::string, int, std::uint64_t or double: what the target holds is
  // the default. Or std::optional of one of them, which has none, or a vector of strings:
  // the option may be repeated. Given twice otherwise, the last one counts.
  template <typename T>
  Option option(const std::string& names, T& target, const std::string& value,
                const std::string& help) {
    return add(names, value, help, fmt::format("{}", target), setter<T>(names, target));
  }
  template <typename T>
  Option option(const std::string& names, std::optional<T>& target, const std::string& value,
                const std::string& help) {
    return add(names, value, help, "", setter<T>(names, target));
  }
  Option option(const std::string& names, std::vector<std::string>& target,
                const std::string& value, const std::string& help);
  Option flag(const std::string& names, bool& target, const std::string& help);
  // An option whose value is one of some words, each of which stands for a value of the target.
  template <typename T>
  Option choice(const std::string& names, T& target, const std::string& value,
                const std::vector<std::pair<std::string, T>>& words, const std::string& help) {
    std::vector<std::string> allowed;
    std::string initial;
    for (const auto& [word, meaning] : words) {
      allowed.push_back(word);
      if (meaning == target) initial = word;
    }
    const auto set = [&target, words](const std::vector<std::string>& texts) {
      for (const auto& [word, meaning] : words)
        if (word == texts.back()) target = meaning;
    };
    return add(names, value, help, initial, set).one_of(allowed);
  }
  // The next option begins a group with this title in the help.
  void section(const std::string& title);

  // Arguments that are not options: any number of one kind, or the forms that a
  // usage line such as "COMMAND RUN" stands for.
  void arguments(std::vector<std::string>& target, const std::string& value,
                 const std::string& help);
  struct Form {
    std::string words;
    std::string help;
  };
  void arguments(std::vector<std::string>& target, const std::string& usage,
                 const std::vector<Form>& forms);
  // One argument that may be left out.
  void argument(std::string& target, const std::string& value);
  // Words that the value of an option, or what follows an argument, may be among others,
  // for the shell to complete.
  void suggestions(const std::string& long_name, const Option::Words& words);
  // Refuses options that were given where they mean nothing: `where` says what they go with.
  // Throws Error(usage).
  void only(bool applies, const std::vector<std::string>& long_names,
            const std::string& where) const;

  void example(const std::string& command, const std::string& what);

  // Options with the same name and meaning in every tool that has them.
  void seed_option();
  void jobs_option();
  void output_option(const std::string& what);
  void progress_option();

  std::uint64_t seed = 0;
  int jobs = 1;              // threads; resolved when the work starts
  std::string output = "-";  // "-" is standard output
  std::string progress = "auto";
  Progress progress_style() const;  // on standard error
  bool quiet = false;               // nothing but errors is said
  bool verbose = false;             // all is

  const std::string& name() const;

  // Parses, then runs `work`, whose value is the exit status. Every Error ends
  // here, as one line on standard error and its kind as exit status.
  int run(int argc, char** argv, const std::function<int()>& work);

 private:
  struct Impl;
  explicit Command(std::unique_ptr<Impl> impl);

  using Set = std::function<void(const std::vector<std::string>&)>;
  // The last text that was given, as what it means.
  template <typename T, typename Target>
  static Set setter(const std::string& names, Target& target) {
    return [names, &target](const std::vector<std::string>& texts) {
      target = option_value<T>(texts.back(), names);
    };
  }
  Option add(const std::string& names, const std::string& value, const std::string& help,
             const std::string& initial, const Set& set);
  void common_options();
  int answer(int argc, char** argv, const std::function<int()>& work);

  std::unique_ptr<Impl> impl_;
};

// Threads for this many tasks, -j at most; a word where the system has fewer.
class Workers {
 public:
  Workers(const Command& command, std::size_t tasks);
  ThreadPool pool;
};

// The value of `work` as the exit status of a program that is no Command; failures end as
// in Command::run. `memory_advice` is what to do when there is too little of it.
int run_as(const std::string& executable, const std::function<int()>& work,
           const std::function<std::string()>& memory_advice = {});

// "evo 0.1.0 (105ad79)", with the commit of the build; goes into the files the tools write.
std::string created_by(const std::string& tool);

// Set by SIGINT, SIGTERM and SIGHUP after catch_interrupts(); 0, or the signal. One
// that comes over a second later ends the process at once.
void catch_interrupts();
int interrupted();

}  // namespace evo::cli
