// What a StepTape keeps. Private to libevo/task.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "libevo/task/compiled.h"
#include "libevo/task/step_tape.h"

namespace evo {

struct StepTape::Impl {
  struct Step {
    bool is_active = false;
    bool is_done = true;  // neither folded nor unstable
    const Arena* arena = nullptr;
    std::shared_ptr<const EpisodeWorld> world;
    std::size_t observation_offset = 0;
    std::size_t action_offset = 0;
    std::vector<InitialShape> initial_shapes;
    Episode episode;              // as the observation sees it
    int goal = 0;                 // as rewards see it
    std::vector<double> targets;  // as given
    std::vector<Vec2> before, after;
    std::vector<double> quantities_before, quantities_after;
  };

  explicit Impl(double onset) : simulation(onset) {}

  Tape simulation;
  std::vector<Step> steps;  // [E]
};

}  // namespace evo
