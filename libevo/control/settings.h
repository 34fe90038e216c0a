// The settings of a training, as training_settings.def lists them. Profiles are the YAML
// files of tasks/training/, read by formats/training/training.h.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "libevo/base/words.h"
#include "libevo/control/modular_policy.h"
#include "libevo/control/policy.h"

namespace evo {

// What trains, by its name in methods.h:
//   ppo     a policy network, by proximal policy optimisation
//   sine    open-loop sine waves, by an evolution strategy
//   random  the best of random open-loop sine waves
//   gait    as sine, but from the best of the waves that travel over the body
//   modular a network that every voxel shares, for one robot or for many, by proximal policy
//           optimisation
//   sequence  open loop, every actuator's target at every step: exploration from the best
//           moments reached so far
class Algorithm {
 public:
  Algorithm() : Algorithm("ppo") {}
  // Throws Error(usage) for a name that there is no method of.
  explicit Algorithm(std::string_view name);

  const std::string& name() const { return name_; }
  bool operator==(const Algorithm&) const = default;

 private:
  std::string name_;
};
std::vector<std::string> algorithm_names();

enum class Schedule { constant, linear };           // linear: falls to 0 over the horizon
enum class TimeLimit { end, bootstrap };            // what an episode cut off by time counts as
enum class Standardize { none, batch, minibatch };  // over what advantages get mean 0, deviation 1

// As profiles write them (libevo/base/words.h).
constexpr const char* word(Schedule value) {
  switch (value) {
    case Schedule::constant:
      return "constant";
    case Schedule::linear:
      return "linear";
  }
  return nullptr;
}
constexpr const char* word(TimeLimit value) {
  switch (value) {
    case TimeLimit::end:
      return "end";
    case TimeLimit::bootstrap:
      return "bootstrap";
  }
  return nullptr;
}
constexpr const char* word(Standardize value) {
  switch (value) {
    case Standardize::none:
      return "none";
    case Standardize::batch:
      return "batch";
    case Standardize::minibatch:
      return "minibatch";
  }
  return nullptr;
}

// What the search for a sequence tries from a moment on (sequence_search.h).
enum class AttemptKind {
  go_on,   // with what was going on
  begin,   // a new gait
  change,  // the gait, or that of a moment that was earning much, changed
  borrow,  // the gait of a moment that was earning much
  repeat,  // the last actions, again and again
  push,    // a few targets held by groups of actuators, then the gait
  hold     // one target for each group
};
constexpr const char* word(AttemptKind value) {
  switch (value) {
    case AttemptKind::go_on:
      return "go_on";
    case AttemptKind::begin:
      return "begin";
    case AttemptKind::change:
      return "change";
    case AttemptKind::borrow:
      return "borrow";
    case AttemptKind::repeat:
      return "repeat";
    case AttemptKind::push:
      return "push";
    case AttemptKind::hold:
      return "hold";
  }
  return nullptr;
}

// What a number may be, in training_settings.def.
struct NumberRange {
  double least = -std::numeric_limits<double>::infinity();
  bool open = false;  // `least` itself is not in it
  double most = std::numeric_limits<double>::infinity();
};
namespace number_range {
constexpr NumberRange from(double least) { return {.least = least}; }
inline constexpr NumberRange above_zero{.least = 0.0, .open = true};
inline constexpr NumberRange a_share{.least = 0.0, .most = 1.0};
inline constexpr NumberRange any{};
}  // namespace number_range

struct TrainingSettings {
#define SETTING(type, name, initial, baseline, range, paper, meaning) type name = initial;
#include "libevo/control/training_settings.def"
#undef SETTING

  bool operator==(const TrainingSettings&) const = default;

  std::int64_t batch() const { return std::int64_t{environments} * rollout; }
  std::int64_t updates() const { return steps / batch(); }
};

// Throws Error(usage) naming the key and the value where a setting makes no
// sense, alone or with the others.
void check(const TrainingSettings& settings);

}  // namespace evo
