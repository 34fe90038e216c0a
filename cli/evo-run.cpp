// evo-run: a run folder from the side of whoever drives it. Pipelines and
// schedulers begin a run, train its slots by number, and ask how they stand.
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <thread>

#include "cli/robots.h"
#include "cli/run_command.h"
#include "cli/shell_words.h"
#include "cli/steady.h"
#include "cli/training.h"
#include "formats/io/files.h"
#include "formats/io/lock.h"
#include "formats/run/run.h"
#include "formats/training/training_log.h"
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

// The options of evo-train that a run's settings stand for in a generation; errors begin
// with `file`.
std::vector<std::string> training_words(const RunSettings& settings, int generation,
                                        const std::string& file) {
  std::vector<std::string> words{"evo-train"};
  const auto give = [&](const char* option, const std::string& value) {
    words.emplace_back(option);
    words.push_back(value);
  };
  give("--task", settings.text("task"));
  if (settings.find("rungs") != nullptr) {
    give("--steps", fmt::format("{}", settings.steps(generation)));
    if (settings.goes_on(generation)) words.emplace_back("--keep-checkpoint");
  } else {
    give("--steps", settings.text("steps"));
    if (settings.find("founder_steps") != nullptr)
      give("--founder-steps", settings.text("founder_steps"));
  }
  if (settings.text("algo") != "profile") give("--algo", settings.text("algo"));
  give("--train", settings.text("train"));
  if (settings.text("physics") != "task") give("--physics", settings.text("physics"));
  give("--seed", settings.text("seed"));
  give("--failures", "skip");
  if (const std::string* more = settings.find("train_options"))
    for (std::string& word : cli::shell_words(*more, file + "train_options"))
      words.push_back(std::move(word));
  return words;
}

// Does the work with what these words mean to evo-train; errors are told in our name.
int with_training(const cli::Command& asked, std::vector<std::string> words,
                  const std::function<int(cli::Command&, cli::TrainingOptions&)>& work) {
  std::vector<char*> arguments;
  arguments.reserve(words.size());
  for (std::string& word : words) arguments.push_back(word.data());
  cli::Command command(asked.name(), "");
  cli::TrainingOptions options;
  options.add_to(command);
  return command.run(static_cast<int>(arguments.size()), arguments.data(),
                     [&] { return work(command, options); });
}

// Whether these settings could train anything: a run that is begun keeps them.
int check_training(const cli::Command& asked, const RunSettings& settings) {
  if (const std::string* other = settings.find("evaluate"); other && !other->empty()) return 0;
  for (const char* needed : {"task", "steps", "algo", "train", "physics", "seed"})
    if (settings.find(needed) == nullptr) return 0;
  return with_training(asked, training_words(settings, 0, ""),
                       [](cli::Command&, const cli::TrainingOptions& options) {
                         (void)options.task.load();
                         (void)options.founder_settings();
                         return 0;
                       });
}

int init(const cli::Command& asked, const std::string& folder,
         const std::vector<std::string>& words) {
  const RunSettings settings = RunSettings::from_words(words);
  const int status = check_training(asked, settings);
  if (status == 0) RunFolder::create(folder, settings);
  return status;
}

// ---- train ------------------------------------------------------------------------

// "7" and "3-8".
std::vector<int> slot_numbers(const std::vector<std::string>& words) {
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
    for (int k = first; k <= last; ++k) numbers.push_back(k);
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

// Who goes on from the controllers of others, or of another run.
enum class Heirs { none, children, founders_too };

Heirs heirs(const RunSettings& settings) {
  const std::string* inherit = settings.find("inherit");
  if (inherit == nullptr) return Heirs::none;
  return *inherit == "all"   ? Heirs::founders_too
         : *inherit == "yes" ? Heirs::children
                             : Heirs::none;
}

// The command line of evo-train for this run.
std::vector<std::string> training_words(const RunFolder& run, int generation) {
  const RunSettings& settings = run.settings();
  std::vector<std::string> words =
      training_words(settings, generation, (run.path() / "run.yaml").string() + ": ");
  words.insert(words.begin() + 1, {"--out-dir", run.policies().string(), "--log-dir",
                                   run.logs().string(), "--resume"});
  if (heirs(settings) != Heirs::none)
    words.insert(words.begin() + 1, {"--init", run.policies().string()});
  return words;
}

void write_slot(const RunFolder& run, SlotAddress address, const Robot& robot) {
  cli::RobotWriter out(run.slot(address).string());
  out.write(robot);
  out.finish();
}

// A slot's file appears as soon as its robot is trained. Slots that have one are
// left alone; a survivor's policy is there already, made with the same settings,
// and gives its fitness back without a training. One that failed has failed: it is
// not tried again in every generation that it survives.
int train_slots(const cli::Command& asked, const RunFolder& run, int generation,
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

  const auto work = [&](cli::Command& command, cli::TrainingOptions& options) {
    if (heirs(run.settings()) == Heirs::founders_too)
      options.founders_from = (fs::path(run.settings().text("founders")) / "policies").string();
    options.sharded = run.layout() == Layout::steady;
    options.in_rungs = run.settings().find("rungs") != nullptr;
    command.jobs = asked.jobs;
    command.progress = asked.progress;
    command.quiet |= asked.quiet;
    std::mutex timing;
    const int status =
        cli::train_robots(command, options, robots, [&](const cli::Trained& trained) {
          const SlotAddress& address = addresses[trained.index];
          if (!trained.known) {
            const std::lock_guard lock(timing);
            run.add_timing({robots[trained.index].id, address, trained.started, trained.seconds,
                            trained.steps, trained.robot.has_value()});
          }
          if (!trained.robot) return;
          write_slot(run, address, *trained.robot);
        });
    if (status != 0) asked.warn("interrupted; give the same command again to go on");
    return status;
  };
  return with_training(asked, training_words(run, generation), work);
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
  if (fs::exists(run.scores(options.generation))) return 0;
  std::vector<int> slots = slot_numbers(options.slots);
  const int population = run.population_size(options.generation);  // which must be there
  if (slots.empty())
    for (int k = 0; k < population; ++k) slots.push_back(k);
  const LockFile lock(run.lock());
  take_slots(lock, run, options.generation, slots);
  const RunningMark mark(run, options.generation,
                         options.slots.empty() ? std::vector<std::string>{"all"} : options.slots);
  try {
    const int status = train_slots(command, run, options.generation, slots);
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
  return cli::propose_robots(run, robots);
}

// ---- fail -------------------------------------------------------------------------

// The slots that could not be trained count as failed, so that the run goes on.
int fail(const std::string& folder, const Options& options) {
  const RunFolder run(folder);
  const std::vector<int> slots = slot_numbers(options.slots);
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
      "{:.2f}", read_training_log(history.folder().log(slot.robot)).step / std::max(1.0, steps));
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
  fmt::print("{}\n", cli::run_command(setting, variables));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-run", "begins a run folder, trains its slots, says how they stand");
  std::vector<std::string> words;
  Options options;
  command.arguments(
      words, "COMMAND RUN [KEY=VALUE]...",
      {{"init RUN KEY=VALUE...", "begin a run with these settings, or make sure that it has them"},
       {"propose RUN", "the next robots of a run without generations"},
       {"train RUN", "the robots of a generation"},
       {"fail RUN", "count slots that cannot be trained as failed"},
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
  command.jobs_option();
  command.progress_option();
  command.example("evo-run train runs/walker --generation 3 --slot $SLURM_ARRAY_TASK_ID -j1",
                  "one robot of the fourth generation, as a job of a scheduler's array");
  command.example("evo-run command runs/walker RUN=runs/again SEED=2",
                  "how to do the run again with another seed");
  command.example("evo-run slots runs/walker | awk '$4 == \"failed\"'",
                  "trainings that failed, with the reason");

  return command.run(argc, argv, [&] {
    const std::vector<std::string> verbs{"init", "propose", "train", "fail", "slots", "command"};
    if (words.empty()) throw error(Failure::usage, "one of {} is needed", fmt::join(verbs, ", "));
    if (std::find(verbs.begin(), verbs.end(), words[0]) == verbs.end())
      throw error(Failure::usage, "'{}' is none of {}{}", words[0], fmt::join(verbs, ", "),
                  did_you_mean(words[0], verbs));
    if (words.size() < 2) throw error(Failure::usage, "{}: name a run folder", words[0]);
    const std::string folder = words[1];
    if (words[0] == "init") return init(command, folder, {words.begin() + 2, words.end()});
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
