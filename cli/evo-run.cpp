// evo-run: a run folder from the side of whoever drives it. Pipelines and
// schedulers begin a run, train its slots by number, and ask how they stand.
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "cli/breeding_options.h"
#include "cli/data.h"
#include "cli/training_options.h"
#include "evolution/plan.h"
#include "evolution/propose.h"
#include "evolution/run_command.h"
#include "formats/io/files.h"
#include "formats/io/lock.h"
#include "formats/io/values.h"
#include "formats/io/yaml.h"
#include "formats/robot/writer.h"
#include "formats/run/option_words.h"
#include "formats/run/run.h"
#include "formats/run/setting_table.h"
#include "formats/training/training_log.h"
#include "libevo/control/methods.h"
#include "libevo/sim/isa.h"

namespace {

using namespace evo;
namespace fs = std::filesystem;

struct Options {
  int generation = 0;
  std::vector<std::string> slots;
  std::optional<int> robots;
  std::string why;
  std::optional<std::string> isa;
};

// ---- init -------------------------------------------------------------------------

// Who goes on from the controllers of others, or of another run.
enum class Heirs { none, children, founders_too };

Heirs heirs(const RunSettings& settings) {
  const std::string* inherit = settings.find("inherit");
  if (inherit == nullptr) return Heirs::none;
  return *inherit == "all"   ? Heirs::founders_too
         : *inherit == "yes" ? Heirs::children
                             : Heirs::none;
}

// Options that a setting keeps as one line; `where` begins the errors.
struct OptionLine {
  std::string text;
  std::string where;
};

// Line after line, each with all before it: a parse forgets what another one has seen of an
// option that may be repeated.
void parse_options(cli::Command& command, const std::vector<OptionLine>& lines) {
  std::vector<std::string> words;
  for (const OptionLine& line : lines) {
    const std::vector<std::string> more = option_words(line.text, line.where);
    words.insert(words.end(), more.begin(), more.end());
    try {
      command.parse(words);
    } catch (const Error& e) {
      throw e.at(line.where);
    }
  }
}

// What a run's settings mean to the trainings of a generation; errors begin with `file`.
TrainingPlan training_plan(const RunSettings& settings, int generation, const std::string& file) {
  cli::Command command("evo-train");
  cli::TrainingOptions options;
  options.add_to(command);
  options.task.task = settings.text("task");
  const bool has_rungs = settings.find("rungs") != nullptr;
  const bool own = settings.find("own_steps") != nullptr && !settings.shares(generation);
  options.steps =
      has_rungs || own ? fmt::format("{}", settings.steps(generation)) : settings.text("steps");
  options.keep_checkpoint = settings.goes_on(generation);
  if (const std::string* steps = settings.find("founder_steps"); steps != nullptr && !has_rungs)
    options.founder_steps = *steps;
  if (settings.text("algo") != "profile") options.algorithm = settings.text("algo");
  options.profile = settings.text("train");
  if (settings.text("physics") != "task") options.task.physics = settings.text("physics");
  command.seed = parse_unsigned(settings.text("seed"), file + "seed");
  options.skip_failures = true;
  std::vector<OptionLine> lines;
  const auto add_line = [&](const std::string& name) {
    if (const std::string* more = settings.find(name)) lines.push_back({*more, file + name});
  };
  add_line("train_options");
  if (own) add_line("own_options");
  parse_options(command, lines);
  TrainingPlan plan = options.plan(command.seed);
  plan.note_resumed = !has_rungs;
  return plan;
}

// The controller of FOUNDERS that are a record (scripts/add-record), if they are.
std::optional<fs::path> policy_of_record(const fs::path& folder) {
  if (const fs::path policy = folder / "policy.h5"; fs::exists(policy)) return policy;
  return std::nullopt;
}

// The controller that all robots of a run had in the last generation that shared one.
fs::path last_shared_policy(const fs::path& folder) {
  if (const auto policy = policy_of_record(folder)) return *policy;
  const RunFolder run(folder);
  fs::path last;
  for (int g = 0; run.settings().shares(g) && fs::exists(run.shared_policy(g)); ++g)
    last = run.shared_policy(g);
  if (last.empty())
    throw error(
        Failure::no_input,
        "{}: has no controller of all robots to go on from; INHERIT=no begins with a new one",
        folder.string());
  return last;
}

TrainingPlan training_plan(const RunFolder& run, int generation) {
  const RunSettings& settings = run.settings();
  TrainingPlan plan =
      training_plan(settings, generation, (run.path() / "run.yaml").string() + ": ");
  plan.policies = run.policies();
  plan.logs = run.logs();
  plan.sharded = run.layout() == Layout::steady;
  plan.resume = true;
  if (settings.shares(0)) {
    if (settings.shares(generation)) plan.shared = run.shared_policy(generation);
    if (generation == 0 && heirs(settings) == Heirs::founders_too)
      plan.init = last_shared_policy(settings.text("founders"));
    if (generation > 0 && settings.shares(generation - 1))
      plan.init = run.shared_policy(generation - 1);
    return plan;
  }
  if (heirs(settings) != Heirs::none && !plan.init) plan.init = run.policies();
  if (heirs(settings) == Heirs::founders_too) {
    const fs::path founders = settings.text("founders");
    plan.founders_from = policy_of_record(founders).value_or(founders / "policies");
  }
  return plan;
}

// FILE.py:CLASS, of the package evo_robots; scripts/python-task trains in it.
bool is_python(const RunSettings& settings) {
  const std::string* task = settings.find("task");
  return task != nullptr && task->find(".py:") != std::string::npos;
}

// A class says itself what it is about, and is trained by PPO from the beginning.
void check_python_task(const RunSettings& settings) {
  const std::map<std::string, std::vector<std::string>> allowed{{"algo", {"ppo", "profile"}},
                                                                {"physics", {"task"}},
                                                                {"inherit", {"no"}},
                                                                {"founder_steps", {}}};
  for (const auto& [name, values] : allowed) {
    const std::string* value = settings.find(name);
    if (value == nullptr || std::ranges::find(values, *value) != values.end()) continue;
    throw error(Failure::usage, "{}={} is for tasks of the suite: {} is a class in Python, {}",
                name, *value, settings.text("task"), "trained by PPO from the beginning");
  }
}

// One controller learns on all robots of a generation; then the best go on from it alone.
void check_sharing(const RunSettings& settings, const TrainingPlan& plan, int rows, int cols) {
  if (heirs(settings) == Heirs::founders_too) last_shared_policy(settings.text("founders"));
  const TrainingPlan own = training_plan(settings, std::numeric_limits<int>::max(), "");
  for (const TrainingPlan* each : {&plan, &own})
    if (const std::string& name = each->children.algorithm.name(); name != ModularTraining::name)
      throw error(Failure::usage,
                  "train={}: {} makes a controller for each robot; one for all needs a profile of "
                  "algorithm {}, such as train=modular",
                  settings.text("train"), name, ModularTraining::name);
  check_settings(own, own.children, rows, cols, Inherits::yes);
  constexpr int enough = 64;  // robots, to see whether the first steps are too few
  check_settings(plan, plan.children, rows, cols, Inherits::no,
                 std::min(settings.number("pop"), enough));
}

// Whether these settings could train anything: a run that is begun keeps them.
void check_training(const RunSettings& settings) {
  if (const std::string* other = settings.find("evaluate"); other && !other->empty()) return;
  if (is_python(settings)) return check_python_task(settings);
  for (const char* needed : {"task", "steps", "algo", "train", "physics", "seed"})
    if (settings.find(needed) == nullptr) return;
  const TrainingPlan plan = training_plan(settings, 0, "");
  const std::string* shape = settings.find("shape");
  if (shape == nullptr) return;
  const auto [rows, cols] = parse_shape(*shape);
  const auto check = [&](const TrainingSettings& training, bool inherits) {
    check_settings(plan, training, rows, cols, inherits ? Inherits::yes : Inherits::no);
  };
  check(plan.founders, plan.init || heirs(settings) == Heirs::founders_too);
  check(plan.children, plan.init || heirs(settings) != Heirs::none);
  if (settings.shares(0)) check_sharing(settings, plan, rows, cols);
}

int init(const std::string& folder, const std::vector<std::string>& words) {
  const RunSettings settings = RunSettings::from_words(words);
  settings.check();
  check_training(settings);
  RunFolder::create(folder, settings);
  return 0;
}

// ---- train ------------------------------------------------------------------------

// "7" and "3-8", of a population of so many.
std::vector<int> slot_numbers(const std::vector<std::string>& words, int population) {
  std::vector<int> numbers;
  for (const std::string& word : words) {
    int first = 0;
    int last = 0;
    const char* end = word.data() + word.size();
    const auto head = std::from_chars(word.data(), end, first);
    const bool is_range = head.ec == std::errc() && head.ptr != end && *head.ptr == '-';
    const auto tail = is_range ? std::from_chars(head.ptr + 1, end, last) : head;
    if (!is_range) last = first;
    if (tail.ec != std::errc() || tail.ptr != end || first < 0 || last < first)
      throw error(Failure::usage, "--slot: '{}' is neither a number from 0 nor a range like 3-8",
                  word);
    if (last >= population)
      throw error(Failure::usage, "--slot: there is no slot {}; the generation has {}", last,
                  population);
    for (int k = first; k <= last; ++k) numbers.push_back(k);
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

void write_slot(const RunFolder& run, SlotAddress address, const Robot& robot) {
  RobotWriter out(run.slot(address).string());
  out.write(robot);
  out.finish();
}

void add_steps(Robot& robot, std::optional<std::int64_t> before) {
  robot.document["steps"] = robot.steps().value_or(0) + before.value_or(0);
}

// What a training of all took, one after the other for each robot that it adds to the run; of one
// that was interrupted, for the first.
void add_timings(const RunFolder& run, int generation, const std::vector<Robot>& robots,
                 const Trained& trained) {
  std::vector<int> added;
  for (std::size_t k = 0; k < robots.size(); ++k)
    if (!robots[k].steps()) added.push_back(static_cast<int>(k));
  if (!trained.robot || added.empty()) added = {0};
  const auto count = static_cast<double>(added.size());
  double begin = trained.started;
  for (std::size_t k = 0; k < added.size(); ++k) {
    const double end = trained.started + trained.seconds * static_cast<double>(k + 1) / count;
    const Robot& robot = robots[static_cast<std::size_t>(added[k])];
    run.add_timing({robot.id,
                    {generation, added[k]},
                    begin,
                    end - begin,
                    k == 0 ? trained.steps : 0,
                    trained.robot.has_value()});
    begin = end;
  }
}

// One controller for all robots of a generation. Each robot's steps are those of its own
// environments, an equal share, in all generations so far.
int train_together(const cli::Command& command, const RunFolder& run, int generation,
                   const std::vector<int>& slots) {
  std::vector<Robot> robots;
  for (const int slot : slots) robots.push_back(run.robot({generation, slot}));
  std::vector<Robot> scored;
  const TrainingPlan plan = training_plan(run, generation);
  const int status = cli::train_robots(command, plan, robots, [&](const Trained& trained) {
    if (!trained.known && trained.index == 0) add_timings(run, generation, robots, trained);
    if (!trained.robot) return;
    Robot& robot = scored.emplace_back(*trained.robot);
    robot.document["steps"] = robot.steps().value_or(0) / static_cast<std::int64_t>(robots.size());
    add_steps(robot, robots[trained.index].steps());
  });
  if (scored.empty()) {
    cli::log::warn("interrupted; give the same command again to go on");
    return status;
  }
  if (!fs::exists(*plan.shared))
    throw error(Failure::data,
                "{}: the training of generation {} failed ({}); begin another run with other "
                "TRAIN_OPTIONS, such as '--train-set learning_rate=3e-4'",
                run.path().string(), generation, scored[0].failure()->why);
  for (std::size_t k = 0; k < scored.size(); ++k)
    write_slot(run, {generation, slots[k]}, scored[k]);
  return status;
}

// A slot's file appears as soon as its robot is trained. Slots that have one are
// left alone; a survivor's policy is there already, made with the same settings,
// and gives its fitness back without a training. One that failed has failed: it is
// not tried again in every generation that it survives.
int train_slots(const cli::Command& command, const RunFolder& run, int generation,
                const std::vector<int>& slots) {
  std::vector<SlotAddress> addresses;
  std::vector<Robot> robots;
  for (const int slot : slots) {
    const SlotAddress address{generation, slot};
    if (fs::exists(run.slot(address))) continue;
    Robot robot = run.robot(address);
    if (robot.failure()) {
      write_slot(run, address, robot);
      continue;
    }
    addresses.push_back(address);
    robots.push_back(std::move(robot));
  }
  if (robots.empty()) return 0;

  std::mutex timing;
  const auto ended = [&](const Trained& trained) {
    const SlotAddress& address = addresses[trained.index];
    if (!trained.known) {
      const std::lock_guard lock(timing);
      run.add_timing({robots[trained.index].id, address, trained.started, trained.seconds,
                      trained.steps, trained.robot.has_value()});
    }
    if (!trained.robot) return;
    Robot robot = *trained.robot;
    // What it had with the controller of all stays what it cost.
    if (run.settings().shares(0)) add_steps(robot, robots[trained.index].steps());
    write_slot(run, address, robot);
  };
  const int status = cli::train_robots(command, training_plan(run, generation), robots, ended);
  if (status != 0) cli::log::warn("interrupted; give the same command again to go on");
  return status;
}

// Seconds for a process that is coming to its end to let go.
constexpr std::chrono::seconds patience{10};

// Waits a moment for this byte of the run's lock. False: another process is at it.
bool take(const LockFile& lock, std::uint64_t byte) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!lock.take(byte)) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return true;
}

void take_slots(const LockFile& lock, const RunFolder& run, int generation,
                const std::vector<int>& slots) {
  for (const int slot : slots) {
    const SlotAddress address{generation, slot};
    if (fs::exists(run.slot(address)) || take(lock, RunFolder::lock_byte(address))) continue;
    throw error(Failure::work,
                "{}: another process is training slot {} of generation {}; give the same command "
                "again when it has ended (or remove {}, if its machine is lost)",
                run.path().string(), slot, generation, run.lock().string());
  }
}

// Says on which machine slots are being trained, RUN/gen-003/05-09.running. It stays
// behind when the process dies: whoever started it then knows that it had begun.
class RunningMark {
 public:
  RunningMark(const RunFolder& run, int generation, const std::vector<std::string>& slots)
      : file_(run.generation(generation) /
              (fmt::format("{}", fmt::join(slots, ",")) + ".running")) {
    const Json mark = {{"host", this_machine()}, {"process", ::getpid()}};
    write_file(file_, compact(mark) + "\n");
  }
  // The work has ended with this status, or refused its input.
  void ended(int status) const {
    if (status == static_cast<int>(Failure::work)) return;
    std::error_code ignored;
    fs::remove(file_, ignored);
  }

 private:
  fs::path file_;
};

int train(const cli::Command& command, const std::string& folder, const Options& options) {
  const RunFolder run(folder);
  if (is_python(run.settings()))
    throw error(Failure::usage,
                "{}: its task is a class in Python, in which the pipelines train "
                "(scripts/evaluate-slots); give its make again",
                folder);
  if (fs::exists(run.scores(options.generation))) return 0;
  const int population = run.population_size(options.generation);  // which must be there
  std::vector<int> slots = slot_numbers(options.slots, population);
  const bool together = run.settings().shares(options.generation);
  if (together && !slots.empty() && static_cast<int>(slots.size()) != population)
    throw error(Failure::usage,
                "--slot: generation {} has one controller for its {} robots, which are trained "
                "together; leave --slot out",
                options.generation, population);
  if (slots.empty())
    for (int k = 0; k < population; ++k) slots.push_back(k);
  const LockFile lock(run.lock());
  take_slots(lock, run, options.generation, slots);
  const RunningMark mark(run, options.generation,
                         options.slots.empty() ? std::vector<std::string>{"all"} : options.slots);
  try {
    const int status =
        (together ? train_together : train_slots)(command, run, options.generation, slots);
    mark.ended(status);
    return status;
  } catch (const Error& e) {
    mark.ended(static_cast<int>(e.kind()));
    throw;
  }
}

// ---- propose ----------------------------------------------------------------------

int propose(const RunFolder& run, int robots) {
  const LockFile lock(run.lock());
  if (!take(lock, RunFolder::proposals_byte))
    throw error(Failure::work,
                "{}: another process is proposing robots; give the same command again when it has "
                "ended (or remove {}, if its machine is lost)",
                run.path().string(), run.lock().string());
  Breeding breeding;
  cli::Command options("evo-mutate");
  cli::add_breeding_options(options, breeding);
  if (const std::string* line = run.settings().find("mutate_options"))
    parse_options(options, {{*line, (run.path() / "run.yaml").string() + ": mutate_options"}});
  propose_robots(run, breeding, cli::data_folders(), robots);
  return 0;
}

// ---- fail -------------------------------------------------------------------------

// The slots that could not be trained count as failed, so that the run goes on.
int fail(const std::string& folder, const Options& options) {
  const RunFolder run(folder);
  const std::vector<int> slots =
      slot_numbers(options.slots, run.population_size(options.generation));
  if (slots.empty() || options.why.empty())
    throw error(Failure::usage, "fail: --slot says what failed, --why for what reason");
  for (const int slot : slots) {
    const SlotAddress address{options.generation, slot};
    if (fs::exists(run.slot(address))) continue;
    Robot robot = run.robot(address);
    robot.document["fitness"] = nullptr;
    robot.document["failure"] = {{"why", options.why}};
    write_slot(run, address, robot);
  }
  return 0;
}

// ---- slots ------------------------------------------------------------------------

std::string state_word(SlotState state) {
  switch (state) {
    case SlotState::waiting:
      return "waiting";
    case SlotState::training:
      return "training";
    case SlotState::done:
      return "done";
    case SlotState::failed:
      return "failed";
  }
  return "";
}

// What there is to say of a slot in its state: fitness, share done, why it failed.
std::string detail(const SlotStatus& slot, const RunHistory& history) {
  if (slot.state == SlotState::done)
    return fmt::format("{}", *history.robots()[history.by_id().at(slot.robot)].fitness);
  if (slot.state == SlotState::failed) return slot.why;
  if (slot.state == SlotState::waiting) return "";
  const double steps = history.folder().settings().steps(slot.address.generation);
  return fmt::format(
      "{:.2f}", read_training_log(history.folder().log(slot.address.generation, slot.robot)).step /
                    std::max(1.0, steps));
}

int list_slots(const std::string& folder) {
  const RunHistory history{RunFolder(folder)};
  fmt::print("generation\tslot\trobot\tstate\tdetail\n");
  for (const RunHistory::Generation& generation : history.generations())
    for (const SlotStatus& slot : history.slots(generation))
      fmt::print("{}\t{}\t{}\t{}\t{}\n", slot.address.generation, slot.address.slot, slot.robot,
                 state_word(slot.state), detail(slot, history));
  return 0;
}

// ---- command --------------------------------------------------------------------------

int print_command(const std::string& folder, const std::vector<std::string>& changes) {
  const RunFolder run(folder);
  std::vector<std::pair<std::string, std::string>> variables{{"RUN", folder}};
  for (const std::string& change : changes) {
    const std::size_t equals = change.find('=');
    if (equals == std::string::npos || equals == 0)
      throw error(Failure::usage, "command: '{}' is not VARIABLE=VALUE, such as SEED=2", change);
    variables.emplace_back(change.substr(0, equals), change.substr(equals + 1));
  }
  const auto setting = [&](const std::string& name) {
    const std::string* value = run.settings().find(name);
    return value == nullptr ? std::string() : *value;
  };
  fmt::print("{}\n", run_command(setting, variables));
  return 0;
}

// ---- plan -------------------------------------------------------------------------------

// Of a run that need not be there yet: make -n plans, too.
int print_plan(const std::string& folder, const std::vector<std::string>& words) {
  PlanSettings plan;
  const RunSettings settings = RunSettings::from_words(words);
  for (const RunSetting& setting : settings.list()) {
    int* const number = setting.name == "pop"      ? &plan.pop
                        : setting.name == "evals"  ? &plan.evals
                        : setting.name == "window" ? &plan.window
                        : setting.name == "chunk"  ? &plan.chunk
                                                   : nullptr;
    if (number == nullptr)
      throw error(Failure::usage, "plan: '{}' is none of pop, evals, window, chunk", setting.name);
    *number = static_cast<int>(
        parse_whole(setting.value, setting.name, 1, std::numeric_limits<int>::max() / 2));
  }
  const auto is_finished = [&](int generation) {
    return fs::exists(fs::path(folder) / fmt::format("gen-{:03}", generation) / "ranking.tsv");
  };
  fmt::print("{}", plan_rules(folder, plan, is_finished));
  return 0;
}

// ---- settings -------------------------------------------------------------------------

int print_settings(const std::string& pipeline) {
  std::set<std::string> pipelines;
  for (const SettingEntry& entry : setting_table())
    pipelines.insert(entry.pipelines.begin(), entry.pipelines.end());
  pipelines.erase("all");
  if (!pipeline.empty() && !pipelines.contains(pipeline))
    throw error(Failure::usage, "settings: {}",
                unknown_name("pipeline", pipeline, {pipelines.begin(), pipelines.end()}));
  fmt::print("{}", settings_help(pipeline));
  return 0;
}

// As `init` takes them, "pop=", or as `command` does, "POP=".
std::vector<std::string> setting_beginnings(bool as_variables) {
  std::vector<std::string> words;
  for (const SettingEntry& entry : setting_table())
    if (entry.kept != Kept::no || (as_variables && entry.name == "run"))
      words.push_back((as_variables ? entry.variable() : entry.name) + "=");
  return words;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-run");
  std::vector<std::string> words;
  Options options;
  command.arguments(
      words, "COMMAND RUN [KEY=VALUE]...",
      {{"init RUN KEY=VALUE...", "begin a run with these settings, or make sure that it has them"},
       {"plan RUN pop=N evals=N window=N [chunk=N]",
        "the graph of a run without generations, as rules of make"},
       {"propose RUN", "the next robots of a run without generations"},
       {"train RUN", "the robots of a generation"},
       {"fail RUN", "count slots that cannot be trained as failed"},
       {"settings [PIPELINE]", "what the settings are, in make's capital letters"},
       {"slots RUN", "a table of all slots, with state and fitness, share done or what failed"},
       {"command RUN [VARIABLE=VALUE]...",
        "the make command that began the run, with these variables instead"}});
  command.option("--robots", options.robots, "N",
                 "propose: make sure that there are so many; required");
  command.option("--generation", options.generation, "N", "whose slots to train or to fail");
  command.option(
      "--slot", options.slots, "K",
      "train this one, or several as in 3-8 (repeatable); those done are left alone [all]");
  command.option("--why", options.why, "TEXT", "fail: the reason, kept with the robot");
  command.option("--isa", options.isa, "NAME",
                 "train: no newer instruction set than this, e.g. x86-64-v3; the results are the "
                 "same [the processor's]");
  command.suggestions("init", [] { return setting_beginnings(false); });
  command.suggestions("command", [] { return setting_beginnings(true); });
  command.jobs_option();
  command.progress_option();
  command.example("evo-run train runs/walker --generation 3 --slot $SLURM_ARRAY_TASK_ID -j1",
                  "one robot of the fourth generation, as a job of a scheduler's array");
  command.example("evo-run command runs/walker RUN=runs/again SEED=2",
                  "how to do the run again with another seed");
  command.example("evo-run slots runs/walker | awk '$4 == \"failed\"'",
                  "trainings that failed, with the reason");

  return command.run(argc, argv, [&] {
    const std::vector<std::string> verbs{"init", "plan",     "propose", "train",
                                         "fail", "settings", "slots",   "command"};
    if (words.empty()) throw error(Failure::usage, "one of {} is needed", fmt::join(verbs, ", "));
    if (std::find(verbs.begin(), verbs.end(), words[0]) == verbs.end())
      throw error(Failure::usage, "'{}' is none of {}{}", words[0], fmt::join(verbs, ", "),
                  did_you_mean(words[0], verbs));
    if (words[0] == "settings") {
      if (words.size() > 2) throw error(Failure::usage, "settings: name one pipeline");
      return print_settings(words.size() == 2 ? words[1] : "");
    }
    if (words.size() < 2) throw error(Failure::usage, "{}: name a run folder", words[0]);
    const std::string folder = words[1];
    if (words[0] == "init") return init(folder, {words.begin() + 2, words.end()});
    if (words[0] == "plan") return print_plan(folder, {words.begin() + 2, words.end()});
    if (words[0] == "command") return print_command(folder, {words.begin() + 2, words.end()});
    if (words.size() > 2) throw error(Failure::usage, "{}: name one run folder", words[0]);
    if (options.isa) select_isa(*options.isa);
    if (words[0] == "train") return train(command, folder, options);
    if (words[0] == "fail") return fail(folder, options);
    if (words[0] == "slots") return list_slots(folder);
    if (options.robots.value_or(-1) < 0)
      throw error(Failure::usage, "propose: --robots says how many there are to be");
    return propose(RunFolder(folder), *options.robots);
  });
}
