#include "evolution/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "libevo/base/error.h"
#include "libevo/evolve/select.h"

namespace evo {
namespace {

// The names of targets.
class Targets {
 public:
  Targets(std::string run, int pop) : run_(std::move(run)), pop_(pop) {}

  std::string ranking(int generation) const { return folder(generation) + "/ranking.tsv"; }
  std::string slots(int first, int last) const {
    return first == last ? fmt::format("{:02}", first % pop_)
                         : fmt::format("{:02}-{:02}", first % pop_, last % pop_);
  }
  std::string proposed(int first, int last) const {
    return fmt::format("{}/{}.proposed", folder(first / pop_), slots(first, last));
  }
  std::string trained(int first, int last) const {
    return fmt::format("{}/{}.{}", folder(first / pop_), slots(first, last),
                       first == last ? "json" : "trained");
  }

 private:
  std::string folder(int generation) const { return fmt::format("{}/gen-{:03}", run_, generation); }

  std::string run_;
  int pop_;
};

std::string rule(const std::string& target, const std::string& needs, const std::string& call) {
  return fmt::format("{}:|{};@$(call {})\n", target, needs, call);
}

}  // namespace

std::string plan_rules(const std::string& run, const PlanSettings& settings,
                       const std::function<bool(int)>& generation_is_finished) {
  const auto [pop, evals, window, chunk] = settings;
  for (const int count : {pop, evals, window, chunk})
    if (count < 1) throw error(Failure::usage, "a plan needs numbers from 1, not {}", count);
  if (chunk > window)
    throw error(Failure::usage, "chunk is a number from 1 to window, which is {}, not {}", window,
                chunk);
  const Targets targets(run, pop);
  // The last robot of the chunk that begins with this one: no chunk crosses a generation.
  const auto chunk_end = [&](int first) {
    return std::min({first + chunk, (first / pop + 1) * pop, evals}) - 1;
  };
  const int generations = (evals + pop - 1) / pop;
  std::vector<bool> finished;
  for (int generation = 0; generation < generations; ++generation)
    finished.push_back(generation_is_finished(generation));
  const auto is_finished = [&](int robot) {
    return finished[static_cast<std::size_t>(robot / pop)];
  };

  std::string rules;
  std::string precious;
  std::vector<std::string> ready(static_cast<std::size_t>(generations));
  std::string previous = " $(founders)";
  int told = 0;  // scores of robots before this one are waited for by an earlier P
  for (int first = 0, last = 0; first < evals; first = last + 1) {
    last = chunk_end(first);
    std::string needs = previous;
    for (; told < known_scores(last, window, pop); told = chunk_end(told) + 1)
      if (!is_finished(told)) needs += " " + targets.trained(told, chunk_end(told));
    if (is_finished(first)) continue;
    const int generation = first / pop;
    const std::string trained = targets.trained(first, last);
    previous = " " + targets.proposed(first, last);
    rules += rule(targets.proposed(first, last), needs, fmt::format("propose,{}", last + 1));
    rules +=
        rule(trained, previous, fmt::format("train,{},{}", generation, targets.slots(first, last)));
    ready[static_cast<std::size_t>(generation)] += " " + trained;
  }
  for (int generation = 0; generation < generations; ++generation) {
    if (finished[static_cast<std::size_t>(generation)]) continue;
    const std::string& trained = ready[static_cast<std::size_t>(generation)];
    rules += rule(targets.ranking(generation), trained,
                  fmt::format("rank,{},{}", generation, std::min(pop, evals - generation * pop)));
    precious += trained + " " + targets.ranking(generation);
  }
  return rules + ".PRECIOUS:" + precious + "\n";
}

}  // namespace evo
