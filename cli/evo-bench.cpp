// evo-bench: how many control steps per second this machine does.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdio>

#include "cli/command.h"
#include "cli/data.h"
#include "cli/task_options.h"
#include "formats/io/json.h"
#include "formats/io/values.h"
#include "formats/task/task.h"
#include "libevo/base/random.h"
#include "libevo/body/operators.h"
#include "libevo/sim/isa.h"
#include "libevo/task/env.h"

namespace {

using namespace evo;

// Evenly mixed, so that large random bodies come out connected.
constexpr VoxelWeights body_weights{0.2, 0.2, 0.2, 0.2, 0.2};
constexpr int action_sets = 97;  // drawn beforehand and used in turn
constexpr const char* flat_task = "Walker-v0";
constexpr const char* all_tasks = "all";
constexpr int repetitions = 5;  // the median is reported

struct Settings {
  cli::TaskOptions task;
  std::string sizes = "5,10,15,20,25,30,35";
  std::string envs = "1,8";
  std::string isa = "best";
  bool json = false;
  double seconds = 0.5;
};

struct Measurement {
  std::string task;
  Body body;
  std::uint64_t seed = 0;
  int envs = 0;
  int voxels = 0;
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

// A body in a task.
struct Subject {
  TaskSpec task;
  Body body;
};

std::vector<Subject> subjects(const Settings& settings, std::uint64_t seed) {
  std::vector<Subject> found;
  if (settings.task.task == all_tasks) {
    const Body body = Body::from_rows({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"});
    for (const std::string& name : task_names(cli::data_folders())) {
      found.push_back({load_task(name, cli::data_folders()), body});
      change_physics(found.back().task, settings.task.physics, cli::data_folders());
    }
  } else {
    for (const int size : parse_wholes(settings.sizes, "--sizes", 1, most_counted))
      found.push_back({settings.task.load(), random_body(size, size, seed)});
  }
  return found;
}

// Episodes under random actions, begun again as they end.
class Runner {
 public:
  Runner(const Arena& arena, int envs, std::uint64_t seed) : seed_(seed), envs_(arena, envs) {
    Stream random(seed, "bench/actions");
    const std::size_t length =
        static_cast<std::size_t>(envs) * static_cast<std::size_t>(arena.action_length());
    const Physics& physics = arena.task().physics;
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

// Control steps per second of processor time.
double rate_of(Runner& runner, int envs, double seconds) {
  const double start = seconds_used();
  double used = 0.0;
  std::uint64_t steps = 0;
  while (used < seconds) {
    runner.step();
    ++steps;
    used = seconds_used() - start;
  }
  return static_cast<double>(steps) * envs / used;
}

Measurement measure(const Subject& subject, int envs, std::uint64_t seed, double seconds) {
  const auto& [task, body] = subject;
  const Arena arena(task, body);
  Runner runner(arena, envs, seed);
  Measurement result{task.name, body, seed, envs, count_voxels(body), {}};
  rate_of(runner, envs, 0.0);  // allocates what later steps use
  for (int repetition = 0; repetition < repetitions; ++repetition)
    result.rates.push_back(rate_of(runner, envs, seconds));
  std::sort(result.rates.begin(), result.rates.end());
  return result;
}

void print(const Measurement& m, const std::string& isa, bool json) {
  if (json) {
    const Json line{{"task", m.task},
                    {"shape", {m.body.rows, m.body.cols}},
                    {"voxels", m.voxels},
                    {"body", m.body.to_rows()},
                    {"seed", m.seed},
                    {"width", m.envs},
                    {"isa", isa},
                    {"steps_per_second", m.median()},
                    {"steps_per_second_min", m.rates.front()},
                    {"steps_per_second_max", m.rates.back()}};
    fmt::print("{}\n", line.dump());
  } else {
    fmt::print("{:<22} {:>7} {:>6} {:>4} {:>10} {:>9.0f} {:>14.0f}\n", m.task,
               fmt::format("{}x{}", m.body.rows, m.body.cols), m.voxels, m.envs, isa, m.median(),
               m.median() * m.voxels);
  }
  std::fflush(stdout);
}

std::vector<std::string> isas(const std::string& text) {
  if (text == "best") return {best_isa()};
  return text == "all" ? available_isas() : std::vector<std::string>{text};
}

// ---- the tool ------------------------------------------------------------------------

int bench(const Settings& settings, std::uint64_t seed) {
  const std::vector<int> envs = parse_wholes(settings.envs, "--envs", 1, most_counted);
  const std::vector<Subject> measured = subjects(settings, seed);
  const std::vector<std::string> chosen = isas(settings.isa);
  select_isa(chosen.front());  // refused before anything is written
  if (!settings.json)
    fmt::print("{:<22} {:>7} {:>6} {:>4} {:>10} {:>9} {:>14}\n", "task", "shape", "voxels", "envs",
               "isa", "steps/s", "steps*voxels/s");
  for (const std::string& isa : chosen) {
    select_isa(isa);
    for (const Subject& subject : measured)
      for (const int n : envs)
        print(measure(subject, n, seed, settings.seconds), isa, settings.json);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-bench");
  Settings settings;
  settings.task.task = flat_task;
  command.section("What is measured");
  settings.task.add_to(command, "; all: every task of the benchmark, with one 5x5 body");
  command.option("--sizes", settings.sizes, "N,N,..", "random bodies of N x N voxels");
  command.option("--envs", settings.envs, "N,N,..", "environments stepped together");
  command.option("--isa", settings.isa, "NAME",
                 "instruction set, e.g. x86-64-v3, or all, one after the other");
  command.section("How");
  command
      .option("--seconds", settings.seconds, "T",
              "seconds of processor time of a measurement; five are made, the median counts")
      .between(0.0, longest_repetition);
  command.flag("--json", settings.json, "one JSON object a line instead of a table");
  command.seed_option();
  command.example("evo-bench --sizes 5 --envs 8", "a batch of eight 5x5 robots on flat ground");
  command.example("evo-bench --task all --envs 8 --json > tasks.jsonl",
                  "every task, for a program");
  return command.run(argc, argv, [&] { return bench(settings, command.seed); });
}
