// A task as data: a world, where the robot stands in it, what it observes, what
// it is rewarded for, and when an episode ends. The pieces are three closed lists,
// observation parts, conditions and reward terms; they combine freely. What each
// one does stands in observation.cpp, conditions.cpp and reward.cpp, how it is
// written in files of those names in formats/task (reward.cpp, ..): a piece in a
// list here that is missing there does not compile. See docs/tasks.md.
//
// Lengths here are in voxels, as tasks are drawn and written; they are turned
// into raw units as `value * voxel_length`, one rounding, as the benchmark does.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libevo/sim/physics.h"
#include "libevo/sim/world.h"

namespace evo {

// The robot is the object of this name in every task.
inline constexpr const char* robot_name = "robot";

enum class Axis { x, y };
constexpr auto words_for(Axis) { return std::array{"x", "y"}; }

// ---- observation ------------------------------------------------------------

namespace observation {
struct Velocity {
  static constexpr const char* name = "velocity";
  std::string of;
};  // 2: mean integrator velocity
struct Orientation {
  static constexpr const char* name = "orientation";
  std::string of;
};  // 1: docs/tasks.md, "Orientation"
struct RelativePositions {
  static constexpr const char* name = "relative_positions";
  std::string of;
};  // 2n: offsets of its n points to the centre, all x then all y
struct Offset {
  static constexpr const char* name = "offset";
  std::string of;
  std::string from;
};  // 2: centre of `of` minus centre of `from`
// 2*width+1 distances from the robot's centre to the nearest point of terrain
// below (floor) or above (ceiling), clipped to `range` voxels; docs/tasks.md, "Floor and ceiling".
// `over` names the objects that count; empty: all but the robot.
struct Floor {
  static constexpr const char* name = "floor";
  int width = 5;
  double range = 5;
  std::vector<std::string> over;
};
struct Ceiling {
  static constexpr const char* name = "ceiling";
  int width = 5;
  double range = 5;
  std::vector<std::string> over;
};
struct GoalIndex {
  static constexpr const char* name = "goal_index";
};  // 1: how many goals have been reached
struct GoalPosition {
  static constexpr const char* name = "goal_position";
};  // 1: the current goal, raw length
struct GoalOffset {
  static constexpr const char* name = "goal_offset";
};  // 1: the current goal minus the robot's centre
}  // namespace observation

using ObservationPart =
    std::variant<observation::Velocity, observation::Orientation, observation::RelativePositions,
                 observation::Offset, observation::Floor, observation::Ceiling,
                 observation::GoalIndex, observation::GoalPosition, observation::GoalOffset>;

// ---- conditions -------------------------------------------------------------

// Every condition looks at the state after the step. Bounds are strict.
namespace condition {
// Centre of an object against bounds, voxels.
struct Position {
  static constexpr const char* name = "position";
  std::string of;
  Axis axis = Axis::x;
  std::optional<double> above;     // centre > above
  std::optional<double> below;     // centre < below
  std::optional<double> at_least;  // centre >= at_least
  std::optional<double> at_most;   // centre <= at_most
};
// Orientation strictly between the tilt limit and its mirror image:
// degrees < orientation < 360 - degrees.
struct Tilt {
  static constexpr const char* name = "tilt";
  std::string of;
  double degrees = 90;
};
struct GoalsReached {
  static constexpr const char* name = "goals_reached";
};  // all goals of the episode
}  // namespace condition

using Condition = std::variant<condition::Position, condition::Tilt, condition::GoalsReached>;

// ---- reward -----------------------------------------------------------------

// A term's value is weight * what it measures, and 0 unless all of `when` hold.
namespace reward {
struct Displacement {
  static constexpr const char* name = "displacement";
  std::string of;
  Axis axis = Axis::x;
};  // post - pre of the centre
struct Distance {
  static constexpr const char* name = "distance";
  std::string of;
  Axis axis = Axis::x;
};  // |post - pre|
// How much nearer `of` came to a place (voxels) or to another object along one
// axis: |target_pre - centre_pre| - |target_post - centre_post|.
struct Approach {
  static constexpr const char* name = "approach";
  std::string of;
  Axis axis = Axis::x;
  std::variant<double, std::string> to;
};
struct HullArea {
  static constexpr const char* name = "hull_area";
  std::string of;
};  // growth of the convex hull's area
struct Extent {
  static constexpr const char* name = "extent";
  std::string of;
  Axis axis = Axis::x;
};  // growth of max - min
struct Rotation {
  static constexpr const char* name = "rotation";
  std::string of;
};  // post - pre of the orientation, counted on over whole turns
struct GoalApproach {
  static constexpr const char* name = "goal_approach";
};  // how much nearer the robot came to the goal; docs/tasks.md, "Rewards and ends"
struct Effort {
  static constexpr const char* name = "effort";
};  // sum over actuators of (target - 1)^2, targets as the physics clips them
struct ActionChange {
  static constexpr const char* name = "action_change";
};  // sum over actuators of (target - target of the step before)^2; before the first: 1
using Term = std::variant<Displacement, Distance, Approach, HullArea, Extent, Rotation,
                          GoalApproach, Effort, ActionChange>;
}  // namespace reward

struct RewardTerm {
  double weight = 1.0;
  reward::Term term;
  std::vector<Condition> when;
};

// Rules are tried in order after self-folding; each that holds adds its reward.
struct Rule {
  std::vector<Condition> when;  // all of them
  double reward = 0.0;
  bool terminate = true;
};

// ---- draws ------------------------------------------------------------------

// A uniform integer drawn at every reset, by name, in this order.
struct DrawnInteger {
  std::string name;
  int low = 0;
  int high = 0;  // inclusive
};

// Goals along x in voxels: from `start`, uniform integers in [low, high] until
// the path length reaches `distance`. A goal is reached when the robot's centre
// is nearer to it than `radius`; then the next one counts.
struct DrawnGoals {
  int start = 0;
  int low = 0;
  int high = 0;  // inclusive, greater than low
  int distance = 0;
  double radius = 2;
};

struct Placement {
  Object object;         // at its cell before any offset
  std::string offset_x;  // names of drawn integers added to the cell, or ""
  std::string offset_y;
};

// ---- task -------------------------------------------------------------------

struct TaskSpec {
  std::string name;
  std::vector<std::string> aliases;
  std::string description;
  std::string difficulty;          // easy, medium, hard, or empty
  std::vector<std::string> notes;  // differences from the paper, for evo-inspect
  int episode_steps = 500;
  int hold = 1;            // control steps of a step, all with the same action
  double step_cost = 0.0;  // subtracted from the reward of every step
  int robot_x = 0;         // cell of the lower-left corner of the body's matrix
  int robot_y = 0;
  std::vector<Placement> objects;
  std::vector<DrawnInteger> draws;
  std::optional<DrawnGoals> goals;
  std::vector<ObservationPart> observation;
  std::vector<RewardTerm> reward;
  double folding_reward = -3.0;
  std::vector<Rule> rules;
  std::vector<std::string> follow{robot_name};  // what a camera keeps in view
  Physics physics;
  std::string source;  // the YAML text it was read from, kept for records
};

// What the random parts of one episode came out as.
struct Draws {
  std::map<std::string, int> integers;
  std::vector<int> goals;  // voxels
  bool operator==(const Draws&) const = default;
};

// As in layouts: "velocity(robot)", "floor(5)", "goal_index", ...
std::string part_name(const ObservationPart& part);
// `points`: how many points the object that the part is `of` has.
int part_length(const ObservationPart& part, int points);
// The object the part is `of`: its points decide its length. "" for none.
std::string part_object(const ObservationPart& part);

}  // namespace evo
