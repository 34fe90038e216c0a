#include "libevo/sim/batch.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "libevo/sim/contact.h"
#include "libevo/sim/group.h"
#include "libevo/sim/kernels.h"
#include "libevo/sim/step_record.h"

namespace evo {
namespace {

void copy_lane(const Group& from, std::size_t from_lane, const Group& to, std::size_t to_lane) {
  const auto copy = [&](const double* source, double* target) {
    for (std::int32_t site = 0; site < from.kind->plan().sites; ++site) {
      const double* pair = source + pair_offset(site, from.width()) + from_lane;
      double* copied = target + pair_offset(site, to.width()) + to_lane;
      copied[0] = pair[0];
      copied[to.width()] = pair[from.width()];
    }
  };
  copy(from.rows.position, to.rows.position);
  copy(from.rows.previous, to.rows.previous);
  copy(from.rows.velocity, to.rows.velocity);
  copy(from.rows.self_listing, to.rows.self_listing);
  copy(from.rows.pair_listing, to.rows.pair_listing);
}

}  // namespace

// ---- kinds ---------------------------------------------------------------------------

const Tables& Kind::tables(const Layout& layout) {
  for (const auto& tables : tables_)
    if (tables->layout == layout) return *tables;
  return *tables_.emplace_back(std::make_unique<const Tables>(plan(), layout));
}

// ---- lanes and groups ------------------------------------------------------------------

struct Batch::Impl {
  // Where a lane's state is kept.
  struct Place {
    Group* group = nullptr;
    std::size_t lane = 0;  // of its rows
  };

  explicit Impl(std::size_t count) : lanes(count), places(count), workspaces(1) {}

  std::size_t index_of(const Lane* lane) const {
    return static_cast<std::size_t>(lane - lanes.data());
  }

  std::shared_ptr<Kind> kind_of(const std::shared_ptr<const Model>& model);
  void settle(std::size_t lane, std::shared_ptr<Kind> kind);
  void leave(std::size_t lane);

  void group_for(std::span<const std::uint8_t> marked, int threads);
  bool fits(std::span<const std::uint8_t> marked, bool singly) const;
  void regroup();
  void deal(std::vector<std::size_t> waiting, bool singly);
  void put_together(std::span<const std::size_t> members);

  std::vector<Lane> lanes;
  std::vector<Place> places;               // [lanes]
  std::vector<std::weak_ptr<Kind>> kinds;  // of the lanes, some perhaps gone
  std::vector<std::unique_ptr<Group>> groups;
  std::vector<Workspace> workspaces;  // one per worker

  // What the groups were last made for.
  std::vector<std::uint8_t> active;  // [lanes]; empty: nothing, they are to be made
  bool one_by_one = false;
  std::vector<Group*> running;  // those of the active lanes
};

std::shared_ptr<Kind> Batch::Impl::kind_of(const std::shared_ptr<const Model>& model) {
  std::erase_if(kinds, [](const std::weak_ptr<Kind>& kind) { return kind.expired(); });
  for (const std::weak_ptr<Kind>& candidate : kinds) {
    std::shared_ptr<Kind> kind = candidate.lock();
    if (kind->holds(*model)) return kind;
  }
  auto kind = std::make_shared<Kind>(model);
  kinds.push_back(kind);
  return kind;
}

// A lane of another kind gets a group of its own; the next step finds it company.
void Batch::Impl::settle(std::size_t lane, std::shared_ptr<Kind> kind) {
  leave(lane);
  lanes[lane].kind = kind;
  const Layout layout = layout_of(1);
  groups.push_back(std::make_unique<Group>(std::move(kind), layout));
  groups.back()->lanes = {&lanes[lane]};
  places[lane] = {groups.back().get(), 0};
}

void Batch::Impl::leave(std::size_t lane) {
  active.clear();
  Group* const group = std::exchange(places[lane].group, nullptr);
  if (group == nullptr) return;
  const std::size_t gap = places[lane].lane;
  Lane* const last = group->lanes.back();
  if (last != &lanes[lane]) {
    copy_lane(*group, group->lanes.size() - 1, *group, gap);
    group->lanes[gap] = last;
    places[index_of(last)].lane = gap;
  }
  group->lanes.pop_back();
  if (group->lanes.empty())
    std::erase_if(groups, [&](const std::unique_ptr<Group>& g) { return g.get() == group; });
}

// ---- grouping --------------------------------------------------------------------------
// Every lane that holds a simulation is in one place, and its group says so. Groups are of one kind
// and hold either lanes that are stepped (`running`) or lanes that are not. They are made when
// that changes, or a lane's kind, or the instruction set; as a rule once.

void Batch::Impl::group_for(std::span<const std::uint8_t> marked, int threads) {
  // With a thread for every two lanes, each is soonest done alone.
  std::size_t count = marked.empty() ? lanes.size() : 0;
  for (const std::uint8_t mark : marked) count += mark != 0 ? 1 : 0;
  const bool singly =
      threads > 1 && count <= (fewest_side_by_side - 1) * static_cast<std::size_t>(threads);
  if (fits(marked, singly)) return;
  active.assign(lanes.size(), 1);
  for (std::size_t i = 0; i < lanes.size(); ++i)
    if ((!marked.empty() && marked[i] == 0) || lanes[i].model == nullptr) active[i] = 0;
  one_by_one = singly;
  regroup();
}

bool Batch::Impl::fits(std::span<const std::uint8_t> marked, bool singly) const {
  if (active.empty() || singly != one_by_one) return false;
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    const bool wanted = (marked.empty() || marked[i] != 0) && lanes[i].model != nullptr;
    if (wanted != (active[i] != 0)) return false;
  }
  return std::all_of(running.begin(), running.end(), [](const Group* group) {
    return group->tables->layout == layout_of(group->lanes.size());
  });
}

void Batch::Impl::regroup() {
  // Only groups with an active lane are touched: stepping lanes in turn costs each
  // step a group, not the batch.
  std::vector<const Group*> touched;
  for (std::size_t i = 0; i < lanes.size(); ++i)
    if (active[i] != 0) touched.push_back(places[i].group);
  std::sort(touched.begin(), touched.end());
  std::vector<std::size_t> stepped;
  std::vector<std::size_t> idle;
  for (std::size_t i = 0; i < lanes.size(); ++i)
    if (std::binary_search(touched.begin(), touched.end(), places[i].group))
      (active[i] != 0 ? stepped : idle).push_back(i);
  deal(std::move(stepped), one_by_one);
  deal(std::move(idle), false);
  std::erase_if(groups, [](const std::unique_ptr<Group>& group) { return group->lanes.empty(); });
  running.clear();
  for (std::size_t i = 0; i < lanes.size(); ++i)
    if (active[i] != 0 && places[i].lane == 0) running.push_back(places[i].group);
}

// Puts lanes of one kind together, a register full at a time.
void Batch::Impl::deal(std::vector<std::size_t> waiting, bool singly) {
  while (!waiting.empty()) {
    const Kind* const kind = lanes[waiting.front()].kind.get();
    const auto others = std::stable_partition(
        waiting.begin(), waiting.end(), [&](std::size_t i) { return lanes[i].kind.get() == kind; });
    const std::size_t most = singly ? 1 : most_lanes();
    std::span<const std::size_t> alike(waiting.data(),
                                       static_cast<std::size_t>(others - waiting.begin()));
    while (!alike.empty()) {
      std::size_t count = std::min(most, alike.size());
      if (count < fewest_side_by_side) count = 1;
      put_together(alike.first(count));
      alike = alike.subspan(count);
    }
    waiting.erase(waiting.begin(), others);
  }
}

void Batch::Impl::put_together(std::span<const std::size_t> members) {
  const std::shared_ptr<Kind> kind = lanes[members[0]].kind;
  const Layout layout = layout_of(members.size());
  const Group& old = *places[members[0]].group;
  const bool together =
      old.tables->layout == layout && old.lanes.size() == members.size() &&
      std::equal(members.begin(), members.end(), old.lanes.begin(),
                 [&](std::size_t i, const Lane* lane) { return lane == &lanes[i]; });
  if (together) return;
  auto group = std::make_unique<Group>(kind, layout);
  for (std::size_t i = 0; i < members.size(); ++i) {
    Place& place = places[members[i]];
    copy_lane(*place.group, place.lane, *group, i);
    Lane* const lane = &lanes[members[i]];
    group->lanes.push_back(lane);
    // Where the others of the old group are stays as it is, until all have left.
    std::replace(place.group->lanes.begin(), place.group->lanes.end(), lane,
                 static_cast<Lane*>(nullptr));
    if (std::all_of(place.group->lanes.begin(), place.group->lanes.end(),
                    [](const Lane* left) { return left == nullptr; }))
      place.group->lanes.clear();
    place = {group.get(), i};
  }
  groups.push_back(std::move(group));
}

// ---- the batch ---------------------------------------------------------------------------

Batch::Batch(std::size_t lanes) : impl_(std::make_unique<Impl>(lanes)) {}
Batch::~Batch() = default;
Batch::Batch(Batch&&) noexcept = default;

std::size_t Batch::lanes() const { return impl_->lanes.size(); }
const Model& Batch::model(std::size_t lane) const { return *impl_->lanes[lane].model; }
std::span<double> Batch::targets(std::size_t lane) { return impl_->lanes[lane].targets; }
LaneStatus Batch::status(std::size_t lane) const { return impl_->lanes[lane].status; }

void Batch::place(std::size_t lane, std::shared_ptr<const Model> model) {
  Lane& it = impl_->lanes[lane];
  if (!it.kind || !it.kind->holds(*model)) impl_->settle(lane, impl_->kind_of(model));
  it.model = std::move(model);
  prepare_lists(it.model->compiled(), it.contacts);
  set_state(lane, initial_state(*it.model));
}

void Batch::place(std::size_t lane, const Model& model) {
  place(lane, std::shared_ptr<const Model>(std::shared_ptr<const Model>(), &model));
}

State Batch::state(std::size_t lane) const {
  const auto& [group, column] = impl_->places[lane];
  const Plan& plan = group->kind->plan();
  const std::size_t width = group->width();
  const std::size_t points = plan.site_of.size();
  State state;
  for (auto* array : {&state.positions, &state.velocities, &state.previous}) array->resize(points);
  for (std::size_t p = 0; p < points; ++p) {
    const std::size_t o = pair_offset(plan.site_of[p], width) + column;
    const auto pair = [&](const double* row) { return Vec2{row[o], row[o + width]}; };
    state.positions[p] = pair(group->rows.position);
    state.velocities[p] = pair(group->rows.velocity);
    state.previous[p] = pair(group->rows.previous);
  }
  state.targets = impl_->lanes[lane].targets;
  return state;
}

void Batch::set_state(std::size_t lane, const State& state) {
  Lane& it = impl_->lanes[lane];
  const auto& [group, column] = impl_->places[lane];
  const Plan& plan = group->kind->plan();
  const std::size_t width = group->width();
  const std::size_t points = plan.site_of.size();
  for (std::size_t p = 0; p < points; ++p) {
    const std::size_t o = pair_offset(plan.site_of[p], width) + column;
    const auto put = [&](Vec2 v, double* row) {
      row[o] = v.x;
      row[o + width] = v.y;
    };
    put(state.positions[p], group->rows.position);
    put(state.velocities[p], group->rows.velocity);
    put(state.previous[p], group->rows.previous);
  }
  it.targets = state.targets;
  it.contacts.invalidate();
  it.status = LaneStatus::done;
}

void Batch::read_moving(std::size_t lane, std::span<Vec2> positions,
                        std::span<Vec2> velocities) const {
  const auto& [group, column] = impl_->places[lane];
  const std::size_t width = group->width();
  const double* position = group->rows.position + column;
  const double* velocity = group->rows.velocity + column;
  const std::int32_t* site = group->kind->plan().site_of.data();
  for (const ModelObject& object : model(lane).objects()) {
    if (object.is_static) continue;
    auto to = static_cast<std::size_t>(object.first_point);
    for (int i = 0; i < object.points; ++i, ++site, ++to) {
      const std::size_t o = pair_offset(*site, width);
      positions[to] = {position[o], position[o + width]};
      velocities[to] = {velocity[o], velocity[o + width]};
    }
  }
}

void Batch::step(std::span<const std::uint8_t> active, ThreadPool* pool, const Stepped& stepped,
                 Tape* tape) {
  Impl& impl = *impl_;
  const int threads = pool == nullptr ? 1 : pool->threads();
  impl.group_for(active, threads);
  if (impl.workspaces.size() < static_cast<std::size_t>(threads))
    impl.workspaces.resize(static_cast<std::size_t>(threads));
  if (tape != nullptr) tape->impl().begin(impl.running.size());
  const auto run = [&](std::size_t i, int worker) {
    Group& group = *impl.running[i];
    StepRecord* record = tape == nullptr ? nullptr : &tape->impl().records[i];
    if (record != nullptr) record->begin(group, impl.lanes.data(), tape->impl().onset);
    step_group(group, impl.workspaces[static_cast<std::size_t>(worker)], record);
    if (!stepped) return;
    for (const Lane* lane : group.lanes) stepped(impl.index_of(lane));
  };
  if (threads > 1 && impl.running.size() > 1) {
    pool->run(impl.running.size(), run);
  } else {
    for (std::size_t i = 0; i < impl.running.size(); ++i) run(i, 0);
  }
}

}  // namespace evo
