// Fast arithmetic against exact: over many starts that differ by next to nothing, the
// returns of whole episodes have the same distribution (docs/physics.md, "Accuracy").
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "libevo/control/evaluate.h"

namespace evo {
namespace {

const DataFolders data{std::filesystem::path(EVO_SOURCE_DIR) / "tasks"};

// Raw length 1e-6, in voxels.
constexpr double start_shift = 1e-5;

// The greatest difference of the two empirical distribution functions.
double kolmogorov_smirnov(std::vector<double> a, std::vector<double> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double greatest = 0.0;
  for (const std::vector<double>* values : {&a, &b}) {
    for (const double x : *values) {
      const auto share = [x](const std::vector<double>& v) {
        const auto below = std::upper_bound(v.begin(), v.end(), x) - v.begin();
        return static_cast<double>(below) / static_cast<double>(v.size());
      };
      greatest = std::max(greatest, std::fabs(share(a) - share(b)));
    }
  }
  return greatest;
}

std::vector<double> returns(const std::string& task_name, const std::string& profile, int starts,
                            int max_steps) {
  TaskSpec task = load_task(task_name, data);
  set_physics(task, load_physics(profile, data));
  const Arena arena(task, Body::from_rows({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"}));
  EvaluationSettings settings;
  settings.episodes = starts;
  settings.jitter = start_shift;
  settings.max_steps = max_steps;
  return evaluate(arena, travelling_wave(arena.action_length(), 0.5, 25.0, 0.7), settings).returns;
}

double distance(const std::string& task, int starts, int max_steps) {
  return kolmogorov_smirnov(returns(task, "evogym", starts, max_steps),
                            returns(task, "fast", starts, max_steps));
}

}  // namespace

TEST_CASE("the distance of distributions") {
  CHECK(kolmogorov_smirnov({1, 2, 3, 4}, {4, 3, 2, 1}) == 0.0);
  CHECK(kolmogorov_smirnov({1, 2}, {3, 4}) == 1.0);
  CHECK(kolmogorov_smirnov({1, 2, 3, 4}, {1, 2, 3, 9}) == 0.25);
}

TEST_CASE("fast: returns are distributed as the exact ones over short episodes") {
  constexpr int starts = 64;
  // The distance that two samples of one distribution exceed once in twenty times.
  const double limit = 1.36 * std::sqrt(2.0 / starts);
  for (const char* task : {"Walker-v0", "Carrier-v0"}) {
    INFO(task);
    CHECK(distance(task, starts, 120) < limit);
  }
}

TEST_CASE("fast: returns are distributed as the exact ones", "[.slow]") {
  constexpr int starts = 256;
  constexpr double limit = 0.12;
  for (const char* task : {"Walker-v0", "BridgeWalker-v0", "BidirectionalWalker-v0", "Carrier-v0",
                           "Pusher-v0", "Thrower-v0", "Catcher-v0", "Climber-v0", "UpStepper-v0",
                           "ObstacleTraverser-v0", "PlatformJumper-v0", "CaveCrawler-v0",
                           "AreaMaximizer-v0", "Flipper-v0", "Jumper-v0", "Balancer-v0"}) {
    const std::vector<double> exact = returns(task, "evogym", starts, 0);
    const double found = kolmogorov_smirnov(exact, returns(task, "fast", starts, 0));
    const auto [low, high] = std::minmax_element(exact.begin(), exact.end());
    WARN(task << '\t' << found << '\t' << *low << '\t' << *high);
    CHECK(found < limit);
  }
}

}  // namespace evo
