#include "cli/command.h"

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <concepts>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <limits>
#include <map>
#include <new>
#include <sstream>
#include <system_error>
#include <utility>

#include "cli/config_file.h"
#include "cli/terminal.h"
#include "cli/tools.h"
#include "formats/io/values.h"
#include "libevo/sim/isa.h"
#include "version.h"

namespace evo::cli {
namespace {

// What is said on standard error, by whom.
enum class Detail { errors, normal, more };
Detail wanted = Detail::normal;
std::string speaker;

void say(Detail detail, const std::string& text) {
  if (detail > wanted) return;
  const std::string line = speaker + ": " + printable(text) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);  // at once, whatever other threads say
}
void say_error(const std::string& text) { say(Detail::errors, text); }

struct Entry {
  std::string names;  // "-n, --count N"
  std::string help;   // with the default in brackets
};

struct Section {
  std::string title;
  std::vector<Entry> entries;
};

constexpr std::size_t help_column = 28;
constexpr std::size_t help_width = 80;

// `text` broken into lines that fit beside a column of names.
void print_wrapped(std::ostream& out, const std::string& text) {
  std::istringstream words(text);
  std::string word;
  std::size_t column = help_column;
  bool first = true;
  while (words >> word) {
    if (!first && column + 1 + word.size() > help_width) {
      out << '\n' << std::string(help_column, ' ');
      column = help_column;
    } else if (!first) {
      out << ' ';
      ++column;
    }
    out << word;
    column += word.size();
    first = false;
  }
  out << '\n';
}

void print_entry(std::ostream& out, const Entry& entry) {
  const std::string left = "  " + entry.names;
  out << left;
  if (left.size() + 2 > help_column) {
    out << '\n' << std::string(help_column, ' ');
  } else {
    out << std::string(help_column - left.size(), ' ');
  }
  print_wrapped(out, entry.help);
}

// "--count" of "-n,--count".
std::string long_name(const std::string& names) { return names.substr(names.rfind("--")); }

// What the text of an option's value means for its target. An empty text is an
// unset shell variable, and never meant.
template <typename T>
T value_of(const std::string& text, const std::string& option) {
  if (text.empty()) throw error(Failure::usage, "{}: its value is empty", option);
  if constexpr (std::same_as<T, std::string>) return text;
  if constexpr (std::same_as<T, double>) return parse_number(text, option);
  if constexpr (std::same_as<T, std::uint64_t>) return parse_unsigned(text, option);
  if constexpr (std::same_as<T, int>)
    return static_cast<int>(parse_whole(text, option, std::numeric_limits<int>::min(),
                                        std::numeric_limits<int>::max()));
}

template <typename T>
void assign(T& target, const std::vector<std::string>& texts, const std::string& option) {
  target = value_of<T>(texts.back(), option);
}
template <typename T>
void assign(std::optional<T>& target, const std::vector<std::string>& texts,
            const std::string& option) {
  target = value_of<T>(texts.back(), option);
}
void assign(std::vector<std::string>& target, const std::vector<std::string>& texts,
            const std::string& option) {
  target.clear();
  for (const std::string& text : texts) target.push_back(value_of<std::string>(text, option));
}

std::string with_default(const std::string& help, const std::string& value) {
  return value.empty() ? help : help + " [" + value + "]";
}

std::string shown(const std::string& names, const std::string& value) {
  std::string text = names;
  const std::size_t comma = text.find(',');
  if (comma != std::string::npos) {
    text.replace(comma, 1, ", ");
  } else {
    text = "    " + text;
  }
  return value.empty() ? text : text + " " + value;
}

// A program started with a standard stream closed would give the next file it
// opens that number, and results would go into the wrong file. What is opened
// here cannot be used, so that using the stream fails.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) {
      const int opened = ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
      if (opened != stream && opened >= 0) ::close(opened);
    }
}

// What other programs call it, and what it is called here.
constexpr std::array<std::pair<const char*, const char*>, 20> other_names{{
    {"--top", "--keep"},         {"--best", "--keep"},          {"--number", "--count"},
    {"--num", "--count"},        {"--population", "--pop"},     {"--population", "--count"},
    {"--of", "--evals"},         {"--size", "--shape"},         {"--env", "--task"},
    {"--environment", "--task"}, {"--threads", "--jobs"},       {"--workers", "--jobs"},
    {"--cores", "--jobs"},       {"--out", "--output"},         {"--outfile", "--output"},
    {"--dir", "--out-dir"},      {"--output-dir", "--out-dir"}, {"--timesteps", "--steps"},
    {"--algorithm", "--algo"},   {"--mutation-rate", "--rate"},
}};

// "follow, world or fixed"
std::string either(const std::vector<std::string>& words) {
  if (words.size() < 2) return fmt::format("{}", fmt::join(words, ""));
  return fmt::format("{} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

// What an option that does not exist may have meant, as words for the message.
std::string option_meant(const std::string& option, const std::vector<std::string>& names) {
  for (const auto& [elsewhere, here] : other_names)
    if (option == elsewhere && std::find(names.begin(), names.end(), here) != names.end())
      return fmt::format(" (did you mean '{}'?)", here);
  // Compared without the dashes, which all have in common.
  std::vector<std::string> words;
  for (const std::string& name : names) words.push_back(name.substr(2));
  const std::string word = nearest(
      option.substr(std::min<std::size_t>(option.find_first_not_of('-'), option.size())), words);
  return word.empty() ? "" : " (did you mean '--" + word + "'?)";
}

std::atomic<int> pending_signal = 0;
std::atomic<std::int64_t> signalled_at = 0;  // nanoseconds of the monotonic clock
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "for a signal handler");

// Whoever ends a pipeline may say so in several ways: to the process group, through the
// processes in between, as a parent that dies. What comes at once is one signal.
constexpr std::int64_t at_once = 1'000'000'000;

extern "C" void remember_signal(int signal) {
  timespec clock{};
  ::clock_gettime(CLOCK_MONOTONIC, &clock);
  const std::int64_t now = std::int64_t{clock.tv_sec} * 1'000'000'000 + clock.tv_nsec;
  std::int64_t first = 0;
  if (signalled_at.compare_exchange_strong(first, now))
    pending_signal = signal;
  else if (now - first > at_once)
    ::_exit(128 + signal);
}

}  // namespace

struct Command::Impl {
  std::string name;
  std::string purpose;
  CLI::App app;
  std::vector<Section> sections{{"Options", {}}};
  Section common{"Common options", {}};
  std::string arguments_usage;
  std::vector<Entry> arguments;
  std::vector<std::pair<std::string, std::string>> examples;
  bool help = false;
  bool version = false;
  bool has_jobs = false;
  std::optional<int> jobs;
  std::map<std::string, std::function<std::vector<std::string>()>> words;  // by long name

  template <typename T>
  CLI::Option* add(const std::string& names, T& target, const std::string& value,
                   const std::string& help_text, const std::string& default_text,
                   bool is_common = false) {
    Section& section = is_common ? common : sections.back();
    section.entries.push_back({shown(names, value), with_default(help_text, default_text)});
    const CLI::callback_t set = [&target, option = long_name(names)](const CLI::results_t& texts) {
      assign(target, texts, option);
      return true;
    };
    // Given twice, the last one counts.
    return app.add_option(names, set)->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  }

  // For completion: the words that an option may have as its value, one a line.
  void print_values(const std::string& option) const {
    const auto found = words.find(option);
    if (found == words.end()) return;
    for (const std::string& word : found->second()) fmt::print("{}\n", word);
  }

  std::vector<std::string> long_names() const {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
  }

  void print_help() const {
    std::ostringstream out;
    out << name << " - " << purpose << "\n\nUsage: " << name << " [OPTION]...";
    if (!arguments.empty()) out << " " << arguments_usage << "\n";
    out << "\n";
    for (const Entry& entry : arguments) print_entry(out, entry);
    std::vector<Section> all = sections;
    all.push_back(common);
    for (const Section& section : all) {
      if (section.entries.empty()) continue;
      out << "\n" << section.title << ":\n";
      for (const Entry& entry : section.entries) print_entry(out, entry);
    }
    if (!examples.empty()) {
      out << "\nExamples:\n";
      for (const auto& [command, what] : examples)
        out << "  # " << what << "\n  " << command << "\n";
    }
    out << "\nExit status: 0 done, 1 the work failed, 2 wrong usage, 65 bad input data,\n"
           "66 an input file is missing, 73 an output cannot be created or belongs to\n"
           "other settings, 74 an I/O error, 130 or 143 interrupted.\n";
    std::fputs(out.str().c_str(), stdout);
  }

  // CLI11's complaint in one line that says what to do.
  Error explain(const CLI::ParseError& e) const {
    const std::string see = "; see " + name + " --help";
    // A misspelt option is the likelier reason of whatever else is missing.
    for (const std::string& word : app.remaining())
      if (word.size() > 1 && word.front() == '-') {
        const std::string option = word.substr(0, word.find('='));
        return {Failure::usage, fmt::format("unknown option {}{}{}", option,
                                            option_meant(option, long_names()), see)};
      }
    if (dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr)
      return {Failure::usage, "unexpected argument '" + app.remaining().front() + "'" + see};
    if (dynamic_cast<const CLI::ConfigError*>(&e) != nullptr) {
      const std::string what = e.what();
      const std::string key = what.substr(what.rfind(' ') + 1);
      return {Failure::usage, "--config: unknown option '" + key + "'" +
                                  option_meant("--" + key, long_names()) + see};
    }
    if (dynamic_cast<const CLI::FileError*>(&e) != nullptr)
      return {Failure::no_input, std::string("--config: ") + e.what()};
    std::string what = e.what();
    std::replace(what.begin(), what.end(), '\n', ' ');
    // "--count: 1 required INT missing"
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&e) != nullptr)
      return {Failure::usage, what.substr(0, what.find(':')) + " needs a value" + see};
    return {Failure::usage, what + see};
  }
};

Command::Command(const std::string& executable) : impl_(std::make_unique<Impl>()) {
  impl_->name = executable;
  impl_->purpose = purpose_of(executable);
  impl_->app.set_help_flag();
  impl_->app.allow_extras(false);
}

Command::~Command() = default;

const std::string& Command::name() const { return impl_->name; }

void Command::option(const std::string& names, std::string& target, const std::string& value,
                     const std::string& help) {
  impl_->add(names, target, value, help, target);
}
void Command::option(const std::string& names, int& target, const std::string& value,
                     const std::string& help) {
  impl_->add(names, target, value, help, fmt::format("{}", target));
}
void Command::option(const std::string& names, std::uint64_t& target, const std::string& value,
                     const std::string& help) {
  impl_->add(names, target, value, help, fmt::format("{}", target));
}
void Command::option(const std::string& names, double& target, const std::string& value,
                     const std::string& help) {
  impl_->add(names, target, value, help, fmt::format("{}", target));
}
void Command::option(const std::string& names, std::optional<std::string>& target,
                     const std::string& value, const std::string& help) {
  impl_->add(names, target, value, help, "");
}
void Command::option(const std::string& names, std::optional<int>& target, const std::string& value,
                     const std::string& help) {
  impl_->add(names, target, value, help, "");
}
void Command::option(const std::string& names, std::optional<double>& target,
                     const std::string& value, const std::string& help) {
  impl_->add(names, target, value, help, "");
}
void Command::option(const std::string& names, std::vector<std::string>& target,
                     const std::string& value, const std::string& help) {
  // Repeated, never greedy: the word after the value is not another value.
  impl_->add(names, target, value, help, "")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1, std::numeric_limits<int>::max())
      ->allow_extra_args(false);
}

void Command::add_choice(const std::string& names, const std::string& value,
                         const std::string& help, const std::string& initial,
                         const std::vector<std::string>& words,
                         const std::function<void(const std::string&)>& choose) {
  const std::string option = long_name(names);
  impl_->sections.back().entries.push_back({shown(names, value), with_default(help, initial)});
  impl_->words[option] = [words] { return words; };
  const CLI::callback_t set = [option, words, choose](const CLI::results_t& texts) {
    const auto word = value_of<std::string>(texts.back(), option);
    if (std::find(words.begin(), words.end(), word) == words.end())
      throw error(Failure::usage, "{}: '{}' is not {}{}", option, word, either(words),
                  did_you_mean(word, words));
    choose(word);
    return true;
  };
  impl_->app.add_option(names, set)->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

void Command::suggestions(const std::string& long_name,
                          const std::function<std::vector<std::string>()>& words) {
  impl_->words[long_name] = words;
}

void Command::flag(const std::string& names, bool& target, const std::string& help) {
  impl_->sections.back().entries.push_back({shown(names, ""), help});
  impl_->app.add_flag(names, target);
}

void Command::section(const std::string& title) {
  if (impl_->sections.back().entries.empty()) {
    impl_->sections.back().title = title;
  } else {
    impl_->sections.push_back({title, {}});
  }
}

void Command::arguments(std::vector<std::string>& target, const std::string& value,
                        const std::string& help) {
  arguments(target, "[" + value + "]...", {{value + "...", help}});
}

void Command::arguments(std::vector<std::string>& target, const std::string& usage,
                        const std::vector<Form>& forms) {
  impl_->arguments_usage = usage;
  for (const Form& form : forms) impl_->arguments.push_back({"    " + form.words, form.help});
  impl_->app.add_option("ARGUMENT", target);
}

void Command::require(const std::string& long_name) {
  impl_->app.get_option(long_name)->required();
}

void Command::only(bool applies, const std::vector<std::string>& long_names,
                   const std::string& where) const {
  if (applies) return;
  for (const std::string& name : long_names)
    if (impl_->app.get_option(name)->count() > 0)
      throw error(Failure::usage, "{} goes with {}; here it would mean nothing", name, where);
}

void Command::example(const std::string& command, const std::string& what) {
  impl_->examples.emplace_back(command, what);
}

void Command::seed_option() {
  impl_->add("--seed", seed, "N", "names the random streams; the same seed gives the same bytes",
             "0");
}

void Command::jobs_option() {
  impl_->has_jobs = true;
  impl_->add("-j,--jobs", impl_->jobs, "N",
             "worker threads; results do not depend on it [all cores; 1 under make]", "", true);
}

void Command::output_option(const std::string& what) {
  impl_->add("-o,--output", output, "FILE", what, output == "-" ? "standard output" : output);
}

void Command::progress_option() {
  static const std::vector<std::string> words{"auto", "always", "lines", "never"};
  impl_
      ->add("--progress", progress, "WHEN",
            "auto, always, lines (one every ten seconds) or never; auto draws on a terminal, "
            "writes a line a minute elsewhere, and nothing under make",
            "auto", true)
      ->check(CLI::IsMember(words));
  suggestions("--progress", [] { return words; });
}

Progress Command::progress_style() const {
  if (quiet || progress == "never") return Progress::none;
  if (progress == "always") return Progress::drawn;
  if (progress == "lines") return Progress::often;
  // Under make, others draw on the same terminal.
  if (std::getenv("MAKELEVEL") != nullptr) return Progress::none;
  if (isatty(STDERR_FILENO) != 1) return Progress::rarely;
  return terminal_redraws() ? Progress::drawn : Progress::often;
}

void say_note(const std::string& text) { say(Detail::normal, text); }
void say_detail(const std::string& text) { say(Detail::more, text); }
void Command::detail(const std::string& text) const { say_detail(text); }
void Command::note(const std::string& text) const { say(Detail::normal, text); }
void Command::warn(const std::string& text) const { say(Detail::normal, text); }

namespace {

int threads_for(std::size_t tasks, int most) {
  return static_cast<int>(
      std::clamp<std::size_t>(tasks, 1, static_cast<std::size_t>(std::max(most, 1))));
}

}  // namespace

Workers::Workers(const Command& command, std::size_t tasks)
    : pool(threads_for(tasks, command.jobs)) {
  const int wanted = threads_for(tasks, command.jobs);
  if (pool.threads() < wanted)
    command.warn(fmt::format("{} of {} threads could be started; going on with these",
                             pool.threads(), wanted));
}

void Command::parse(std::vector<std::string> words) {
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    impl_->app.parse(words);
  } catch (const CLI::ParseError& e) {
    throw impl_->explain(e);
  }
}

int Command::answer(int argc, char** argv, const std::function<int()>& work) {
  Impl& impl = *impl_;
  if (argc == 3 && std::string(argv[1]) == "--values-of") {
    impl.print_values(argv[2]);
    return 0;
  }
  // Asked for help, a tool helps, whatever else stands on the line.
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--") break;
    impl.help |= word == "-h" || word == "--help";
    impl.version |= word == "--version";
    // The parser would take the next word for the value.
    if (word.size() > 3 && word.starts_with("--") && word.find('=') == word.size() - 1)
      throw error(Failure::usage, "{}: its value is empty", word.substr(0, word.size() - 1));
  }
  if (impl.help) {
    impl.print_help();
    return 0;
  }
  if (impl.version) {
    fmt::print("{} {}\n", created_by(impl.name), best_isa());
    return 0;
  }
  try {
    impl.app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    throw impl.explain(e);
  }
  wanted = quiet ? Detail::errors : verbose ? Detail::more : Detail::normal;
  if (impl.jobs && (*impl.jobs < 1 || *impl.jobs > most_threads))
    throw error(Failure::usage, "--jobs must be from 1 to {}, not {}", most_threads, *impl.jobs);
  // make runs as many of us as it was asked to; each then has one core.
  jobs = impl.jobs.value_or(
      std::getenv("MAKELEVEL") != nullptr ? 1 : std::min(available_cores(), most_threads));
  const auto start = std::chrono::steady_clock::now();
  const int status = work();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  detail(fmt::format("took {}", duration(taken.count())));
  return status;
}

int Command::run(int argc, char** argv, const std::function<int()>& work) {
  Impl& impl = *impl_;
  impl.common.entries.push_back({shown("-q,--quiet", ""), "say nothing but errors"});
  impl.app.add_flag("-q,--quiet", quiet);
  impl.common.entries.push_back({shown("-v,--verbose", ""), "say more"});
  impl.app.add_flag("-v,--verbose", verbose);
  impl.common.entries.push_back(
      {shown("--config", "FILE"), "read options from a YAML file; the command line wins"});
  impl.app.set_config("--config");
  impl.app.config_formatter(std::make_shared<YamlConfig>(impl.app));
  impl.app.allow_config_extras(false);
  impl.common.entries.push_back({shown("-h,--help", ""), "show this help"});
  impl.app.add_flag("-h,--help", impl.help);
  impl.common.entries.push_back({shown("--version", ""), "show version, commit, instruction set"});
  impl.app.add_flag("--version", impl.version);

  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is an error of writing
  const auto advice = [&] { return impl.has_jobs && jobs > 1 ? "; fewer --jobs need less" : ""; };
  return run_as(
      impl.name, [&] { return answer(argc, argv, work); }, advice);
}

int run_as(const std::string& executable, const std::function<int()>& work,
           const std::function<std::string()>& memory_advice) {
  occupy_standard_streams();
  speaker = executable;
  try {
    const int status = work();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw error(Failure::io, "cannot write standard output");
    return status;
  } catch (const Error& e) {
    say_error(e.what());
    return static_cast<int>(e.kind());
  } catch (const std::bad_alloc&) {
    say_error("out of memory" + (memory_advice ? memory_advice() : ""));
  } catch (const std::filesystem::filesystem_error& e) {
    say_error(e.what());
    return static_cast<int>(Failure::io);
  } catch (const std::system_error& e) {  // of printing
    say_error("standard output: cannot be written: " + e.code().message());
    return static_cast<int>(Failure::io);
  } catch (const std::exception& e) {
    say_error(std::string("unexpected failure: ") + e.what());
  }
  return static_cast<int>(Failure::work);
}

std::string version() { return EVO_VERSION; }
std::string created_by(const std::string& tool) {
  return fmt::format("{} {} ({})", tool, EVO_VERSION, EVO_COMMIT);
}

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = remember_signal;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before = {};
    sigaction(signal, nullptr, &before);
    const bool nohup = signal == SIGHUP && before.sa_handler == SIG_IGN;
    if (!nohup) sigaction(signal, &action, nullptr);
  }
}

int interrupted() { return pending_signal; }

}  // namespace evo::cli
