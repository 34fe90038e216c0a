#include "libevo/control/settings.h"

#include "libevo/base/error.h"
#include "libevo/control/methods.h"

namespace evo {

void check(const TrainingSettings& s) {
  if (s.minibatches > s.batch())
    throw error(Failure::usage,
                "training: minibatches is {}; a rollout has fewer samples (environments x rollout)",
                s.minibatches);
  if (s.longest_period < s.shortest_period)
    throw error(Failure::usage, "training: longest_period is {}; it must be at least {}",
                s.longest_period, s.shortest_period);
  check_method(s);
}

}  // namespace evo
