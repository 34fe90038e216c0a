// Archives of robots (libevo/evolve/archive.h) by features of their bodies, how they
// behaved, or any number of their documents.
#pragma once

#include <string>
#include <vector>

#include "formats/robot/robot.h"
#include "libevo/evolve/archive.h"

namespace evo {

// A list of axes: NAME:BINS for features of bodies, NAME:BINS:LOW:HIGH for others, which
// have no range of their own. Throws Error(usage), whose message begins with `where`.
GridArchive parse_archive(const std::string& list, const std::string& where);

// Not a number where the robot does not have it.
double feature_of(const Robot& robot, const std::string& name);

// With what it is measured in: "behaviour.distance, voxels".
std::string feature_title(const std::string& name);

// On each axis. Throws Error(data) for a behaviour that a robot with a fitness does not have.
std::vector<double> features_of(const Robot& robot, const std::vector<FeatureAxis>& axes);

// Adds the robots by their place in the list. Throws Error(data) for a feature that none
// of them has, and for a behaviour that one with a fitness does not have.
void fill(GridArchive& archive, const std::vector<Robot>& robots);

}  // namespace evo
