// The graph of a run without generations, as rules of make. Robot k is proposed from the
// scores of robots 0 .. k-window-1 (known_scores, libevo/evolve/select.h) and waits for
// nothing else.
#pragma once

#include <functional>
#include <string>

namespace evo {

struct PlanSettings {
  int pop = 0;     // robots of a generation, by number
  int evals = 0;   // of the run
  int window = 0;  // robots that may be in training
  int chunk = 1;   // robots proposed and launched together, at most `window`
};

// A line for each rule; prerequisites are order-only. A chunk c of a generation has two
// targets: its robots proposed, P(c), and trained, T(c). P(c) follows P(c-1) and those T
// whose scores its last robot knows; T(c) follows P(c); a generation's ranking.tsv follows
// its T. Recipes call `propose`, `train` and `rank`, variables of the makefile, and the
// first P follows `founders`, another one. What is finished has no rules any more, and
// nothing waits for it. T and ranking.tsv are .PRECIOUS: a make that is told to end does
// not delete them. Throws Error(usage) for numbers below 1 and a chunk beyond the window.
std::string plan_rules(const std::string& run, const PlanSettings& settings,
                       const std::function<bool(int)>& generation_is_finished);

}  // namespace evo
