// How a robot behaved in an episode, in a few numbers: axes for archives of what is good
// in its own way.
#pragma once

#include <array>
#include <span>

#include "libevo/sim/model.h"

namespace evo {

// The centre is the mean of the robot's points, which weigh the same.
struct Behaviour {
  double distance = 0.0;  // voxels that the centre came to the right, from start to end
  double rise = 0.0;      // voxels that the centre got above where it started, at most
  double aloft = 0.0;     // share of the steps after which nothing touches the robot
  double width = 1.0;     // of its bounding box after a step, a mean; 1: as at the start
};

struct BehaviourFeature {
  const char* name;
  const char* measure;  // its unit, or what it is a share of
  double Behaviour::*value;
};
inline constexpr std::array behaviour_features{
    BehaviourFeature{"distance", "voxels", &Behaviour::distance},
    BehaviourFeature{"rise", "voxels", &Behaviour::rise},
    BehaviourFeature{"aloft", "share of the steps", &Behaviour::aloft},
    BehaviourFeature{"width", "of that at the start", &Behaviour::width},
};

// Follows an episode.
class BehaviourMeter {
 public:
  // Its state after the reset, then after every step: all points of the world, raw units.
  // The robot is the first object.
  void add(const Model& model, std::span<const Vec2> positions);
  Behaviour behaviour() const;  // until now

 private:
  int steps_ = -1;  // taken; -1 before the reset
  Vec2 start_;      // centres, voxels
  Vec2 now_;
  double highest_ = 0.0;
  int aloft_ = 0;             // steps
  double start_width_ = 0.0;  // voxels
  double widths_ = 0.0;       // after each step, their sum
};

}  // namespace evo
