// Names in a task turned into what a step looks at, each thing once. Private to
// libevo/task.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libevo/task/compiled.h"

namespace evo {

// Throws Error(data) for names that the world does not have.
class Binder {
 public:
  explicit Binder(Arena::Compiled& arena) : arena_(arena) {}

  PointRange points(const std::string& object) const;

  // Quantities of an object by number: the first of its centre's, or its only one.
  std::size_t centre(const std::string& object);
  std::size_t centre(const std::string& object, Axis axis);  // raw
  std::size_t orientation(const std::string& object);
  std::size_t hull_area(const std::string& object);
  std::size_t extent(const std::string& object, Axis axis);

  // Which Terrain the objects make; of all but the robot, if none are named.
  std::size_t terrain(const std::vector<std::string>& over);

  double voxel_length() const { return arena_.voxel_length; }
  double raw(double voxels) const { return voxels * arena_.voxel_length; }

  // Throws Error(data) where the task draws none; `what` needs them.
  void need_goals(const char* what) const;

 private:
  int object(const std::string& name) const;
  std::size_t measured(Measure::Kind kind, const std::string& object, std::size_t quantities);

  Arena::Compiled& arena_;
};

// How many numbers a part is, with which words, and what it writes.
compiled::Part bind_part(const ObservationPart& part, Binder& bind);
compiled::Test bind_condition(const Condition& condition, Binder& bind);
compiled::Term bind_term(const reward::Term& term, Binder& bind);

// The goal that counts, raw; the last one after all were reached.
double current_goal(const Episode& episode, double voxel_length);

}  // namespace evo
