#include "cli/command.h"

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
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
#include <system_error>
#include <utility>

#include "cli/terminal.h"
#include "cli/tools.h"
#include "formats/io/values.h"
#include "libevo/sim/isa.h"
#include "version.h"

namespace evo::cli {
namespace {

constexpr std::size_t help_column = 28;
constexpr std::size_t help_width = 80;

// The help that CLI11 makes, in the form of the other tools of a Unix system.
class Help : public CLI::Formatter {
 public:
  Help() {
    label("ARGUMENTS", "");
    label("FORMS", "");
  }
  static std::string name(const CLI::App* app) {
    const CLI::App* within = app->get_parent();
    return (within == nullptr ? "" : name(within) + " ") + app->get_name();
  }
  std::string make_description(const CLI::App* app) const override {
    return name(app) + " - " + app->get_description() + "\n\n";
  }
  std::string make_usage(const CLI::App* app, std::string /*name*/) const override {
    return "Usage: " + name(app) + " [OPTION]..." + get_label("ARGUMENTS") + "\n";
  }
  std::string make_positionals(const CLI::App* /*app*/) const override {
    return get_label("FORMS");
  }
  std::string make_option_name(const CLI::Option* option, bool /*positional*/) const override {
    const auto& letters = option->get_snames();
    return (letters.empty() ? "    " : "-" + letters[0] + ", ") + "--" + option->get_lnames()[0];
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string value = option->get_type_name();
    return value.empty() ? "" : " " + value;
  }
  std::string make_option(const CLI::Option* option, bool positional) const override {
    const std::string initial = option->get_default_str();
    return entry(make_option_name(option, positional) + make_option_opts(option),
                 option->get_description() + (initial.empty() ? "" : " [" + initial + "]"));
  }
  // A command within a tool has the tool's options, too.
  std::string make_footer(const CLI::App* app) const override {
    const CLI::App* within = app->get_parent();
    return (within == nullptr ? "" : make_groups(within, CLI::AppFormatMode::Normal) + "\n") +
           Formatter::make_footer(app);
  }
  std::string make_subcommand(const CLI::App* app) const override {
    return entry(app->get_name(), app->get_description());
  }
  // A name and what it is, in a column two blanks or more beside it.
  static std::string entry(const std::string& name, const std::string& what) {
    const std::string lines = wrapped(what, help_width - help_column, 0);
    const std::string pad(help_column, ' ');
    const std::string left = "  " + name;
    return left + (left.size() + 2 <= help_column ? pad.substr(left.size()) : "\n" + pad) +
           CLI::detail::find_and_replace(lines, "\n", "\n" + pad) + "\n";
  }
};

// "--count" of "-n,--count".
std::string long_name(const std::string& names) { return names.substr(names.rfind("--")); }

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

// What an option that does not exist may have meant, as words for the message.
std::string option_meant(const std::string& option, const std::vector<std::string>& names) {
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
  explicit Impl(CLI::App* within) : app(within) {}

  std::unique_ptr<CLI::App> owned;  // but of a subcommand
  CLI::App* app;
  std::shared_ptr<Help> help = std::make_shared<Help>();
  std::string section = "Options";
  std::string examples;
  bool has_progress = false;
  bool has_jobs = false;
  std::optional<int> jobs;
  std::map<std::string, Option::Words> words;  // by long name, or argument
  std::vector<std::unique_ptr<Command>> subcommands;
  std::string level = "info";
  std::optional<std::string> log_file;
  bool quiet = false;
  bool verbose = false;

  // For completion: the words that an option may have as its value, one a line.
  bool print_values(const std::string& option) const {
    if (const auto found = words.find(option); found != words.end()) {
      for (const std::string& word : found->second()) fmt::print("{}\n", word);
      return true;
    }
    // Any of the commands that have it will do.
    return std::any_of(subcommands.begin(), subcommands.end(),
                       [&](const auto& command) { return command->impl_->print_values(option); });
  }

  std::vector<std::string> long_names() const {
    std::vector<std::string> names;
    for (const CLI::Option* option : app->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const auto& command : subcommands)
      if (command->given())
        for (std::string& name : command->impl_->long_names()) names.push_back(std::move(name));
    return names;
  }

  void finish_help() {
    app->formatter(help);
    app->footer((examples.empty() ? "" : "Examples:\n" + examples + "\n") +
                "Exit status: 0 done, 1 the work failed, 2 wrong usage, 65 bad input data,\n"
                "66 an input file is missing, 73 an output cannot be created or belongs to\n"
                "other settings, 74 an I/O error, 130 or 143 interrupted.");
    for (const auto& command : subcommands) command->impl_->finish_help();
  }

  // CLI11's complaint in one line that says what to do.
  Error explain(const CLI::ParseError& e) const {
    const std::string see = "; see " + app->get_name() + " --help";
    const std::vector<std::string> left = app->remaining(true);
    // A misspelt option is the likelier reason of whatever else is missing.
    for (const std::string& word : left)
      if (word.size() > 1 && word.front() == '-') {
        const std::string option = word.substr(0, word.find('='));
        return {Failure::usage, fmt::format("unknown option {}{}{}", option,
                                            option_meant(option, long_names()), see)};
      }
    if (!left.empty() && !subcommands.empty()) {
      std::vector<std::string> names;
      for (const auto& command : subcommands) names.push_back(command->name());
      return {Failure::usage,
              fmt::format("'{}' is not one of {}{}{}", left.front(), fmt::join(names, ", "),
                          did_you_mean(left.front(), names), see)};
    }
    if (dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr)
      return {Failure::usage, "unexpected argument '" + left.front() + "'" + see};
    std::string what = e.what();
    std::replace(what.begin(), what.end(), '\n', ' ');
    // "--count: 1 required INT missing"
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&e) != nullptr)
      return {Failure::usage, what.substr(0, what.find(':')) + " needs a value" + see};
    return {Failure::usage, what + see};
  }
};

Command::Command(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Command::Command(const std::string& executable) : impl_(std::make_unique<Impl>(nullptr)) {
  impl_->owned = std::make_unique<CLI::App>(purpose_of(executable), executable);
  impl_->app = impl_->owned.get();
  impl_->app->set_help_flag();
}

Command::~Command() = default;

const std::string& Command::name() const { return impl_->app->get_name(); }

Command& Command::subcommand(const std::string& name, const std::string& purpose) {
  CLI::App* app = impl_->app->add_subcommand(name, purpose);
  app->fallthrough()->group("Commands");
  impl_->app->require_subcommand(0, 1);
  impl_->help->label("ARGUMENTS", " [COMMAND]");
  auto command = std::unique_ptr<Command>(new Command(std::make_unique<Impl>(app)));
  impl_->subcommands.push_back(std::move(command));
  return *impl_->subcommands.back();
}

bool Command::given() const { return impl_->app->parsed(); }

std::string Command::subcommand_given() const {
  for (const auto& command : impl_->subcommands)
    if (command->given()) return command->name();
  return "";
}

Option Command::add(const std::string& names, const std::string& value, const std::string& help,
                    const std::string& initial, const Set& set) {
  CLI::Option* option = impl_->app->add_option(
      names,
      [set](const CLI::results_t& texts) {
        set(texts);
        return true;
      },
      help);
  option->group(impl_->section)->type_name(value)->default_str(initial);
  option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  return {option, &impl_->words};
}

template <typename T>
T option_value(const std::string& text, const std::string& names) {
  const std::string option = long_name(names);
  if (text.empty()) throw error(Failure::usage, "{}: its value is empty", option);
  if constexpr (std::same_as<T, std::string>) return text;
  if constexpr (std::same_as<T, double>) return parse_number(text, option);
  if constexpr (std::same_as<T, std::uint64_t>) return parse_unsigned(text, option);
  if constexpr (std::same_as<T, int>)
    return static_cast<int>(parse_whole(text, option, std::numeric_limits<int>::min(),
                                        std::numeric_limits<int>::max()));
}
template std::string option_value(const std::string&, const std::string&);
template int option_value(const std::string&, const std::string&);
template std::uint64_t option_value(const std::string&, const std::string&);
template double option_value(const std::string&, const std::string&);

Option Command::option(const std::string& names, std::vector<std::string>& target,
                       const std::string& value, const std::string& help) {
  const auto set = [names, &target](const std::vector<std::string>& texts) {
    target.clear();
    for (const std::string& text : texts) target.push_back(option_value<std::string>(text, names));
  };
  const Option option = add(names, value, help, "", set);
  // Repeated, never greedy: the word after the value is not another value.
  impl_->app->get_option(long_name(names))
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1, std::numeric_limits<int>::max())
      ->allow_extra_args(false);
  return option;
}

Option Command::flag(const std::string& names, bool& target, const std::string& help) {
  return {impl_->app->add_flag(names, target, help)->group(impl_->section), &impl_->words};
}

Option& Option::required() {
  option_->required();
  return *this;
}

// What is not a number is told when it is read.
Option& Option::at_least(double low) {
  option_->check([low](const std::string& text) {
    return number_of_text(text).value_or(low) >= low
               ? std::string()
               : fmt::format("must be at least {}, not {}", low, text);
  });
  return *this;
}

Option& Option::between(double low, double high) {
  option_->check([low, high](const std::string& text) {
    const double value = number_of_text(text).value_or(low);
    return value >= low && value <= high
               ? std::string()
               : fmt::format("must be from {} to {}, not {}", low, high, text);
  });
  return *this;
}

Option& Option::one_of(const std::vector<std::string>& words) {
  option_->check(CLI::IsMember(words).description(""));
  (*completions_)["--" + option_->get_lnames()[0]] = [words] { return words; };
  return *this;
}

Option& Option::needs(const Option& other) {
  option_->needs(other.option_);
  return *this;
}

Option& Option::excludes(const std::vector<Option>& others) {
  for (const Option& other : others) option_->excludes(other.option_);
  return *this;
}

void Command::suggestions(const std::string& long_name, const Option::Words& words) {
  impl_->words[long_name] = words;
}

void Command::section(const std::string& title) { impl_->section = title; }

void Command::arguments(std::vector<std::string>& target, const std::string& value,
                        const std::string& help) {
  arguments(target, "[" + value + "]...", {{value + "...", help}});
}

void Command::arguments(std::vector<std::string>& target, const std::string& usage,
                        const std::vector<Form>& forms) {
  std::string shown = "\n";
  for (const Form& form : forms) shown += Help::entry("    " + form.words, form.help);
  impl_->help->label("ARGUMENTS", " " + usage);
  impl_->help->label("FORMS", shown);
  impl_->app->add_option("ARGUMENT", target);
}

void Command::argument(std::string& target, const std::string& value) {
  impl_->help->label("ARGUMENTS", " [" + value + "]");
  impl_->app->add_option("ARGUMENT", target);
}

void Command::only(bool applies, const std::vector<std::string>& long_names,
                   const std::string& where) const {
  if (applies) return;
  for (const std::string& name : long_names)
    if (impl_->app->get_option(name)->count() > 0)
      throw error(Failure::usage, "{} goes with {}; here it would mean nothing", name, where);
}

void Command::example(const std::string& command, const std::string& what) {
  impl_->examples += "  # " + what + "\n  " + command + "\n";
}

void Command::seed_option() {
  option("--seed", seed, "N", "names the random streams; the same seed gives the same bytes");
}

void Command::output_option(const std::string& what) {
  const std::string names = "-o,--output";
  add(names, "FILE", what, output == "-" ? "standard output" : output,
      setter<std::string>(names, output));
}

// Common options stand last in the help.
void Command::jobs_option() { impl_->has_jobs = true; }
void Command::progress_option() { impl_->has_progress = true; }

void Command::common_options() {
  section("Common options");
  if (impl_->has_jobs)
    option("-j,--jobs", impl_->jobs, "N",
           "worker threads; results do not depend on it [all cores; 1 under make]")
        .between(1, most_threads);
  if (impl_->has_progress)
    option("--progress", progress, "WHEN",
           "auto, always, lines (one every ten seconds) or never; auto draws on a terminal, "
           "writes a line a minute elsewhere, and nothing under make")
        .one_of({"auto", "always", "lines", "never"});
  // Their help is among the options of the tool, which theirs shows.
  for (const auto& command : impl_->subcommands)
    command->impl_->app->set_help_flag("-h,--help", "")->group("");
  const Option level = option("--log-level", impl_->level, "LEVEL",
                              "what is said: debug, info, warning, error or off")
                           .one_of({"debug", "info", "warning", "error", "off"});
  const Option quiet = flag("-q,--quiet", impl_->quiet, "say nothing but errors").excludes({level});
  flag("-v,--verbose", impl_->verbose, "say more: --log-level debug").excludes({level, quiet});
  option("--log-file", impl_->log_file, "FILE",
         "what is said goes to the end of this file, too, with the time");
  impl_->app->set_help_flag("-h,--help", "show this help")->group(impl_->section);
  impl_->app
      ->set_version_flag(
          "--version", [&] { return created_by(name()) + " " + best_isa(); },
          "show version, commit, instruction set")
      ->group(impl_->section);
  impl_->finish_help();
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
    log::warn(fmt::format("{} of {} threads could be started; continuing with these",
                          pool.threads(), wanted));
}

int Command::answer(int argc, char** argv, const std::function<int()>& work) {
  Impl& impl = *impl_;
  common_options();
  if (argc == 3 && std::string(argv[1]) == "--values-of") {
    impl.print_values(argv[2]);
    return 0;
  }
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--") break;
    // The parser would take the next word for the value.
    if (word.size() > 3 && word.starts_with("--") && word.find('=') == word.size() - 1)
      throw error(Failure::usage, "{}: its value is empty", word.substr(0, word.size() - 1));
  }
  try {
    impl.app->parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    // Between groups CLI11 leaves several lines.
    std::string help = impl.app->help();
    while (help.find("\n\n\n") != std::string::npos)
      help = CLI::detail::find_and_replace(help, "\n\n\n", "\n\n");
    fmt::print("{}", help);
    return 0;
  } catch (const CLI::CallForVersion& e) {
    fmt::print("{}\n", e.what());
    return 0;
  } catch (const CLI::ParseError& e) {
    throw impl.explain(e);
  }
  const std::string level = impl.quiet ? "error" : impl.verbose ? "debug" : impl.level;
  log::set(level, impl.log_file);
  quiet = level == "error" || level == "off";
  verbose = level == "debug";
  // make runs as many of us as it was asked to; each then has one core.
  jobs = impl.jobs.value_or(
      std::getenv("MAKELEVEL") != nullptr ? 1 : std::min(available_cores(), most_threads));
  const Clock clock;
  const int status = work();
  log::debug(fmt::format("took {}", duration(clock.seconds())));
  return status;
}

int Command::run(int argc, char** argv, const std::function<int()>& work) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is an error of writing
  const auto advice = [&] { return impl_->has_jobs && jobs > 1 ? "; fewer --jobs need less" : ""; };
  return run_as(
      name(), [&] { return answer(argc, argv, work); }, advice);
}

int run_as(const std::string& executable, const std::function<int()>& work,
           const std::function<std::string()>& memory_advice) {
  occupy_standard_streams();
  std::signal(SIGPIPE, SIG_DFL);  // who reads no more ends a pipe, whatever the caller ignored
  log::begin(executable);
  try {
    const int status = work();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw error(Failure::io, "cannot write standard output");
    return status;
  } catch (const Error& e) {
    log::error(e.what());
    return static_cast<int>(e.kind());
  } catch (const std::bad_alloc&) {
    log::error("out of memory" + (memory_advice ? memory_advice() : ""));
  } catch (const std::filesystem::filesystem_error& e) {
    log::error(e.what());
    return static_cast<int>(Failure::io);
  } catch (const std::system_error& e) {  // of printing
    log::error("standard output: cannot be written: " + e.code().message());
    return static_cast<int>(Failure::io);
  } catch (const std::exception& e) {
    log::error(std::string("unexpected failure: ") + e.what());
  }
  return static_cast<int>(Failure::work);
}

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
