// evo-bench: how many control steps per second this machine does.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <numeric>
#include <span>

#include "cli/command.h"
#include "cli/data.h"
#include "cli/robots.h"
#include "cli/task_options.h"
#include "formats/io/json.h"
#include "formats/io/values.h"
#include "formats/task/task.h"
#include "libevo/base/random.h"
#include "libevo/body/operators.h"
#include "libevo/sim/batch.h"
#include "libevo/sim/isa.h"
#include "libevo/task/env.h"

namespace {

using namespace evo;

// Evenly mixed, so that large random bodies come out connected.
constexpr VoxelWeights body_weights{0.2, 0.2, 0.2, 0.2, 0.2};
constexpr int action_sets = 97;  // drawn beforehand and used in turn
constexpr const char* flat_task = "Walker-v0";

struct Settings {
  cli::TaskOptions task;
  std::string sizes = "5,10,15,20,25,30,35";
  std::string envs = "1,8";
  std::string isa = "best";
  bool tasks = false;
  bool mixed = false;
  bool model = false;
  bool json = false;
  int bodies = 1;
  int threads = 1;
  int repetitions = 5;
  double seconds = 0.5;
};

struct Measurement {
  std::string task;
  std::string profile;
  Body body;
  std::uint64_t seed = 0;
  int envs = 0;
  int voxels = 0;             // of a body, on average
  std::vector<double> rates;  // sorted
  double median() const { return rates[rates.size() / 2]; }
};

// Processor time of this thread: what other processes take does not count.
double seconds_used() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

constexpr double longest_repetition = 3600.0;  // s
constexpr int most_counted = 4096;             // of sizes and of environments

Body random_body(int rows, int cols, std::uint64_t seed) {
  Stream random(seed, "bench/body", static_cast<std::uint64_t>(rows));
  return sample_body(rows, cols, body_weights, random);
}

// A body in a task, as often as --tasks, --sizes and --bodies say; with --mixed, the
// first of the bodies that are stepped together.
struct Subject {
  TaskSpec task;
  Body body;
  std::uint64_t seed = 0;  // of the body, if it is a random one, and the actions
};

std::vector<Subject> subjects(const Settings& settings, std::uint64_t seed) {
  std::vector<Subject> found;
  if (settings.tasks) {
    const Body body = Body::from_rows({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"});
    for (const std::string& name : task_names(cli::data_folders())) {
      found.push_back({load_task(name, cli::data_folders()), body, seed});
      settings.task.change_physics(found.back().task);
    }
  } else {
    for (const int size : parse_wholes(settings.sizes, "--sizes", 1, most_counted))
      for (std::uint64_t n = seed; n < seed + static_cast<std::uint64_t>(settings.bodies); ++n)
        found.push_back({settings.task.load(), random_body(size, size, n), n});
  }
  return found;
}

// Episodes under random actions, begun again as they end.
class Runner {
 public:
  Runner(std::span<const Arena* const> arenas, std::uint64_t seed) : seed_(seed), envs_(arenas) {
    Stream random(seed, "bench/actions");
    const int envs = envs_.environments();
    const Arena& last = envs_.arena(envs - 1);
    const std::size_t length =
        envs_.action_offset(envs - 1) + static_cast<std::size_t>(last.action_length());
    const Physics& physics = last.task().physics;
    const double range = physics.max_target - physics.min_target;
    for (auto& set : actions_) {
      for (std::size_t i = 0; i < length; ++i)
        set.push_back(physics.min_target + range * random.uniform());
    }
    for (int i = 0; i < envs; ++i) reset(i);
  }

  void step() {
    envs_.step(actions_[static_cast<std::size_t>(turn_++ % action_sets)]);
    require_stable(envs_);
    for (int i = 0; i < envs_.environments(); ++i) {
      const auto e = static_cast<std::size_t>(i);
      if (envs_.terminated()[e] || envs_.truncated()[e]) reset(i);
    }
  }

 private:
  void reset(int environment) {
    envs_.reset(environment, {envs_.arena(environment).draw(seed_, episodes_++), 0.0, 0});
  }

  std::uint64_t seed_;
  std::uint64_t episodes_ = 0;
  VecEnv envs_;
  std::vector<double> actions_[action_sets];
  std::uint64_t turn_ = 0;
};

double wall_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Control steps per second of one runner by the given clock.
double rate_of(Runner& runner, int envs, double seconds, double (*clock)()) {
  const double start = clock();
  double used = 0.0;
  std::uint64_t steps = 0;
  while (used < seconds) {
    runner.step();
    ++steps;
    used = clock() - start;
  }
  return static_cast<double>(steps) * envs / used;
}

// What `envs` environments are of: one body, or each another one of its shape.
std::deque<Arena> arenas_of(const Subject& subject, int envs, bool mixed) {
  const auto& [task, body, seed] = subject;
  std::deque<Arena> arenas;
  arenas.emplace_back(task, body);
  for (int i = 1; mixed && i < envs; ++i)
    arenas.emplace_back(task,
                        random_body(body.rows, body.cols, seed + static_cast<std::uint64_t>(i)));
  return arenas;
}

// One thread is measured in its processor time, several in the time that passes:
// what they take from one another is to count.
Measurement measure(const Subject& subject, int envs, const Settings& settings) {
  const auto& [task, body, seed] = subject;
  const std::deque<Arena> arenas = arenas_of(subject, envs, settings.mixed);
  std::vector<const Arena*> lanes;
  for (std::size_t i = 0; i < static_cast<std::size_t>(envs); ++i)
    lanes.push_back(&arenas[i % arenas.size()]);
  const auto clock = settings.threads == 1 ? seconds_used : wall_clock;
  std::vector<Runner> runners;
  runners.reserve(static_cast<std::size_t>(settings.threads));
  for (int i = 0; i < settings.threads; ++i)
    runners.emplace_back(lanes, seed + static_cast<std::uint64_t>(i));
  int voxels = 0;
  for (const Arena* arena : lanes) voxels += count_voxels(arena->robot());
  Measurement result{task.name, cli::profile_name(task.physics), body, seed, envs, voxels / envs,
                     {}};
  ThreadPool pool(settings.threads);
  if (pool.threads() < settings.threads)
    throw error(Failure::work, "--threads: only {} of {} could be started", pool.threads(),
                settings.threads);
  for (int repetition = -1; repetition < settings.repetitions; ++repetition) {
    const bool warm_up = repetition < 0;  // allocates what later steps use
    std::vector<double> rates(runners.size());
    // Each takes as long as any thread needs to begin the next.
    pool.run(runners.size(), [&](std::size_t i, int /*worker*/) {
      rates[i] = rate_of(runners[i], envs, warm_up ? 0.0 : settings.seconds, clock);
    });
    if (!warm_up) result.rates.push_back(std::accumulate(rates.begin(), rates.end(), 0.0));
  }
  std::sort(result.rates.begin(), result.rates.end());
  return result;
}

class Report {
 public:
  explicit Report(const Settings& settings)
      : json_(settings.json), mixed_(settings.mixed), threads_(settings.threads) {
    if (!json_)
      fmt::print("{:<24} {:>7} {:>6} {:>5} {:>10} {:>7} {:>12} {:>14}\n", "task", "shape", "voxels",
                 "envs", "isa", "profile", "steps/s", "steps*voxels/s");
  }

  void add(const Measurement& m, const std::string& isa) const {
    if (json_) {
      const Json line{{"task", m.task},
                      {"shape", {m.body.rows, m.body.cols}},
                      {"voxels", m.voxels},
                      {"body", m.body.to_rows()},
                      {"seed", m.seed},
                      {"width", m.envs},
                      {"isa", isa},
                      {"profile", m.profile},
                      {"mixed", mixed_},
                      {"threads", threads_},
                      {"steps_per_second", m.median()},
                      {"steps_per_second_min", m.rates.front()},
                      {"steps_per_second_max", m.rates.back()}};
      fmt::print("{}\n", line.dump());
    } else {
      fmt::print("{:<24} {:>7} {:>6} {:>5} {:>10} {:>7} {:>12.0f} {:>14.0f}\n", m.task,
                 shape(m.body), m.voxels, m.envs, isa, m.profile, m.median(),
                 m.median() * m.voxels);
    }
    std::fflush(stdout);
  }

  static std::string shape(const Body& body) { return fmt::format("{}x{}", body.rows, body.cols); }

 private:
  bool json_;
  bool mixed_;
  int threads_;
};

std::vector<std::string> isas(const std::string& text) {
  if (text == "best") return {best_isa()};
  return text == "all" ? available_isas() : std::vector<std::string>{text};
}

// ---- compiling and memory ----------------------------------------------------------

constexpr int builds = 20;                  // of which the quickest counts
constexpr int steps_to_settle = 200;        // until contact lists have their size
constexpr std::size_t lanes_of_memory = 8;  // that share the arrays they are stepped in

void describe_model(const Subject& subject, bool json) {
  double build = HUGE_VAL;
  for (int i = 0; i < builds; ++i) {
    const double start = seconds_used();
    const Arena arena(subject.task, subject.body);
    build = std::min(build, seconds_used() - start);
  }
  const Arena arena(subject.task, subject.body);
  Batch batch(lanes_of_memory);
  Stream random(subject.seed, "bench/targets");
  const Physics& physics = arena.task().physics;
  for (std::size_t lane = 0; lane < batch.lanes(); ++lane) batch.place(lane, arena.model());
  for (int t = 0; t < steps_to_settle; ++t) {
    for (std::size_t lane = 0; lane < batch.lanes(); ++lane)
      for (double& target : batch.targets(lane))
        target = physics.min_target + (physics.max_target - physics.min_target) * random.uniform();
    batch.step();
  }
  const std::size_t bytes = batch.bytes() / batch.lanes();
  const int voxels = count_voxels(subject.body);
  if (json) {
    const Json line{{"task", subject.task.name}, {"shape", {subject.body.rows, subject.body.cols}},
                    {"voxels", voxels},          {"points", arena.model().points()},
                    {"build_seconds", build},    {"bytes_per_environment", bytes}};
    fmt::print("{}\n", line.dump());
  } else {
    fmt::print("{:<24} {:>7} {:>6} {:>7} {:>10.3f} {:>9.1f}\n", subject.task.name,
               Report::shape(subject.body), voxels, arena.model().points(), 1e3 * build,
               1e-3 * static_cast<double>(bytes));
  }
}

int describe_models(const Settings& settings, std::uint64_t seed) {
  if (!settings.json)
    fmt::print("{:<24} {:>7} {:>6} {:>7} {:>10} {:>9}\n", "task", "shape", "voxels", "points",
               "build, ms", "kB/env");
  for (const Subject& subject : subjects(settings, seed)) describe_model(subject, settings.json);
  return 0;
}

// ---- the tool ------------------------------------------------------------------------

int bench(const Settings& settings, std::uint64_t seed) {
  if (settings.repetitions < 1)
    throw error(Failure::usage, "--repetitions must be at least 1, got {}", settings.repetitions);
  if (settings.threads < 1 || settings.threads > cli::most_threads)
    throw error(Failure::usage, "--threads must be from 1 to {}, got {}", cli::most_threads,
                settings.threads);
  if (!(settings.seconds >= 0.0 && settings.seconds <= longest_repetition))
    throw error(Failure::usage, "--seconds must be from 0 to {}, got {}", longest_repetition,
                settings.seconds);
  if (settings.bodies < 1)
    throw error(Failure::usage, "--bodies must be at least 1, got {}", settings.bodies);
  if (settings.bodies > 1 && settings.tasks)
    throw error(Failure::usage, "--bodies: --tasks has one body for all; leave one of them out");
  if (settings.mixed && (settings.tasks || settings.model))
    throw error(Failure::usage, "--mixed: {} is about one body; leave one of them out",
                settings.tasks ? "--tasks" : "--model");
  if (settings.model) return describe_models(settings, seed);
  const std::vector<int> envs = parse_wholes(settings.envs, "--envs", 1, most_counted);
  const std::vector<Subject> measured = subjects(settings, seed);
  const std::vector<std::string> chosen = isas(settings.isa);
  select_isa(chosen.front());  // refused before anything is written
  const Report report(settings);
  for (const std::string& isa : chosen) {
    select_isa(isa);
    for (const Subject& subject : measured)
      for (const int n : envs) report.add(measure(subject, n, settings), isa);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-bench");
  Settings settings;
  settings.task.task = flat_task;
  command.section("What is measured");
  settings.task.add_to(command);
  command.option("--sizes", settings.sizes, "N,N,..", "bodies of N x N voxels");
  command.option("--bodies", settings.bodies, "N",
                 "random bodies of each size, a line each: those of --seed, and the N-1 after it");
  command.flag("--tasks", settings.tasks,
               "all tasks, with one 5x5 body, instead of --task and --sizes");
  command.option("--envs", settings.envs, "N,N,..", "environments stepped together");
  command.flag("--mixed", settings.mixed,
               "each of these another random body, those of --seed and of the numbers after it, "
               "instead of one body in all");
  command.option("--threads", settings.threads, "N",
                 "batches of environments at a time, one per thread");
  command.option("--isa", settings.isa, "NAME",
                 "instruction set, e.g. x86-64-v3, or all, one after the other");
  command.flag("--model", settings.model,
               "instead of speed: time to compile a world, memory an environment takes");
  command.section("How");
  command.option("--repetitions", settings.repetitions, "N", "of which the median is reported");
  command.option("--seconds", settings.seconds, "T",
                 "length of one repetition, s of processor time (of wall time with --threads)");
  command.flag("--json", settings.json, "one JSON object a line instead of a table");
  command.seed_option();
  command.example("evo-bench --sizes 5 --envs 8", "a batch of eight 5x5 robots on flat ground");
  command.example("evo-bench --sizes 5 --envs 16 --mixed", "sixteen robots, no two of them alike");
  command.example("evo-bench --tasks --envs 8 --fast --json > tasks.jsonl",
                  "every task in fast arithmetic, for a program");
  return command.run(argc, argv, [&] { return bench(settings, command.seed); });
}
