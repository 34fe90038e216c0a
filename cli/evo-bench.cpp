// evo-bench: how many control steps a second one core does.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include "cli/command.h"
#include "cli/data.h"
#include "cli/robots.h"
#include "formats/json.h"
#include "formats/task.h"
#include "libevo/base/random.h"
#include "libevo/body/operators.h"
#include "libevo/task/env.h"

namespace {

using namespace evo;

// Evenly mixed, so that large random bodies come out connected.
constexpr VoxelWeights body_weights{0.2, 0.2, 0.2, 0.2, 0.2};
constexpr int action_sets = 97;  // drawn beforehand and used in turn
constexpr const char* flat_task = "Walker-v0";

struct Settings {
  std::string sizes = "5,10,20,35";
  std::string envs = "1,8";
  std::string task = flat_task;
  bool tasks = false;
  bool json = false;
  std::optional<std::string> isa;
  int repetitions = 5;
  double seconds = 0.5;
};

struct Measurement {
  std::string task;
  Body body;
  int envs = 0;
  std::vector<double> rates;  // sorted
  double median() const { return rates[rates.size() / 2]; }
};

// Processor time of this thread: what other processes take does not count.
double seconds_used() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::vector<int> parse_counts(const std::string& text, const std::string& option) {
  std::vector<int> counts;
  for (const double number : cli::parse_numbers(text, option)) {
    if (number < 1 || number > 4096 || number != std::floor(number))
      throw error(Failure::usage, "{}: expected whole numbers in 1..4096, got '{}'", option, text);
    counts.push_back(static_cast<int>(number));
  }
  return counts;
}

// Episodes under random actions, begun again as they end.
class Runner {
 public:
  Runner(const Arena& arena, int envs, std::uint64_t seed)
      : arena_(arena), seed_(seed), envs_(arena, envs) {
    Stream random(seed, "bench/actions");
    const auto length =
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
    for (int i = 0; i < envs_.environments(); ++i) {
      const auto e = static_cast<std::size_t>(i);
      if (envs_.terminated()[e] || envs_.truncated()[e]) reset(i);
    }
  }

 private:
  void reset(int environment) {
    envs_.reset(environment, {arena_.draw(seed_, episodes_++), 0.0, 0});
  }

  const Arena& arena_;
  std::uint64_t seed_;
  std::uint64_t episodes_ = 0;
  VecEnv envs_;
  std::vector<double> actions_[action_sets];
  std::uint64_t turn_ = 0;
};

Measurement measure(const TaskSpec& task, const Body& body, int envs, const Settings& settings,
                    std::uint64_t seed) {
  const Arena arena(task, body);
  Runner runner(arena, envs, seed);
  Measurement result{task.name, body, envs, {}};
  runner.step();  // allocates what later steps use
  for (int repetition = 0; repetition < settings.repetitions; ++repetition) {
    const double start = seconds_used();
    double used = 0.0;
    std::uint64_t steps = 0;
    while (used < settings.seconds) {
      runner.step();
      ++steps;
      used = seconds_used() - start;
    }
    result.rates.push_back(static_cast<double>(steps) * envs / used);
  }
  std::sort(result.rates.begin(), result.rates.end());
  return result;
}

class Report {
 public:
  explicit Report(bool json, std::string isa) : json_(json), isa_(std::move(isa)) {
    if (!json_)
      fmt::print("{:<24} {:>7} {:>6} {:>5} {:>12} {:>14}\n", "task", "shape", "voxels", "envs",
                 "steps/s", "steps*voxels/s");
  }

  void add(const Measurement& m) const {
    const int voxels = count_voxels(m.body);
    if (json_) {
      const Json line{{"task", m.task},
                      {"shape", {m.body.rows, m.body.cols}},
                      {"voxels", voxels},
                      {"width", m.envs},
                      {"isa", isa_},
                      {"profile", "evogym"},
                      {"threads", 1},
                      {"steps_per_second", m.median()},
                      {"steps_per_second_min", m.rates.front()},
                      {"steps_per_second_max", m.rates.back()}};
      fmt::print("{}\n", line.dump());
    } else {
      fmt::print("{:<24} {:>7} {:>6} {:>5} {:>12.0f} {:>14.0f}\n", m.task,
                 fmt::format("{}x{}", m.body.rows, m.body.cols), voxels, m.envs, m.median(),
                 m.median() * voxels);
    }
    std::fflush(stdout);
  }

 private:
  bool json_;
  std::string isa_;
};

Body random_body(int rows, int cols, std::uint64_t seed) {
  Stream random(seed, "bench/body", static_cast<std::uint64_t>(rows));
  return sample_body(rows, cols, body_weights, random);
}

int bench(const Settings& settings, std::uint64_t seed) {
  if (settings.isa) select_isa(*settings.isa);
  if (settings.repetitions < 1)
    throw error(Failure::usage, "--repetitions must be at least 1, got {}", settings.repetitions);
  const std::vector<int> sizes = parse_counts(settings.sizes, "--sizes");
  const std::vector<int> envs = parse_counts(settings.envs, "--envs");
  const DataFolders folders = cli::data_folders();
  const Report report(settings.json, settings.isa.value_or(best_isa()));
  if (settings.tasks) {
    const Body body = Body::from_rows({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"});
    for (const std::string& name : task_names(folders))
      for (const int n : envs)
        report.add(measure(load_task(name, folders), body, n, settings, seed));
    return 0;
  }
  const TaskSpec task = load_task(settings.task, folders);
  for (const int size : sizes)
    for (const int n : envs)
      report.add(measure(task, random_body(size, size, seed), n, settings, seed));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-bench",
                       "control steps a second of one core, random robots and actions");
  Settings settings;
  command.option("--sizes", settings.sizes, "N,N,..", "bodies of N x N voxels");
  command.option("--envs", settings.envs, "N,N,..", "environments stepped together");
  command.option("--task", settings.task, "TASK", "where the bodies of --sizes move");
  command.flag("--tasks", settings.tasks, "all tasks, with one 5x5 body, instead of --sizes");
  command.option("--isa", settings.isa, "NAME", "instruction set to measure, e.g. x86-64-v3");
  command.option("--repetitions", settings.repetitions, "N", "of which the median is reported");
  command.option("--seconds", settings.seconds, "T", "processor time of one repetition, s");
  command.flag("--json", settings.json, "one JSON object a line instead of a table");
  command.seed_option();
  command.example("evo-bench --sizes 5 --envs 8", "a batch of eight 5x5 robots on flat ground");
  command.example("evo-bench --tasks --envs 8 --json > tasks.jsonl", "every task, for a program");
  return command.run(argc, argv, [&] { return bench(settings, command.seed); });
}
