#include "render/report/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "formats/run/settings.h"

namespace evo::report {
namespace {

// The smallest gain that is called one, in returns; of the benchmark's 32 tasks the
// hardest to earn in, Balancer-v0, ends at 0.16 in the paper's runs.
constexpr double least_gain = 0.1;

std::string where(const Run& run) {
  return run.is_evaluated() ? "by a fitness of its own" : "on " + run.setting("task");
}

// What the champion's training, or evolution from the first generation, has added.
double gain(const Run& run, double best) {
  double most = 0;
  const auto& curve = run.robots[*run.champion].training.curve;
  if (!curve.empty()) most = best - curve.front().evaluation;
  std::vector<double> first;
  for (const auto& score : run.generations.front().scores)
    if (score) first.push_back(*score);
  if (!first.empty()) {
    const auto middle = first.begin() + static_cast<std::ptrdiff_t>(first.size() / 2);
    std::nth_element(first.begin(), middle, first.end());
    most = std::max(most, best - *middle);
  }
  return most;
}

std::string times(long factor, const std::string& number) {  // 2, "512000": "1024000"
  const long value = std::strtol(number.c_str(), nullptr, 10);
  return value > 0 ? fmt::format("{}", factor * value) : number;
}

// "from 2.07", the best of the first generation.
std::string progress(const Run& run, double best) {
  const auto start = run.generations.front().best();
  return start && best > *start ? "from " + run.text(start) : "no better than the first generation";
}

// Whether there was nothing better for a quarter of the run.
bool settled(const Run& run) {
  return 4 * (run.robots.size() - (*run.champion + 1)) >= run.robots.size();
}

// What a program of one's own gives may be small.
bool is_success(const Run& run, double gained) {
  return run.is_evaluated() ? gained > 0 : gained >= least_gain;
}

void say_progress(const Run& run, double best, double gained, Verdict& verdict) {
  const std::size_t number = *run.champion + 1;
  if (!is_success(run, gained))
    verdict.sentences.push_back(fmt::format(
        "The best fitness after {} robots is {}, {} more than it began with{}.", run.robots.size(),
        run.text(best), run.text(gained),
        run.is_evaluated() ? "" : fmt::format("; less than {} is no success", least_gain)));
  verdict.sentences.push_back(
      number == run.robots.size()
          ? fmt::format("The last improvement is the last robot {}, number {}.", run.done(), number)
          : fmt::format("The last improvement was robot {} of {}.", number, run.robots.size()));
}

// Luck in the evaluation that made it champion shows from perturbed starts.
bool say_robustness(const Run& run, double best, Verdict& verdict) {
  const auto& score = run.robots[*run.champion].training.final_score;
  if (!score) return true;
  constexpr double fair = 0.8;  // of the fitness
  const bool robust = score->mean >= best - (1 - fair) * std::abs(best);
  verdict.sentences.push_back(
      fmt::format("From perturbed starts the champion earns {}{}.",
                  with_error(run, score->mean, score->standard_error),
                  robust ? "" : ", much less: part of its fitness is luck"));
  return robust;
}

bool still_learning(const Run& run) {
  const Training& training = run.robots[*run.champion].training;
  constexpr double late = 0.9;  // of the training
  return training.steps > 0 &&
         static_cast<double>(training.best_step) >= late * static_cast<double>(training.steps);
}

// The command line of the run in a folder, perhaps with settings changed: "evo evolve ga ..".
std::string run_command(const Run& run, const std::string& folder,
                        const std::vector<std::pair<std::string, std::string>>& changed = {}) {
  return evolve_command(
      folder, [&](const std::string& name) { return run.setting(name); }, changed);
}

void advise(const Run& run, bool robust, Verdict& verdict) {
  const auto add = [&](const std::string& why, const std::string& line) {
    verdict.commands.push_back({why, line});
  };
  const bool over = is_over(run);
  const bool bad = verdict.level == Verdict::Level::bad;
  const bool learning = still_learning(run);
  const auto longer = [&](long factor) {
    std::vector<std::pair<std::string, std::string>> changed{
        {"steps", times(factor, run.setting("steps"))}};
    if (const std::string steps = run.setting("founder_steps"); !steps.empty())
      changed.emplace_back("founder_steps", times(factor, steps));
    return run_command(run, run.folder + "-longer", changed);
  };
  if (!over) add("continue where it is", run_command(run, run.folder));
  if (over && bad && !run.is_evaluated())
    add("train each robot ten times as long", longer(10));
  else if (over && learning)
    add("train longer: the champion was still learning", longer(2));
  if (over && !bad && !settled(run))
    add("evolve on: it was still improving",
        run_command(run, run.folder + "-more", {{"evals", times(2, run.setting("evals"))}}));
  if (over && !bad && settled(run) && !learning)
    add("enough: see whether another seed agrees",
        run_command(run, run.folder + "-again",
                    {{"seed", fmt::format("{}", 1 + std::strtol(run.setting("seed").c_str(),
                                                                nullptr, 10))}}));
  if (run.is_evaluated()) return;
  if (!robust || !run.robots[*run.champion].training.final_score)
    add("measure the champion from other starts",
        fmt::format("evo-eval {} --episodes 20 --jitter 1e-3 -o -",
                    shell_word(run.folder + "/best.json")));
  add("its way as a figure", fmt::format("evo-render {} --strip 6 --theme paper -o champion.pdf",
                                         shell_word(run.folder + "/best.rollout.h5")));
}

}  // namespace

bool is_over(const Run& run) {
  return run.evaluations() && run.robots.size() >= *run.evaluations();
}

std::string with_error(const Run& run, double value, double error) {
  return number(value, run.decimals()) + " ± " + number(error, run.decimals());
}

Verdict judge(const Run& run) {
  Verdict verdict;
  if (!run.champion) {
    verdict.level = run.robots.empty() ? Verdict::Level::doubt : Verdict::Level::bad;
    verdict.headline = run.robots.empty() ? fmt::format("Nothing has been {} yet", run.done())
                                          : fmt::format("Every {} failed",
                                                        run.is_evaluated() ? "robot" : "training");
    if (!run.robots.empty())
      verdict.sentences.push_back("The first failure: " + run.robots.front().failure + ".");
    verdict.result = fmt::format("{} {}", verdict.headline, where(run));
    return verdict;
  }
  const std::size_t first = run.generations.empty() ? 0 : run.generations.front().planned;
  if (run.robots.size() < first) {
    verdict.level = Verdict::Level::doubt;
    verdict.headline = "Just begun";
    verdict.sentences.push_back(
        fmt::format("{} of the first {} robots are {}; what they are worth "
                    "is said once all are.",
                    run.robots.size(), first, run.done()));
    verdict.result =
        fmt::format("{} {}, just begun", run.text(run.robots[*run.champion].fitness), where(run));
    return verdict;
  }
  const double best = *run.robots[*run.champion].fitness;
  const double gained = gain(run, best);
  const bool learnt = is_success(run, gained);
  const bool over = is_over(run);
  verdict.level = !learnt ? Verdict::Level::bad
                  : over  ? Verdict::Level::good
                          : Verdict::Level::doubt;
  say_progress(run, best, gained, verdict);
  const bool robust = say_robustness(run, best, verdict);
  if (learnt && !robust) verdict.level = Verdict::Level::doubt;
  if (const std::size_t failures = run.failures(); failures > 0) {
    verdict.sentences.push_back(fmt::format("{} of {} {} failed.", failures, run.robots.size(),
                                            run.is_evaluated() ? "robots" : "trainings"));
    if (5 * failures > run.robots.size() && learnt) verdict.level = Verdict::Level::doubt;
  }
  verdict.headline = !learnt   ? run.is_evaluated() ? "Nothing got better" : "Nothing was learnt"
                     : !over   ? "Better, and it is not over"
                     : !robust ? "Better, in part by luck"
                               : "Better robots were found";
  verdict.result = fmt::format("{} {}, {}{}", run.text(best), where(run), progress(run, best),
                               learnt && !settled(run) ? ", still rising" : "");
  advise(run, robust, verdict);
  return verdict;
}

}  // namespace evo::report
