// A policy carried over from one robot to another, as from parent to child: the
// same networks, with inputs and outputs put where the other body has them.
//
// Observations of the robot's points are matched on the lattice: each one that
// the old policy sees is read at the nearest point of the new body, and a point
// nobody reads starts with weight 0 and the moments of the nearest old one. Several
// points may share a place (voxels that touch at a corner alone): in their order.
// Other parts of an observation are matched by name and length. Actions are
// matched by cell: an actuator where the old body had none starts as a fresh
// policy has it. The critic is carried over like the actor.
#pragma once

#include <vector>

#include "libevo/body/body.h"
#include "libevo/control/controller.h"
#include "libevo/task/env.h"

namespace evo {

// What networks are attached to: where the parts of the observation lie, the
// robot's points on the lattice in the order they are observed, and the cells of
// its actuators in the order of actions.
struct Anatomy {
  // Row and column, from the top left; of grid lines or of cells.
  struct Place {
    int row = 0;
    int col = 0;
    bool operator==(const Place&) const = default;
  };
  std::vector<ObservationSlice> layout;
  std::vector<Place> points;
  std::vector<Place> actuators;
  bool operator==(const Anatomy&) const = default;
};

// For a robot whose observation has this layout (Arena::layout, or a policy file's).
Anatomy anatomy(const Body& robot, std::vector<ObservationSlice> layout);
inline Anatomy anatomy(const Arena& arena) { return anatomy(arena.robot(), arena.layout()); }

// No more observations than these stand behind the moments that a controller brings to another
// body, so that they adapt.
inline constexpr double memory_of_another_body = 10000.0;

// A gait: every actuator does what the nearest one of the old body did.
SineController transferred(const SineController& old_gait, const Anatomy& from, const Anatomy& to);

// A sequence of actions, likewise.
ReplayController transferred(const ReplayController& old_sequence, const Anatomy& from,
                             const Anatomy& to);

// The old policy on the new body. `fresh` is an untrained policy for it: it gives
// what has no counterpart, and the deviation of actions. On another anatomy, no more
// than memory_of_another_body stand behind the moments; on the same
// one (voxels may be of other materials), as many as before, since networks fall when
// what they see is scaled otherwise from one update to the next. Throws Error(data)
// where the two differ otherwise: in hidden layers, inputs beside the observation, or
// the action map.
Policy transferred(const Policy& old_policy, const Anatomy& from, const Policy& fresh,
                   const Anatomy& to);

}  // namespace evo
