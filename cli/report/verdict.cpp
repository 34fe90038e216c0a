#include "cli/report/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "cli/report/markup.h"

namespace evo::report {
namespace {

// Fitness of the best of a generation's scored robots.
std::optional<double> best_of(const Run& run, const Generation& generation) {
  std::optional<double> best;
  for (const std::size_t member : generation.members)
    if (const auto& fitness = run.robots[member].fitness; fitness && (!best || *fitness > *best))
      best = fitness;
  return best;
}

// What the champion's training, or evolution from the first generation, has added.
double gain(const Run& run, double best) {
  double most = 0;
  const auto& curve = run.robots[*run.champion].training.curve;
  if (!curve.empty()) most = best - curve.front().evaluation;
  std::vector<double> first;
  for (const std::size_t member : run.generations.front().members)
    if (const auto& fitness = run.robots[member].fitness) first.push_back(*fitness);
  if (!first.empty()) {
    const auto middle = first.begin() + static_cast<std::ptrdiff_t>(first.size() / 2);
    std::nth_element(first.begin(), middle, first.end());
    most = std::max(most, best - *middle);
  }
  return most;
}

std::string doubled(const std::string& number) {  // "512000" as "1024000"
  const long value = std::strtol(number.c_str(), nullptr, 10);
  return value > 0 ? fmt::format("{}", 2 * value) : number;
}

void say_progress(const Run& run, double best, Verdict& verdict) {
  const auto start = best_of(run, run.generations.front());
  const std::size_t number = *run.champion + 1;
  const std::size_t since = run.robots.size() - number;
  if (start && best > *start)
    verdict.sentences.push_back(fmt::format("Improved from {} in generation {} to {}.",
                                            shown(start), run.generations.front().number,
                                            shown(best)));
  else
    verdict.sentences.push_back(fmt::format(
        "The best fitness, {}, was there in the first generation already.", shown(best)));
  verdict.sentences.push_back(
      since == 0
          ? fmt::format("The last improvement is the last robot trained, number {}.", number)
          : fmt::format("The last improvement was robot {} of {}.", number, run.robots.size()));
  if (const auto replay = run.replays.find(*run.champion); replay != run.replays.end())
    verdict.sentences.push_back(fmt::format("Its episode of {} steps: {}.",
                                            replay->second["steps"].get<int>(),
                                            replay->second["ending"].get<std::string>()));
}

// Luck in the evaluation that made it champion shows from shifted starts.
bool say_robustness(const Run& run, double best, Verdict& verdict) {
  const auto& score = run.robots[*run.champion].training.final_score;
  if (!score) return true;
  constexpr double fair = 0.8;  // of the fitness
  const bool robust = score->mean >= best - (1 - fair) * std::abs(best);
  verdict.sentences.push_back(
      fmt::format("From shifted starts the champion earns {}{}.",
                  with_error(score->mean, score->standard_error),
                  robust ? "" : ", much less: part of its fitness is luck"));
  return robust;
}

bool still_rising(const Run& run) {
  const Training& training = run.robots[*run.champion].training;
  constexpr double late = 0.9;  // of the training
  return training.steps > 0 &&
         static_cast<double>(training.best_step) >= late * static_cast<double>(training.steps);
}

void advise(const Run& run, double best, bool robust, Verdict& verdict) {
  const std::string folder = "runs/" + run.label;
  const auto add = [&](const std::string& why, const std::string& line) {
    verdict.commands.push_back({why, line});
  };
  const bool over = run.evaluations() && run.robots.size() >= *run.evaluations();
  if (!over) add("go on where it is", run_command(run, {}));
  const std::size_t since = run.robots.size() - (*run.champion + 1);
  const bool settled = 4 * since >= run.robots.size();  // nothing better for a quarter of the run
  if (verdict.level == Verdict::Level::bad || still_rising(run))
    add("train each robot longer",
        run_command(run, {{"RUN", folder + "-longer"}, {"STEPS", doubled(run.setting("steps"))}}));
  if (over && !settled)
    add("evolve on: it was still improving",
        run_command(run,
                    {{"RUN", folder + "-more"}, {"EVALS", doubled(run.setting("evaluations"))}}));
  if (over && settled && verdict.level != Verdict::Level::bad)
    add("enough: see whether another seed agrees",
        run_command(run, {{"RUN", folder + "-again"},
                          {"SEED", fmt::format("{}", 1 + std::strtol(run.setting("seed").c_str(),
                                                                     nullptr, 10))}}));
  if (!robust || !run.robots[*run.champion].training.final_score)
    add("measure the champion from other starts",
        fmt::format("evo-eval {}/best.json --episodes 20 --jitter 1e-3 -o -", folder));
  add("its way as a figure",
      fmt::format("evo-render {}/best.rollout.h5 --strip 6 --theme paper -o champion.pdf", folder));
  (void)best;
}

}  // namespace

std::string run_command(const Run& run,
                        const std::vector<std::pair<std::string, std::string>>& changed) {
  std::vector<std::pair<std::string, std::string>> words{
      {"RUN", "runs/" + run.label},       {"TASK", run.setting("task")},
      {"POP", run.setting("population")}, {"EVALS", run.setting("evaluations")},
      {"STEPS", run.setting("steps")},    {"SEED", run.setting("seed")},
      {"SHAPE", run.setting("shape")},    {"TRAIN", run.setting("train")},
      {"ALGO", run.setting("algo")}};
  std::string line = fmt::format("make -f scripts/{}.mk", run.setting("method"));
  for (auto& [name, value] : words) {
    for (const auto& [other, instead] : changed)
      if (other == name) value = instead;
    if (value.empty() || (name == "TRAIN" && value == "default") ||
        (name == "ALGO" && value == "ppo"))
      continue;
    const bool plain = value.find_first_not_of(
                           "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./") ==
                       std::string::npos;
    line += fmt::format(" {}={}", name, plain ? value : "'" + value + "'");
  }
  return line + " -j8";
}

Verdict judge(const Run& run) {
  Verdict verdict;
  if (!run.champion) {
    verdict.level = run.robots.empty() ? Verdict::Level::doubt : Verdict::Level::bad;
    verdict.headline =
        run.robots.empty() ? "Nothing has been trained yet" : "Every training failed";
    if (!run.robots.empty())
      verdict.sentences.push_back("The first failure: " + run.robots.front().failure + ".");
    return verdict;
  }
  const double best = *run.robots[*run.champion].fitness;
  const bool learnt = gain(run, best) >= least_gain;
  const bool over = run.evaluations() && run.robots.size() >= *run.evaluations();
  verdict.level = !learnt ? Verdict::Level::bad
                  : over  ? Verdict::Level::good
                          : Verdict::Level::doubt;
  say_progress(run, best, verdict);
  const bool robust = say_robustness(run, best, verdict);
  if (learnt && !robust) verdict.level = Verdict::Level::doubt;
  if (const std::size_t failures = run.failures(); failures > 0) {
    verdict.sentences.push_back(
        fmt::format("{} of {} trainings failed.", failures, run.robots.size()));
    if (5 * failures > run.robots.size() && learnt) verdict.level = Verdict::Level::doubt;
  }
  verdict.headline = !learnt  ? "Nothing was learnt"
                     : !over  ? "Learning, and not over"
                     : robust ? "It worked"
                              : "It worked, with luck";
  advise(run, best, robust, verdict);
  return verdict;
}

}  // namespace evo::report
