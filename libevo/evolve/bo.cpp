#include "libevo/evolve/bo.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace evo {

Proposal BayesianOptimisation::propose(int /*number*/, std::span<const Body> pending,
                                       std::set<std::string>& seen) {
  std::vector<Design> designs;
  designs.reserve(pending.size());
  for (const Body& body : pending) designs.push_back(body.cells);
  SuggestSettings suggesting;
  suggesting.parameters = parameters();
  SuggestedBatch batch = suggest(settings_.rows, settings_.cols, observations_, designs, 1,
                                 suggesting, settings_.seed);
  Proposal proposal{std::move(batch.designs.front().body), MadeBy::suggestion};
  seen.insert(identity(proposal.body));
  return proposal;
}

// To as many scores as fill whole populations; before that, and while none of them has
// succeeded, to what is there.
std::optional<GpParameters> BayesianOptimisation::parameters() {
  const int fitted = static_cast<int>(observations_.size()) / settings_.pop * settings_.pop;
  const auto fitting = std::span(observations_).first(static_cast<std::size_t>(fitted));
  if (std::none_of(fitting.begin(), fitting.end(),
                   [](const Observation& o) { return std::isfinite(o.fitness); }))
    return std::nullopt;
  if (!parameters_ || fitted_ != fitted) {
    parameters_ = fit_parameters(fitting, {}, settings_.seed);
    fitted_ = fitted;
  }
  return parameters_;
}

void BayesianOptimisation::tell(const ScoredRobot& robot) {
  observations_.push_back({robot.body.cells, robot.fitness});
}

MethodState BayesianOptimisation::save() const {
  MethodState state;
  state.told = static_cast<int>(observations_.size());
  state.parameters = parameters_;
  state.fitted = fitted_;
  return state;
}

void BayesianOptimisation::load(MethodState state) {
  observations_.clear();
  parameters_ = state.parameters;
  fitted_ = state.fitted;
}

}  // namespace evo
