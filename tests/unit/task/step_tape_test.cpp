// Gradients of rewards and observations against central differences, in all 32 tasks.
#include "libevo/task/step_tape.h"

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "formats/task/task.h"
#include "libevo/base/random.h"

namespace evo {
namespace {

constexpr int lanes = 8;
constexpr int window = 3;  // steps

const Body& body() {
  static const Body it = Body::from_rows({"HVHVH", "VSHSV", "HHRHH", "V.V.V", "H.H.H"});
  return it;
}

struct Objective {
  bool of_rewards = true;  // else of observations
  std::vector<double> by_observations;
};

// The lanes' sums in some steps from `start` on, whose first has these actions.
std::vector<double> sums(VecEnv& env, const std::vector<std::vector<std::uint8_t>>& start,
                         const std::vector<std::vector<double>>& actions,
                         const Objective& objective, std::vector<StepTape>* tapes = nullptr) {
  std::vector<double> sum(lanes, 0.0);
  for (int i = 0; i < lanes; ++i) env.load(i, start[static_cast<std::size_t>(i)]);
  for (std::size_t t = 0; t < window; ++t) {
    env.step(actions[t], {}, nullptr, tapes == nullptr ? nullptr : &(*tapes)[t]);
    const std::size_t length = env.observations().size() / lanes;
    for (std::size_t i = 0; i < lanes; ++i) {
      if (objective.of_rewards)
        sum[i] += env.rewards()[i];
      else
        for (std::size_t k = i * length; k < (i + 1) * length; ++k)
          sum[i] += objective.by_observations[k] * env.observations()[k];
    }
  }
  return sum;
}

std::vector<double> random_values(std::size_t count, double middle, double scale, Stream& random) {
  std::vector<double> values(count);
  for (double& value : values) value = middle + scale * random.gaussian();
  return values;
}

// Relative errors of derivatives along random directions of a task's first actions.
std::vector<double> errors_of(const std::string& task, bool of_rewards) {
  const Arena arena(load_task(task, {"tasks"}), body());
  VecEnv env(arena, lanes);
  Stream random(1, "gradients", task);
  for (int i = 0; i < lanes; ++i)
    env.reset(i,
              {arena.draw(1, static_cast<std::uint64_t>(i)), 0.01, static_cast<std::uint64_t>(i)});
  const auto length = static_cast<std::size_t>(lanes * arena.action_length());
  std::vector<double> errors;
  for (const int steps : {0, 3, 12, 25}) {
    for (int t = 0; t < steps; ++t) env.step(random_values(length, 1.1, 0.25, random));
    std::vector<std::vector<std::uint8_t>> start;
    for (int i = 0; i < lanes; ++i) start.push_back(env.save(i));
    Objective objective{of_rewards, random_values(env.observations().size(), 0.0, 1.0, random)};
    std::vector<std::vector<double>> actions;
    for (int t = 0; t < window; ++t) actions.push_back(random_values(length, 1.1, 0.1, random));
    std::vector<StepTape> tapes;
    for (int t = 0; t < window; ++t) tapes.emplace_back(0.0);
    sums(env, start, actions, objective, &tapes);
    std::vector<std::uint8_t> is_valid(lanes, 1);
    for (std::size_t i = 0; i < lanes; ++i)
      if (env.terminated()[i] != 0 || env.status(static_cast<int>(i)) != LaneStatus::done)
        is_valid[i] = 0;

    std::vector<Gradient> gradients(lanes, zero_gradient(arena.model()));
    std::vector<double> by_actions(length);
    for (auto tape = tapes.rbegin(); tape != tapes.rend(); ++tape) {
      tape->pull_back(std::vector<double>(lanes, of_rewards ? 1.0 : 0.0),
                      of_rewards ? std::span<const double>() : objective.by_observations, gradients,
                      by_actions);
    }
    constexpr double eps = 1e-5;
    const std::vector<double> way = random_values(length, 0.0, 1.0, random);
    const auto along = [&](double distance) {
      std::vector<std::vector<double>> changed = actions;
      for (std::size_t k = 0; k < length; ++k) changed[0][k] += distance * way[k];
      return sums(env, start, changed, objective);
    };
    const std::vector<double> high = along(eps);
    const std::vector<double> low = along(-eps);
    for (std::size_t i = 0; i < lanes; ++i) {
      double exact = 0.0;
      for (std::size_t k = i * length / lanes; k < (i + 1) * length / lanes; ++k)
        exact += by_actions[k] * way[k];
      const double difference = (high[i] - low[i]) / (2.0 * eps);
      if (is_valid[i] != 0)
        errors.push_back(std::abs(difference - exact) / std::max(std::abs(exact), 1e-4));
    }
    for (int i = 0; i < lanes; ++i) env.load(i, start[static_cast<std::size_t>(i)]);
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

}  // namespace

// A few directions change contacts, and what a difference says of those is a jump's.
TEST_CASE("gradients of rewards and observations are central differences in every task") {
  for (const std::string& task : task_names({"tasks"}))
    for (const bool of_rewards : {true, false}) {
      INFO(task << (of_rewards ? ", rewards" : ", observations"));
      const std::vector<double> errors = errors_of(task, of_rewards);
      CHECK(errors[errors.size() / 2] < 1e-6);
    }
}

// `test_task "[.table]"` prints the one of docs/gradients.md.
TEST_CASE("relative errors of gradients, task by task", "[.table]") {
  std::cout << "| task | rewards: median | three of four | worst | observations: median | three of "
               "four | worst |\n"
               "|---|---|---|---|---|---|---|\n";
  for (const std::string& task : task_names({"tasks"})) {
    std::cout << "| " << task;
    for (const bool of_rewards : {true, false}) {
      const std::vector<double> errors = errors_of(task, of_rewards);
      for (const std::size_t at : {errors.size() / 2, errors.size() * 3 / 4, errors.size() - 1})
        std::cout << " | " << fmt::format("{:.0e}", errors[at]);
    }
    std::cout << " |\n";
  }
}

}  // namespace evo
