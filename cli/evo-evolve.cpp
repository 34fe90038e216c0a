// evo-evolve: plans a whole evolution as a folder with a Makefile, and becomes make.
#include <fmt/ranges.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>

#include "cli/command.h"
#include "cli/data.h"
#include "cli/process.h"
#include "cli/run_makefile.h"
#include "cli/run_source.h"
#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/node.h"
#include "formats/io/values.h"
#include "formats/robot/robot.h"
#include "formats/run/run.h"
#include "formats/run/settings.h"
#include "formats/task/task.h"
#include "libevo/base/digest.h"

namespace {

using namespace evo;
namespace fs = std::filesystem;

using Given = std::map<std::string, std::string>;  // settings by name

struct Options {
  std::string run;
  std::map<std::string, std::optional<std::string>> settings;
  std::map<std::string, bool> without;
  bool plan = false;
  std::optional<std::string> launch;
  std::string tasks = "Walker-v0";  // of compare
  std::string methods = "ga neat bo";
  std::string seeds = "1 2 3";
};

// ---- the tools ------------------------------------------------------------------------

// Where the tools are, if PATH does not lead there.
std::string tools_folder() {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split_list(path == nullptr ? "" : path, ':')) {
    std::error_code unknown;
    if (!fs::exists(fs::path(folder) / "evo-train", unknown)) continue;
    return fs::equivalent(folder, cli::own_folder(), unknown) ? "" : cli::own_folder().string();
  }
  return cli::own_folder().string();
}

void prefer_own_tools() {
  const char* path = std::getenv("PATH");
  ::setenv("PATH", (cli::own_folder().string() + ":" + (path == nullptr ? "" : path)).c_str(), 1);
  // The tools of a run are started in its folder.
  if (const char* data = std::getenv("EVO_DATA"); data != nullptr && *data != '\0')
    ::setenv("EVO_DATA", fs::absolute(data).c_str(), 1);
}

// Python with the package evo_robots, which a checkout has.
std::string python_command() {
  const std::string python = "\"${EVO_PYTHON:-python3}\" -m evo_robots";
  const fs::path package = cli::data_root() / "bindings" / "python";
  return fs::exists(package / "evo_robots") ? fmt::format("PYTHONPATH={}:${{PYTHONPATH:-}} {}",
                                                          shell_word(package.string()), python)
                                            : python;
}

// ---- what a run begins with ---------------------------------------------------------------

// The controller that all robots of a run had in the last generation that shared one.
std::string last_shared_policy(const fs::path& policies) {
  std::map<int, fs::path> found;  // by generation
  if (fs::is_directory(policies))
    for (const auto& entry : fs::directory_iterator(policies)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("gen-") && name.ends_with(".policy.h5"))
        found[std::atoi(name.c_str() + 4)] = entry.path();
    }
  return found.empty() ? "" : found.rbegin()->second.string();
}

// A run, a record, or a file of robots; `count` of them are wanted.
cli::Founders find_founders(const std::string& given, int count) {
  const fs::path path = fs::absolute(given).lexically_normal();
  cli::Founders founders;
  if (!fs::exists(path)) throw error(Failure::no_input, "--founders {}: cannot be opened", given);
  fs::path file = path;
  if (fs::exists(path / "policy.h5")) {
    file = path / "policy.h5";
    founders.policies = file.string();
  } else if (fs::is_directory(path)) {
    file = path / "history.jsonl";
    founders.policies = (path / "policies").string();
  }
  if (!fs::is_regular_file(file))
    throw error(Failure::no_input, "--founders {}: {} is no file", given, file.string());
  founders.robots = file.string();
  const std::vector<Robot> robots = read_robots(founders.robots);
  const auto scored = std::count_if(robots.begin(), robots.end(),
                                    [](const Robot& robot) { return robot.fitness().has_value(); });
  founders.scored = scored > 0;
  if (std::ssize(robots) < count)
    throw error(Failure::data, "{}: has {} robots, not --pop {}", given, robots.size(), count);
  if (scored > 0 && scored < count)
    throw error(Failure::data, "{}: has {} robots with a fitness, not --pop {}", given, scored,
                count);
  if (scored == 0 && std::ssize(robots) > count)
    throw error(Failure::data,
                "{}: has {} robots and none has a fitness to choose --pop {} by; evo-train or "
                "evo-eval scores them, --pop {} takes all",
                given, robots.size(), count, robots.size());
  return founders;
}

// ---- settings -----------------------------------------------------------------------------

// A name that is a file here counts by its full path, so that it is the same from anywhere.
std::string settled(const RunSettingInfo& info, const std::string& value) {
  if (info.kind == SettingKind::whole)
    return fmt::format("{}", parse_whole(value, info.option(), info.least, info.most));
  const bool is_file = info.name == "founders" || info.name == "neat";
  const bool may_be_file = info.name == "task" || info.name == "train" || info.name == "physics" ||
                           info.name == "mutate" || info.name == "propose";
  std::error_code unknown;
  const std::size_t colon = cli::is_python_task(value) ? value.rfind(':') : value.size();
  const std::string file = value.substr(0, colon);
  const bool looks_like_file = file.find_first_of("./") != std::string::npos;
  if ((is_file || (may_be_file && looks_like_file)) && fs::exists(file, unknown))
    return fs::absolute(file).lexically_normal().string() + value.substr(colon);
  return value;
}

Given given_settings(const Options& options) {
  Given given;
  for (const RunSettingInfo& info : run_settings()) {
    const auto value = options.settings.find(info.name);
    if (value != options.settings.end() && value->second)
      given[info.name] = settled(info, *value->second);
    const auto without = options.without.find(info.name);
    if (without != options.without.end() && without->second) given[info.name] = info.without;
  }
  return given;
}

RunSettings complete(const std::string& method, Given given) {
  const auto setting = [&](const std::string& name) {
    const auto found = given.find(name);
    return found == given.end() ? std::string() : found->second;
  };
  std::vector<RunSetting> list;
  const bool evaluated = given.contains("evaluate");
  for (const RunSettingInfo& info : run_settings()) {
    if (!info.belongs_to(method)) continue;
    if (evaluated && info.is_of_training()) {
      if (!given.contains(info.name)) continue;
      throw error(Failure::usage, "{} is of robots that are trained, and --evaluate scores them",
                  info.option());
    }
    if (!given.contains(info.name)) given[info.name] = initial_value(info, method, setting);
    if (!given[info.name].empty()) list.push_back({info.name, given[info.name]});
  }
  if (method == "program" && given["propose"].empty())
    throw Error(Failure::usage, "--propose names the program that proposes robots");
  return {method, std::move(list)};
}

// ---- planning -----------------------------------------------------------------------------

// Until it is renamed, a file has a hidden name of its own, ".NAME.tmp".
bool is_half_written(const fs::path& path) {
  return path.filename().string().starts_with('.') && path.extension() == ".tmp";
}

// Where a run may begin: a folder that is not there, or has nothing in it but what an
// interrupted plan left: a Makefile, whole or not, or those of several runs.
void check_place(const fs::path& folder, std::vector<std::string> planned = {}) {
  const std::string name = folder.string();
  if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }))
    throw Error(Failure::usage, "--run: a folder's name has no line breaks or control characters");
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder))
    throw error(Failure::cannot_create, "{}: a file, not a run folder", name);
  planned.emplace_back("Makefile");
  for (const auto& entry : fs::directory_iterator(folder))
    if (std::find(planned.begin(), planned.end(), entry.path().filename()) == planned.end() &&
        !is_half_written(entry.path()))
      throw error(Failure::cannot_create,
                  "{}: neither a run nor an empty folder ({} is in it); choose another --run", name,
                  entry.path().filename().string());
}

void plan(const fs::path& folder, RunSettings settings, cli::Surroundings around) {
  if (const std::string* founders = settings.find("founders");
      founders != nullptr && !around.founders) {
    around.founders =
        find_founders(*founders, std::min(settings.number("pop"), settings.number("evals")));
    if (settings.text("method") == "modular" && fs::is_directory(around.founders->policies))
      around.founders->policies = last_shared_policy(around.founders->policies);
  }
  const std::string makefile = cli::run_makefile(settings, around);
  for (const cli::Trial& trial : cli::trials(settings, around)) {
    // What it refuses it says itself.
    const int status = cli::run_program(trial.words, trial.input).status;
    if (status != 0) std::exit(status);
  }
  make_folders(folder);
  write_file(folder / "Makefile", makefile);
  cli::set_source(settings);
  settings.set_makefile(sha256_hex(makefile));
  write_file(folder / "run.yaml", settings.to_yaml());  // last: with it the run is begun
}

// Refuses another value for a setting of a run that is there.
void compare(const fs::path& folder, const std::string& method, const Given& given) {
  const RunSettings there = RunFolder(folder).settings();
  std::vector<std::string> differences;
  const auto compare = [&](const std::string& name, const std::string& asked) {
    const std::string* known = there.find(name);
    if (known != nullptr && *known == asked) return;
    differences.push_back(
        fmt::format("{}: {} there, {} asked for", name, known == nullptr ? "none" : *known, asked));
  };
  if (!method.empty()) compare("method", method);
  for (const auto& [name, value] : given) compare(name, value);
  if (!differences.empty())
    throw error(Failure::cannot_create,
                "{} belongs to a run with other settings ({}); choose another folder or the same "
                "settings{}",
                folder.string(), fmt::join(differences, "; "),
                fs::exists(folder / "policies") || fs::exists(folder / "gen-000")
                    ? ""
                    : "; nothing has been made in it yet: removing it loses nothing");
  cli::check_source(there, folder.string());
  if (!fs::exists(folder / "Makefile"))
    throw error(Failure::data, "{}: its Makefile is gone; begin the run in another folder",
                folder.string());
}

// A run that is there has to have these settings; else it is planned.
void plan_or_compare(const fs::path& folder, const std::string& method, const Given& given,
                     const cli::Surroundings& around) {
  if (fs::exists(folder / "run.yaml")) return compare(folder, method, given);
  check_place(folder);
  plan(folder, complete(method, given), around);
}

// ---- recipes ------------------------------------------------------------------------------

// Evolutions in rounds, as data (tasks/recipes).
constexpr const char* default_recipe = "moments";

std::vector<RunSetting> round_of(const Node& node) {
  std::vector<std::string> known;
  for (const RunSettingInfo& info : run_settings())
    if (info.belongs_to("ga")) known.push_back(info.name);
  const Mapping mapping(node, "round", known);
  std::vector<RunSetting> round;
  for (const auto& [key, value] : mapping.node().entries()) {
    const std::string text = value.string();
    if (const auto defect = find_run_setting(key.string())->defect(text))
      throw value.error(fmt::format("{} {}", key.string(), *defect));
    round.push_back({key.string(), text});
  }
  return round;
}

// The easier worlds of a task, the easiest first.
std::vector<std::string> easier_worlds(const std::string& task, const DataFolders& folders) {
  std::vector<std::string> found;
  for (const std::string& name : data_names(folders, "easier"))
    if (name.starts_with(task + "-")) found.push_back(name);
  if (found.empty())
    throw error(Failure::usage, "there is no easier world for {} in tasks/easier", task);
  return found;
}

// Rounds of method ga, of a recipe by name or file. A round whose task is "easier" stands for one
// on each of the worlds that are easier than `task` (tasks/easier). Throws Error(usage, no_input,
// data).
std::vector<std::vector<RunSetting>> load_recipe(const std::string& name, const std::string& task) {
  const DataFolders folders = cli::data_folders();
  std::string file = name;
  if (!is_file_name(name)) {
    const auto found = find_data_file(folders, "recipes", name);
    if (!found)
      throw error(Failure::usage, "{}",
                  unknown_name("recipe", name, data_names(folders, "recipes")));
    file = found->string();
  }
  const Node document = Node::yaml(read_file(file, largest_document), file);
  check_format(document, format::recipe);
  const Mapping mapping(document, "recipe", {"format", "version", "description", "rounds"});
  if (const auto description = mapping.find("description")) (void)description->string();
  std::vector<std::vector<RunSetting>> rounds;
  for (const Node& node : mapping.at("rounds").items()) {
    const std::vector<RunSetting> round = round_of(node);
    const auto easier = std::find_if(round.begin(), round.end(), [](const RunSetting& setting) {
      return setting.name == "task" && setting.value == "easier";
    });
    if (easier == round.end()) {
      rounds.push_back(round);
      continue;
    }
    for (const std::string& world : easier_worlds(task, folders)) {
      rounds.push_back(round);
      rounds.back()[static_cast<std::size_t>(easier - round.begin())].value = world;
    }
  }
  if (rounds.empty()) throw mapping.at("rounds").error("a recipe has a round at least");
  return rounds;
}

// ---- several runs -------------------------------------------------------------------------

// A folder of runs, which have names without hostile characters.
void check_collection(const fs::path& folder, const std::vector<std::string>& planned) {
  if (fs::exists(folder / "run.yaml"))
    throw error(Failure::cannot_create, "{}: is one run; choose another --run", folder.string());
  if (!fs::exists(folder / "Makefile")) check_place(folder, planned);
}

constexpr const char* shell_lines =
    "SHELL := /bin/bash\n"
    ".SHELLFLAGS := -eu -o pipefail -c\n"
    ".SUFFIXES:\n"
    "MAKEFLAGS += --no-builtin-rules --no-print-directory\n\n"
    ".DEFAULT_GOAL := all\n"
    ".PHONY: all\n";

// The rounds of a recipe, 1, 2, .., each a run of ga with the best of the one before.
void plan_recipe(const fs::path& folder, const std::string& name, const Given& given,
                 cli::Surroundings around) {
  const auto task = given.find("task");
  const std::vector<std::vector<RunSetting>> rounds =
      load_recipe(name, task == given.end() ? "Walker-v0" : task->second);
  const std::int64_t seed = given.contains("seed") ? std::stoll(given.at("seed")) : 0;
  std::vector<std::string> names;
  for (std::size_t k = 1; k <= rounds.size(); ++k) names.push_back(fmt::format("{}", k));
  check_collection(folder, names);
  std::string makefile = fmt::format(
      "# A run of evo evolve recipe {}: in each round the best of the one before begin.\n\n{}",
      name, shell_lines);
  for (std::size_t k = 1; k <= rounds.size(); ++k) {
    Given round = given;
    for (const auto& [setting, value] : rounds[k - 1]) {
      if (setting != "task" && given.contains(setting))
        throw error(Failure::usage, "{} is decided round by round in recipe {}",
                    find_run_setting(setting)->option(), name);
      round[setting] = value;
    }
    round["seed"] = fmt::format("{}", seed + static_cast<std::int64_t>(k) - 1);
    around.founders.reset();
    if (k > 1) {
      const std::string before = fmt::format("../{}", k - 1);
      round["founders"] = before;
      around.founders = {before + "/history.jsonl", true, before + "/policies"};
    } else if (!given.contains("founders") && round.contains("inherit")) {
      // There is nobody yet to continue from.
      if (round["inherit"] == "all") round["inherit"] = "no";
    }
    plan_or_compare(folder / fmt::format("{}", k), "ga", round, around);
    const bool last = k == rounds.size();
    makefile += fmt::format(
        "\n{}:{}\n\t+$(MAKE) -C {}{}\n", last ? "all" : fmt::format("{}/history.jsonl", k),
        k == 1 ? "" : fmt::format(" | {}/history.jsonl", k - 1), k, last ? "" : " history.jsonl");
  }
  write_file(folder / "Makefile", makefile);
}

bool is_plain_name(const std::string& name) {
  return !name.empty() &&
         name.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.") ==
             std::string::npos;
}

std::vector<std::string> items(std::string list) {
  std::replace(list.begin(), list.end(), ',', ' ');
  return split_list(list, ' ');
}

// What is compared: a method, or NAME=PROGRAM, what a program of one's own proposes.
struct Column {
  std::string name;
  std::string method;
  std::string program;
};

Column column_of(const std::string& item) {
  const std::size_t equals = item.find('=');
  Column column{item.substr(0, equals), "program", ""};
  if (equals == std::string::npos)
    column.method = column.name;
  else
    column.program = item.substr(equals + 1);
  check_run_method(column.method);
  if (!is_plain_name(column.name) || (equals != std::string::npos && column.program.empty()))
    throw error(Failure::usage,
                "--methods {}: expected a method, or NAME=PROGRAM with a name of letters, digits, "
                "- and _",
                item);
  return column;
}

// Every method on every task with every seed, each a run, TASK/METHOD-SEED.
void plan_comparison(const fs::path& folder, const Options& options, const Given& given,
                     const cli::Surroundings& around) {
  // A fitness of one's own has no task; its runs have a folder beside those of tasks.
  const bool evaluated = given.contains("evaluate");
  const std::vector<std::string> tasks = items(evaluated ? "evaluate" : options.tasks);
  std::vector<std::string> names;
  for (const std::string& task : tasks) names.push_back(task_label(task));
  std::set<std::string> different(names.begin(), names.end());
  if (different.size() < names.size())
    throw Error(Failure::usage,
                "--tasks: two of them have the same name, after which their runs are called");
  check_collection(folder, names);
  std::vector<Column> columns;
  std::vector<std::string> methods;
  for (const std::string& item : items(options.methods)) {
    columns.push_back(column_of(item));
    methods.push_back(columns.back().method);
  }
  for (const auto& [name, value] : given)
    if (std::none_of(methods.begin(), methods.end(), [&, &name = name](const std::string& method) {
          return find_run_setting(name)->belongs_to(method);
        }))
      throw error(Failure::usage, "{} is a setting of {}, not of {}",
                  find_run_setting(name)->option(),
                  fmt::join(find_run_setting(name)->methods, ", "), fmt::join(methods, ", "));
  const std::string initial_video = initial_value(*find_run_setting("video"), "", {});
  std::vector<std::string> runs;
  for (const std::string& task : tasks)
    for (const Column& column : columns)
      for (const std::string& seed : items(options.seeds)) {
        Given run;
        for (const auto& [name, value] : given)
          if (find_run_setting(name)->belongs_to(column.method)) run[name] = value;
        if (!column.program.empty()) {
          run["propose"] = settled(*find_run_setting("propose"), column.program);
          run["name"] = column.name;
        }
        if (!evaluated) run["task"] = settled(*find_run_setting("task"), task);
        run["seed"] = settled(*find_run_setting("seed"), seed);
        const std::string name = task_label(task);
        if (!is_plain_name(name))
          throw error(Failure::usage,
                      "--tasks: the name of '{}' has to be of letters, digits, - and _", task);
        runs.push_back(fmt::format("{}/{}-{}", name, column.name, run["seed"]));
        if (!evaluated && !fs::exists(folder / runs.back()))
          run.try_emplace("video", initial_video);
        plan_or_compare(folder / runs.back(), column.method, run, around);
      }
  if (runs.empty())
    throw Error(Failure::usage, "compare: --tasks, --methods and --seeds name no run");
  write_file(folder / "Makefile",
             fmt::format("# Runs side by side, by evo evolve compare.\n\n{}\nRUNS = {}\n\n"
                         "all: compare.html\n"
                         "\tevo-report --table - $(RUNS)\n"
                         "\t@echo $(CURDIR)/compare.html >&2\n\n"
                         "compare.html: $(RUNS:%=%/best.json)\n"
                         "\tevo-report -q $(RUNS) -o $@\n\n"
                         "$(RUNS:%=%/best.json): %/best.json:\n"
                         "\t+$(MAKE) -C $* $(@F)\n",
                         shell_lines, fmt::join(runs, " ")));
}

// ---- becoming make ------------------------------------------------------------------------

// Tells on standard error how the run goes, as long as this process is there.
void start_watcher(const fs::path& folder, const std::string& progress) {
  const pid_t caller = ::getpid();
  if (::fork() != 0) return;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != caller) ::_exit(0);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  std::vector<std::string> words{"evo-inspect", "--watch", folder.string(), "--progress", progress};
  ::execvp(words[0].c_str(), cli::pointers(words).data());
  ::_exit(127);
}

[[noreturn]] void become_make(const cli::Command& command, const fs::path& folder,
                              const Options& options) {
  prefer_own_tools();
  const bool shows = !command.quiet && !command.verbose && std::getenv("MAKELEVEL") == nullptr;
  if (shows && !fs::exists(folder / "1")) start_watcher(folder, command.progress);
  for (int round = 1; shows && fs::exists(folder / fmt::format("{}/run.yaml", round)); ++round)
    start_watcher(folder / fmt::format("{}", round), "never");
  std::vector<std::string> words{"make"};
  if (!command.verbose) words.emplace_back("-s");
  words.insert(words.end(), {"-C", folder.string()});
  if (std::getenv("MAKELEVEL") == nullptr) words.push_back(fmt::format("-j{}", command.jobs));
  if (options.launch) words.push_back("LAUNCH=" + *options.launch);
  ::execvp(words[0].c_str(), cli::pointers(words).data());
  throw error(Failure::io, "make cannot be started ({}); to install it: apt install make",
              std::strerror(errno));
}

// The settings of a method, or of all methods, as options.
void add_settings(cli::Command& command, Options& options, const std::string& method,
                  const std::vector<std::string>& without = {}) {
  const auto initial_of = [](const std::string& name) { return find_run_setting(name)->initial; };
  command.section("Settings");
  for (const RunSettingInfo& info : run_settings()) {
    if (!method.empty() && !info.belongs_to(method)) continue;
    if (std::find(without.begin(), without.end(), info.name) != without.end()) continue;
    std::string help = info.meaning;
    if (!info.initial.empty()) help += " [" + initial_value(info, method, initial_of) + "]";
    cli::Option option =
        command.option(info.option(), options.settings[info.name], info.value, help);
    if (info.kind == SettingKind::words) option.one_of(info.words());
    if (!info.without.empty())
      command.flag(info.option_without(), options.without[info.name], "make none")
          .excludes({option});
  }
  command.suggestions("--task", [] { return task_names(cli::data_folders()); });
  command.suggestions("--train", [] { return data_names(cli::data_folders(), "training"); });
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-evolve");
  Options options;
  command
      .option("--run", options.run, "DIR",
              "the run's folder, where it is or shall be; a run that is there continues")
      .required();
  command.flag("--plan", options.plan, "only write run.yaml and the Makefile");
  command.option("--launch", options.launch, "COMMAND",
                 "what stands in front of every training, such as 'srun --exact -n1 -c1'");
  command.jobs_option();
  command.progress_option();
  for (const RunMethod& method : run_methods())
    add_settings(command.subcommand(method.name, method.meaning), options, method.name);
  cli::Command& recipe = command.subcommand(
      "recipe",
      fmt::format("rounds of ga: a NAME in tasks/recipes, or a file [{}]", default_recipe));
  std::string recipe_name = default_recipe;
  recipe.argument(recipe_name, "NAME");
  add_settings(recipe, options, "ga");
  command.suggestions("recipe", [] { return data_names(cli::data_folders(), "recipes"); });
  cli::Command& side_by_side =
      command.subcommand("compare", "methods, tasks and seeds side by side");
  side_by_side.option("--tasks", options.tasks, "LIST", "tasks, separated by blanks or commas");
  side_by_side.option("--methods", options.methods, "LIST",
                      "methods, likewise; NAME=PROGRAM is one of "
                      "your own (evo evolve program --help)");
  side_by_side.option("--seeds", options.seeds, "LIST", "seeds, likewise");
  add_settings(side_by_side, options, "", {"task", "seed"});
  command.example("evo evolve ga --run runs/walker --task Walker-v0 --evals 100 -j8",
                  "bodies by the genetic algorithm, each with a controller of its own");
  command.example("evo evolve recipe moments --run runs/stairs --task UpStepper-v0 -j8",
                  "a network that climbs stairs, in two rounds");
  command.example("evo evolve compare --run runs/methods --evals 100 --seeds '1 2 3' -j8",
                  "methods against each other, a table and a page");
  command.example("evo evolve --run runs/walker -j8", "continue; so does make -C runs/walker -j8");

  return command.run(argc, argv, [&] {
    const fs::path folder = options.run;
    const Given given = given_settings(options);
    cli::Surroundings around;
    around.tools = tools_folder();
    around.here = fs::current_path().string();
    around.python = python_command();
    prefer_own_tools();
    const std::string method = command.subcommand_given();
    if (recipe.given()) {
      plan_recipe(folder, recipe_name, given, around);
    } else if (side_by_side.given()) {
      side_by_side.only(!given.contains("evaluate"), {"--tasks"}, "robots that are trained");
      plan_comparison(folder, options, given, around);
    } else if (!method.empty()) {
      plan_or_compare(folder, method, given, around);
    } else if (fs::exists(folder / "run.yaml")) {
      compare(folder, "", given);
    } else if (!fs::exists(folder / "Makefile")) {
      throw error(Failure::no_input, "{}: there is no such run; name a method to begin it",
                  folder.string());
    }
    if (options.plan) {
      cli::log::info(fmt::format("{}", (folder / "Makefile").string()));
      return 0;
    }
    become_make(command, folder, options);
  });
}
