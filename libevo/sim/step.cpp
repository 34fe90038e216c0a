// Deals lanes out to the kernels: environments that move alike go side by side.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libevo/sim/compiled.h"
#include "libevo/sim/kernels.h"
#include "libevo/sim/state.h"

namespace evo {
namespace {

// With fewer in a register, stepping them one by one is faster.
constexpr std::size_t fewest_side_by_side = 3;

bool move_alike(const Model& a, const Model& b) {
  if (&a == &b) return true;
  return a.compiled().dynamics == b.compiled().dynamics && a.physics() == b.physics();
}

// Kept from call to call by each thread, so that stepping does not allocate.
struct Memory {
  Workspace workspace;
  std::vector<Lane> group;
  std::vector<std::size_t> members;  // where the group's lanes stand in the span
  std::vector<std::uint8_t> taken;   // one a lane: it is in a group already
};

}  // namespace

void step(std::span<Lane> lanes) {
  thread_local Memory memory;
  auto& [workspace, group, members, taken] = memory;
  const std::size_t width = lane_width();
  taken.assign(lanes.size(), 0);
  for (std::size_t first = 0; first < lanes.size(); ++first) {
    if (taken[first]) continue;
    group.clear();
    members.clear();
    for (std::size_t i = first; i < lanes.size() && group.size() < width; ++i) {
      if (taken[i] || !move_alike(*lanes[first].model, *lanes[i].model)) continue;
      taken[i] = 1;
      group.push_back(lanes[i]);
      members.push_back(i);
    }
    if (group.size() >= fewest_side_by_side) {
      step_side_by_side(group, workspace);
    } else {
      for (Lane& lane : group) step_alone(lane, workspace);
    }
    for (std::size_t i = 0; i < members.size(); ++i) lanes[members[i]].result = group[i].result;
  }
}

}  // namespace evo
