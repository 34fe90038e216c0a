#include "libevo/control/transfer.h"

#include <algorithm>
#include <string>
#include <utility>

#include "libevo/base/error.h"
#include "libevo/sim/model.h"

namespace evo {
namespace {

using Place = Anatomy::Place;

constexpr int none = -1;

std::vector<Place> lattice_points(const Body& robot) {
  const Model model(World{{Object{robot_name, robot, 0, 0}}}, Physics{});
  std::vector<Place> points(static_cast<std::size_t>(model.points()));
  std::size_t next = 0;
  for (int row = 0; row < robot.rows; ++row)
    for (int col = 0; col < robot.cols; ++col) {
      if (robot.at(row, col) == Voxel::empty) continue;
      const ModelCell& cell = model.cells()[next++];
      for (int corner = 0; corner < 4; ++corner)
        points[static_cast<std::size_t>(cell.points[static_cast<std::size_t>(corner)])] = {
            row + corner / 2, col + corner % 2};
    }
  return points;
}

int squared_distance(const Place& a, const Place& b) {
  return (a.row - b.row) * (a.row - b.row) + (a.col - b.col) * (a.col - b.col);
}

// The first of the nearest.
int nearest(const std::vector<Place>& places, const Place& to) {
  const auto closer = [&](const Place& a, const Place& b) {
    return squared_distance(a, to) < squared_distance(b, to);
  };
  return static_cast<int>(std::min_element(places.begin(), places.end(), closer) - places.begin());
}

// Of `points` that for the p-th of the others. Where voxels touch at a corner alone, each has a
// point of its own there; the k-th at a place is for the k-th, or the last that there is.
int counterpart(const std::vector<Place>& points, const std::vector<Place>& others, std::size_t p) {
  const auto end = others.begin() + static_cast<std::ptrdiff_t>(p);
  auto before = std::count(others.begin(), end, others[p]);
  auto found = points.begin() + nearest(points, others[p]);
  for (; before > 0; --before) {
    const auto next = std::find(found + 1, points.end(), *found);
    if (next == points.end()) break;
    found = next;
  }
  return static_cast<int>(found - points.begin());
}

// Which input reads which: `read_at` is where an old input is read in the new
// observation, `moments_of` whose moments a new input starts with.
struct InputMap {
  std::vector<int> read_at;     // [old inputs] new input, or none
  std::vector<int> moments_of;  // [new inputs] old input, or none

  InputMap(std::size_t old_inputs, std::size_t new_inputs)
      : read_at(old_inputs, none), moments_of(new_inputs, none) {}

  void join(int old_input, int new_input) {
    read_at[static_cast<std::size_t>(old_input)] = new_input;
    moments_of[static_cast<std::size_t>(new_input)] = old_input;
  }
};

const ObservationSlice* find(const std::vector<ObservationSlice>& layout, const std::string& name) {
  const auto found = std::find_if(layout.begin(), layout.end(),
                                  [&](const ObservationSlice& s) { return s.name == name; });
  return found == layout.end() ? nullptr : &*found;
}

// Offsets of points: all x, then all y.
void join_points(const ObservationSlice& old_slice, const std::vector<Place>& from,
                 const ObservationSlice& new_slice, const std::vector<Place>& to, InputMap& map) {
  for (int axis = 0; axis < 2; ++axis) {
    const int old_first = old_slice.offset + axis * static_cast<int>(from.size());
    const int new_first = new_slice.offset + axis * static_cast<int>(to.size());
    for (std::size_t p = 0; p < from.size(); ++p)
      map.read_at[static_cast<std::size_t>(old_first) + p] = new_first + counterpart(to, from, p);
    for (std::size_t p = 0; p < to.size(); ++p)
      map.moments_of[static_cast<std::size_t>(new_first) + p] =
          old_first + counterpart(from, to, p);
  }
}

// Lengths of the observations; as many `others` follow either.
InputMap match_inputs(const Anatomy& from, std::size_t old_length, const Anatomy& to,
                      std::size_t new_length, std::size_t others) {
  InputMap map(old_length + others, new_length + others);
  for (std::size_t i = 0; i < others; ++i)
    map.join(static_cast<int>(old_length + i), static_cast<int>(new_length + i));
  const std::string points = part_name(observation::RelativePositions{robot_name});
  for (const ObservationSlice& new_slice : to.layout) {
    const ObservationSlice* old_slice = find(from.layout, new_slice.name);
    if (old_slice == nullptr) continue;
    if (new_slice.name == points) {
      join_points(*old_slice, from.points, new_slice, to.points, map);
    } else if (old_slice->length == new_slice.length) {
      for (int i = 0; i < new_slice.length; ++i)
        map.join(old_slice->offset + i, new_slice.offset + i);
    }
  }
  return map;
}

// The first layer over the new inputs.
void carry_inputs(const Layer& old_layer, const InputMap& map, Layer& layer) {
  layer.bias = old_layer.bias;
  layer.weight =
      Matrix::Zero(old_layer.weight.rows(), static_cast<Eigen::Index>(map.moments_of.size()));
  for (std::size_t i = 0; i < map.read_at.size(); ++i)
    if (map.read_at[i] != none)
      layer.weight.col(map.read_at[i]) += old_layer.weight.col(static_cast<Eigen::Index>(i));
}

Normalizer carried(const Normalizer& old, const InputMap& map, Normalizer fresh, double memory) {
  if (fresh.count == 0.0 || old.count == 0.0) return fresh;
  fresh.count = std::min(old.count, memory);
  for (std::size_t i = 0; i < static_cast<std::size_t>(fresh.mean.size()); ++i) {
    if (map.moments_of[i] == none) continue;
    const auto to = static_cast<Eigen::Index>(i);
    fresh.mean[to] = old.mean[map.moments_of[i]];
    fresh.variance[to] = old.variance[map.moments_of[i]];
  }
  return fresh;
}

Network carried(const Network& old, const InputMap& map) {
  Network network = old;
  carry_inputs(old.layers.front(), map, network.layers.front());
  return network;
}

// Hidden layers, and outputs where `outputs` is set.
bool same_shape(const Network& a, const Network& b, bool outputs) {
  if (a.layers.size() != b.layers.size()) return false;
  for (std::size_t l = 0; l < a.layers.size(); ++l)
    if ((l + 1 < a.layers.size() || outputs) && a.layers[l].bias.size() != b.layers[l].bias.size())
      return false;
  return true;
}

}  // namespace

Anatomy anatomy(const Body& robot, std::vector<ObservationSlice> layout) {
  Anatomy result{std::move(layout), lattice_points(robot), {}};
  for (int row = 0; row < robot.rows; ++row)
    for (int col = 0; col < robot.cols; ++col)
      if (is_actuator(robot.at(row, col))) result.actuators.push_back({row, col});
  return result;
}

SineController transferred(const SineController& old_gait, const Anatomy& from, const Anatomy& to) {
  SineController gait;
  gait.period = old_gait.period;
  gait.middle = old_gait.middle;
  for (const Place& actuator : to.actuators) {
    const auto i = static_cast<std::size_t>(nearest(from.actuators, actuator));
    gait.amplitude.push_back(old_gait.amplitude.at(i));
    gait.phase.push_back(old_gait.phase.at(i));
    if (!old_gait.shift.empty()) gait.shift.push_back(old_gait.shift.at(i));
  }
  return gait;
}

ReplayController transferred(const ReplayController& old_sequence, const Anatomy& from,
                             const Anatomy& to) {
  std::vector<std::size_t> column;
  for (const Place& actuator : to.actuators)
    column.push_back(static_cast<std::size_t>(nearest(from.actuators, actuator)));
  ReplayController sequence;
  sequence.actuators = static_cast<int>(to.actuators.size());
  const auto width = static_cast<std::size_t>(old_sequence.actuators);
  for (std::size_t row = 0; row + width <= old_sequence.actions.size(); row += width)
    for (const std::size_t i : column) sequence.actions.push_back(old_sequence.actions.at(row + i));
  return sequence;
}

Policy transferred(const Policy& old_policy, const Anatomy& from, const Policy& fresh,
                   const Anatomy& to) {
  if (!same_shape(old_policy.actor, fresh.actor, false) ||
      !same_shape(old_policy.critic, fresh.critic, true))
    throw Error(Failure::data, "the networks have other hidden layers than the settings ask for");
  if (old_policy.clock != fresh.clock)
    throw Error(Failure::data, "its networks do not see the clocks that the settings ask for");
  if (old_policy.action_map != fresh.action_map || old_policy.action_offset != fresh.action_offset)
    throw Error(Failure::data, "its actions mean something else (action_map, action_offset)");

  const InputMap map =
      match_inputs(from, static_cast<std::size_t>(old_policy.observation_length()), to,
                   static_cast<std::size_t>(fresh.observation_length()), 2 * fresh.clock.size());
  Policy policy = fresh;
  const double memory = from == to ? old_policy.normalizer.count : memory_of_another_body;
  policy.normalizer = carried(old_policy.normalizer, map, fresh.normalizer, memory);
  policy.critic = carried(old_policy.critic, map);
  policy.actor = carried(old_policy.actor, map);

  Layer& head = policy.actor.layers.back();
  const Layer old_head = std::exchange(head, fresh.actor.layers.back());
  for (std::size_t i = 0; i < to.actuators.size(); ++i) {
    const auto found = std::find(from.actuators.begin(), from.actuators.end(), to.actuators[i]);
    if (found == from.actuators.end()) continue;
    const auto row = static_cast<Eigen::Index>(i);
    head.weight.row(row) = old_head.weight.row(found - from.actuators.begin());
    head.bias[row] = old_head.bias[found - from.actuators.begin()];
  }
  return policy;
}

}  // namespace evo
