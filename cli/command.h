// What every tool shares: options, help, version, configuration file, logging,
// exit statuses (docs/tools.md). A tool describes
// itself to a Command and hands over its work; main() is then one call.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/progress.h"
#include "libevo/base/error.h"
#include "libevo/base/parallel.h"

namespace evo::cli {

constexpr int most_threads = 1024;

class Command {
 public:
  explicit Command(const std::string& executable);  // one of cli/tools.h
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  // An option that takes a value: `names` is "-n,--count" or "--rate", `value`
  // the word for it in the help. The value held by the target is the default;
  // an option for std::optional has none, one for a vector may be repeated.
  void option(const std::string& names, std::string& target, const std::string& value,
              const std::string& help);
  void option(const std::string& names, int& target, const std::string& value,
              const std::string& help);
  void option(const std::string& names, std::uint64_t& target, const std::string& value,
              const std::string& help);
  void option(const std::string& names, double& target, const std::string& value,
              const std::string& help);
  void option(const std::string& names, std::optional<std::string>& target,
              const std::string& value, const std::string& help);
  void option(const std::string& names, std::optional<int>& target, const std::string& value,
              const std::string& help);
  void option(const std::string& names, std::optional<double>& target, const std::string& value,
              const std::string& help);
  void option(const std::string& names, std::vector<std::string>& target, const std::string& value,
              const std::string& help);
  void flag(const std::string& names, bool& target, const std::string& help);
  // An option whose value is one of some words, each of which stands for a value of the
  // target; another word is refused with the nearest of them.
  template <typename T>
  void choice(const std::string& names, T& target, const std::string& value,
              const std::vector<std::pair<std::string, T>>& words, const std::string& help) {
    std::vector<std::string> allowed;
    std::string initial;
    for (const auto& [word, meaning] : words) {
      allowed.push_back(word);
      if (meaning == target) initial = word;
    }
    add_choice(names, value, help, initial, allowed, [&target, words](const std::string& chosen) {
      for (const auto& [word, meaning] : words)
        if (word == chosen) target = meaning;
    });
  }
  // Words that an option may have as its value among others, or a command among its
  // arguments, for the shell to complete.
  void suggestions(const std::string& long_name,
                   const std::function<std::vector<std::string>()>& words);
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
  void require(const std::string& long_name);  // the option must be given
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
  bool quiet = false;
  bool verbose = false;

  const std::string& name() const;

  // A line on standard error; `detail` only with -v, `note` and `warn` not with -q.
  void detail(const std::string& text) const;
  void note(const std::string& text) const;
  void warn(const std::string& text) const;

  // Options kept elsewhere than on a command line. Throws Error(usage).
  void parse(std::vector<std::string> words);

  // Parses, then runs `work`, whose value is the exit status. Every Error ends
  // here, as one line on standard error and its kind as exit status.
  int run(int argc, char** argv, const std::function<int()>& work);

 private:
  void add_choice(const std::string& names, const std::string& value, const std::string& help,
                  const std::string& initial, const std::vector<std::string>& words,
                  const std::function<void(const std::string&)>& choose);
  int answer(int argc, char** argv, const std::function<int()>& work);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Threads for this many tasks, -j at most; a word where the system has fewer.
class Workers {
 public:
  Workers(const Command& command, std::size_t tasks);
  ThreadPool pool;
};

// As Command::note and Command::detail, from parts of a tool that know no Command.
void say_note(const std::string& text);
void say_detail(const std::string& text);

// The value of `work` as the exit status of a program that is no Command; failures end as
// in Command::run. `memory_advice` is what to do when there is too little of it.
int run_as(const std::string& executable, const std::function<int()>& work,
           const std::function<std::string()>& memory_advice = {});

// "evo 0.1.0 (105ad79)", with the commit of the build; goes into the files the tools write.
std::string created_by(const std::string& tool);
std::string version();

// Set by SIGINT, SIGTERM and SIGHUP after catch_interrupts(); 0, or the signal. One
// that comes over a second later ends the process at once.
void catch_interrupts();
int interrupted();

}  // namespace evo::cli
