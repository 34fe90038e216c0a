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

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

std::size_t bytes_of(const ContactLists& lists) {
  std::size_t bytes = bytes_of(lists.self) + bytes_of(lists.pairs) + bytes_of(lists.groups) +
                      bytes_of(lists.first_group) + bytes_of(lists.self_reference) +
                      bytes_of(lists.pair_reference);
  for (const ContactLists::Self& self : lists.self)
    bytes += bytes_of(self.candidates) + bytes_of(self.folding);
  return bytes;
}

}  // namespace

std::size_t bytes_per_lane(const Model& model, const State& state) {
  std::size_t bytes = sizeof(State) + bytes_of(state.contacts) + bytes_of(state.targets);
  for (const std::vector<double>* values :
       {&state.x, &state.y, &state.vx, &state.vy, &state.previous_x, &state.previous_y})
    bytes += bytes_of(*values);
  const Layout layout = lane_layout(model.physics().arithmetic);
  Workspace workspace;
  if (model.physics().arithmetic == Arithmetic::exact)
    workspace.prepare<Arithmetic::exact>(model.compiled().plan, layout);
  else
    workspace.prepare<Arithmetic::fast>(model.compiled().plan, layout);
  return bytes + workspace.bytes() / layout.lanes;
}

void step(std::span<Lane> lanes) {
  thread_local Memory memory;
  auto& [workspace, group, members, taken] = memory;
  taken.assign(lanes.size(), 0);
  for (std::size_t first = 0; first < lanes.size(); ++first) {
    if (taken[first]) continue;
    group.clear();
    members.clear();
    const std::size_t width = lane_layout(lanes[first].model->physics().arithmetic).lanes;
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
