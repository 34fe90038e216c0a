// What Evolution Gym keeps in files: worlds and robots of its design tool as
// JSON and the folders of its experiments (docs/formats/foreign.md).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "formats/io/node.h"
#include "formats/robot/robot.h"
#include "libevo/sim/world.h"

namespace evo {

// Told of what the benchmark reads without a word and we read as it does.
using WorldWarning = std::function<void(const std::string&)>;

// The objects in file order, each as large as its cells, at its place. Any
// order of objects and cells; a link counts from whichever end it is listed. What else the
// benchmark reads, each with a warning, and what is refused: docs/formats/foreign.md. A
// `grid_height` that is none is as high as the cells; neighbours of no cell are left out.
// Throws Error(data).
World read_evogym_world(const Node& document, const WorldWarning& warn = {});
World read_evogym_world(const std::filesystem::path& path, const WorldWarning& warn = {});

// JSON text. The grid is as large as the contents; an object whose matrix has an
// empty border keeps it, as cells of type 0. Throws Error(data) for a world that
// the format cannot hold: a name given twice, a negative position, two objects in one cell.
std::string evogym_world_to_json(const World& world);

// The robot of a world: its only object, or its only one with actuators. In the other direction, a
// world with `robot` in its lower left corner.
Robot robot_from_evogym_world(const World& world, const std::string& where,
                              BodyCheck check = BodyCheck::robot);
World evogym_world_of_robot(const Robot& robot);

// All robots of an experiment folder, generation by generation, best first as
// ranked there. A body that occurs again (a survivor) is listed once, where it
// was first seen, with the best of its fitnesses. `fitness` is absent for a robot
// that was not ranked, null for one whose fitness is no number; `origin` names
// generation and label. Throws Error(no_input, io, data).
std::vector<Robot> read_evogym_experiment(const std::filesystem::path& folder);

// Whether the folder has what an experiment folder has (generation_0/structure).
bool is_evogym_experiment(const std::filesystem::path& folder);

}  // namespace evo
