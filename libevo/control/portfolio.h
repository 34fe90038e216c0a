// A portfolio of methods within one training and its budget: a search for a gait,
// the trial of a network, the trial of a network that adds to the gait, and the
// rest of the steps for the better of the two. What any of them found counts.
// Private to libevo/control.
//
// The network on the gait goes on only if it improved on the gait and is ahead of
// the other: the gait itself is safe already, and where nothing adds to it a
// network of its own has more to find.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "libevo/control/gait_training.h"
#include "libevo/control/ppo_training.h"

namespace evo {

class PortfolioTraining {
 public:
  static constexpr const char* name = "portfolio";
  static void check(const TrainingSettings& settings);

  // Where the shares are too small for a generation of the search or an update, or
  // an inheritance has made the choice, all steps are one network's.
  explicit PortfolioTraining(const TrainingJob& job);

  bool done(const TrainingJob& job, const Findings& findings) const;
  void advance(const TrainingJob& job, Findings& findings, Metrics& metrics);
  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

 private:
  enum Stage : std::uint64_t { searching, first_trial, second_trial, going_on };
  static constexpr std::size_t alone = 0;
  static constexpr std::size_t on_gait = 1;

  void train(std::size_t which, Findings& findings, Metrics& metrics);
  void end_search(const Findings& findings);

  std::unique_ptr<TrainingJob> search_job_;   // with the search's share of the steps
  std::unique_ptr<TrainingJob> network_job_;  // with those of a network that goes on
  std::int64_t trial_steps_;                  // whole updates
  std::int64_t others_ = 0;                   // steps of search and of the other network
  std::uint64_t stage_ = searching;
  std::size_t going_ = alone;  // the network that goes on
  std::optional<GaitTraining> search_;
  std::optional<SineController> gait_;
  double gait_return_ = 0.0;
  std::array<std::optional<PpoTraining>, 2> networks_;
  std::array<double, 2> best_;           // evaluation of each network
  std::array<std::int64_t, 2> steps_{};  // each has taken
};

}  // namespace evo
