#include "libevo/task/env.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "libevo/base/error.h"
#include "libevo/base/random.h"
#include "libevo/task/compiled.h"

namespace evo {

// ---- arena --------------------------------------------------------------------

namespace {

Arena::Compiled bind_named(TaskSpec task, Body robot) {
  const std::string where = "task '" + task.name + "'";
  try {
    return bind_task(std::move(task), std::move(robot));
  } catch (const Error& failure) {
    throw failure.at(where);
  }
}

}  // namespace

Arena::Arena(TaskSpec task, Body robot)
    : compiled_(std::make_unique<const Compiled>(bind_named(std::move(task), std::move(robot)))) {}
Arena::~Arena() = default;

const TaskSpec& Arena::task() const { return compiled_->task; }
const Body& Arena::robot() const { return compiled_->robot; }
const Model& Arena::model() const { return compiled_->stage->model; }
const std::vector<ObservationSlice>& Arena::layout() const { return compiled_->layout; }
int Arena::observation_length() const { return compiled_->observation_length; }
int Arena::action_length() const { return compiled_->stage->model.actuators(); }

Draws Arena::draw(std::uint64_t seed, std::uint64_t index) const {
  const TaskSpec& spec = task();
  Stream stream(seed, "draws", spec.name, index);
  Draws draws;
  for (const DrawnInteger& integer : spec.draws)
    draws.integers[integer.name] = stream.integer(integer.low, integer.high);
  if (!spec.goals) return draws;
  int place = spec.goals->start;
  for (int path = 0; path < spec.goals->distance;) {
    const int goal = stream.integer(spec.goals->low, spec.goals->high);
    path += std::abs(place - goal);
    place = goal;
    draws.goals.push_back(goal);
  }
  return draws;
}

// ---- environments ---------------------------------------------------------------

namespace {

struct Environment {
  Episode episode;
  std::shared_ptr<const Stage> stage;
  State state;
  std::vector<OrientationReference> references;
  std::vector<Vec2> positions;  // as queries see them: stale after self-folding
  std::vector<Vec2> velocities;
  std::vector<double> slots;  // measured in positions
  std::vector<double> previous_slots;
  std::vector<Vec2> work;
};

void check_draws(const TaskSpec& task, const Draws& draws) {
  std::vector<std::string> names;
  for (const DrawnInteger& integer : task.draws) {
    names.push_back(integer.name);
    if (draws.integers.count(integer.name) == 0)
      throw error(Failure::usage, "task '{}' draws '{}', for which no value was given", task.name,
                  integer.name);
  }
  for (const auto& [name, value] : draws.integers)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw error(Failure::usage, "task '{}' does not draw '{}'{}", task.name, name,
                  did_you_mean(name, names));
  if (task.goals && draws.goals.empty())
    throw error(Failure::usage, "task '{}' draws goals, of which none was given", task.name);
  if (!task.goals && !draws.goals.empty())
    throw error(Failure::usage, "task '{}' does not draw goals", task.name);
}

bool moves_objects(const TaskSpec& task) {
  return std::any_of(task.objects.begin(), task.objects.end(), [](const Placement& placement) {
    return !placement.offset_x.empty() || !placement.offset_y.empty();
  });
}

std::shared_ptr<const Stage> stage_for(const Arena::Compiled& arena, const Draws& draws) {
  if (!moves_objects(arena.task)) return arena.stage;
  try {
    return make_stage(arena, draws);
  } catch (const Error& failure) {
    throw failure.at("task '" + arena.task.name + "' with these draws");
  }
}

void shift(State& state, double amount, std::uint64_t seed) {
  Stream stream(seed, "jitter");
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    state.x[i] += amount * (2.0 * stream.uniform() - 1.0);
    state.y[i] += amount * (2.0 * stream.uniform() - 1.0);
  }
  state.previous_x = state.x;
  state.previous_y = state.y;
  state.restart_contacts();
}

// What moved, from the simulation to the snapshot; terrain is there already.
void read_moving(const std::vector<PointRange>& moving, const State& state, Environment& e) {
  std::size_t from = 0;
  for (const PointRange& object : moving) {
    auto to = static_cast<std::size_t>(object.first);
    for (int i = 0; i < object.count; ++i, ++from, ++to) {
      e.positions[to] = {state.x[from], state.y[from]};
      e.velocities[to] = {state.vx[from], state.vy[from]};
    }
  }
}

}  // namespace

struct VecEnv::Impl {
  Impl(const Arena::Compiled& compiled, int count)
      : arena(compiled),
        environments(static_cast<std::size_t>(count)),
        observation_length(static_cast<std::size_t>(compiled.observation_length)),
        action_length(static_cast<std::size_t>(compiled.stage->model.actuators())),
        observations(environments.size() * observation_length),
        rewards(environments.size()),
        terminated(environments.size()),
        truncated(environments.size()),
        lanes(environments.size()),
        lane_environments(environments.size()) {
    for (Environment& environment : environments) place(environment, compiled.stage);
  }

  // On a stage, at rest, in the arrays' final sizes.
  void place(Environment& environment, std::shared_ptr<const Stage> stage) const {
    const auto points = static_cast<std::size_t>(stage->model.points());
    environment.stage = std::move(stage);
    environment.state = initial_state(environment.stage->model);
    environment.positions.resize(points);
    environment.velocities.resize(points);
    environment.slots.resize(static_cast<std::size_t>(arena.slots));
    environment.previous_slots.resize(static_cast<std::size_t>(arena.slots));
    read_positions(environment.stage->model, environment.state, environment.positions);
    read_velocities(environment.stage->model, environment.state, environment.velocities);
    environment.references = make_references(arena, environment.positions);
  }

  std::span<double> observation(std::size_t index) {
    return std::span(observations).subspan(index * observation_length, observation_length);
  }

  void look(std::size_t index) {
    Environment& e = environments[index];
    evo::observe(arena, e.stage->terrains, e.episode, {e.positions, e.velocities}, e.slots,
                 observation(index));
  }

  void finish(std::size_t index, StepResult result);
  void run_lanes(std::size_t first, std::size_t last);

  const Arena::Compiled& arena;
  std::vector<Environment> environments;
  std::size_t observation_length;
  std::size_t action_length;
  std::vector<double> observations;
  std::vector<double> rewards;
  std::vector<std::uint8_t> terminated;
  std::vector<std::uint8_t> truncated;
  // Of the step being taken: one lane an active environment.
  std::vector<Lane> lanes;
  std::vector<std::size_t> lane_environments;
};

VecEnv::VecEnv(const Arena& arena, int environments) {
  if (environments < 1)
    throw error(Failure::usage, "at least one environment is needed, found {}", environments);
  impl_ = std::make_unique<Impl>(arena.compiled(), environments);
}
VecEnv::~VecEnv() = default;
VecEnv::VecEnv(VecEnv&&) noexcept = default;
VecEnv& VecEnv::operator=(VecEnv&&) noexcept = default;

int VecEnv::environments() const { return static_cast<int>(impl_->environments.size()); }

void VecEnv::reset(int environment, const EpisodeStart& start) {
  Impl& impl = *impl_;
  const auto index = static_cast<std::size_t>(environment);
  check_draws(impl.arena.task, start.draws);

  Environment& e = impl.environments[index];
  impl.place(e, stage_for(impl.arena, start.draws));
  if (start.jitter != 0.0) {
    shift(e.state, start.jitter * impl.arena.voxel_length, start.jitter_seed);
    read_moving(impl.arena.moving, e.state, e);
    e.references = make_references(impl.arena, e.positions);
  }
  e.episode = {start.draws, 0, 0};
  measure(impl.arena, e.references, e.positions, e.work, e.slots);
  impl.look(index);
  impl.rewards[index] = 0.0;
  impl.terminated[index] = 0;
  impl.truncated[index] = 0;
}

// ---- stepping -------------------------------------------------------------------

// After self-folding all queries still see the snapshot before the step, while
// the simulation goes on from where it stopped (tasks, A.4).
void VecEnv::Impl::finish(std::size_t index, StepResult result) {
  Environment& e = environments[index];
  const bool folded = result == StepResult::self_folding;
  e.previous_slots = e.slots;
  if (!folded) {
    read_moving(arena.moving, e.state, e);
    measure(arena, e.references, e.positions, e.work, e.slots);
  }
  look(index);
  const StepOutcome outcome = judge(arena, e.episode, e.previous_slots, e.slots, folded);
  rewards[index] = outcome.reward;
  terminated[index] = outcome.terminated ? 1 : 0;
  truncated[index] = outcome.truncated ? 1 : 0;

  double sum = outcome.reward;  // finite only if all are
  for (const double value : observation(index)) sum += value;
  if (!std::isfinite(sum))
    throw error(Failure::work,
                "task '{}': the simulation became unstable in step {} of an episode: an "
                "observation or the reward is not a number",
                arena.task.name, e.episode.steps);
}

void VecEnv::Impl::run_lanes(std::size_t first, std::size_t last) {
  evo::step(std::span(lanes).subspan(first, last - first));
  for (std::size_t lane = first; lane < last; ++lane)
    finish(lane_environments[lane], lanes[lane].result);
}

namespace {

constexpr std::size_t vector_lanes = 4;  // doubles in a common vector register

// Even shares, in whole vectors where there is more than one for each thread.
std::size_t lanes_per_chunk(std::size_t lanes, int threads) {
  const std::size_t workers = static_cast<std::size_t>(threads);
  const std::size_t share = (lanes + workers - 1) / workers;
  if (share <= vector_lanes) return share;
  return (share + vector_lanes - 1) / vector_lanes * vector_lanes;
}

void set_targets(State& state, std::span<const double> targets, std::size_t environment) {
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (!std::isfinite(targets[i]))
      throw error(Failure::work, "target {} of environment {} is not a number", i, environment);
    state.targets[i] = targets[i];
  }
}

}  // namespace

void VecEnv::step(std::span<const double> actions, std::span<const std::uint8_t> active,
                  ThreadPool* pool) {
  Impl& impl = *impl_;
  std::size_t count = 0;
  for (std::size_t i = 0; i < impl.environments.size(); ++i) {
    if (!active.empty() && active[i] == 0) continue;
    Environment& e = impl.environments[i];
    set_targets(e.state, actions.subspan(i * impl.action_length, impl.action_length), i);
    impl.lanes[count] = {&e.stage->model, &e.state, StepResult::done};
    impl.lane_environments[count] = i;
    ++count;
  }
  if (count == 0) return;
  if (pool == nullptr || pool->threads() == 1) {
    impl.run_lanes(0, count);
    return;
  }
  const std::size_t chunk = lanes_per_chunk(count, pool->threads());
  pool->run((count + chunk - 1) / chunk, [&](std::size_t i, int) {
    impl.run_lanes(i * chunk, std::min(count, (i + 1) * chunk));
  });
}

std::span<const double> VecEnv::observations() const { return impl_->observations; }
std::span<const double> VecEnv::rewards() const { return impl_->rewards; }
std::span<const std::uint8_t> VecEnv::terminated() const { return impl_->terminated; }
std::span<const std::uint8_t> VecEnv::truncated() const { return impl_->truncated; }

namespace {

template <typename Impl>
const Environment& environment_of(const Impl& impl, int environment) {
  return impl.environments[static_cast<std::size_t>(environment)];
}

}  // namespace

int VecEnv::steps(int environment) const {
  return environment_of(*impl_, environment).episode.steps;
}
std::span<const Vec2> VecEnv::positions(int environment) const {
  return environment_of(*impl_, environment).positions;
}
std::span<const Vec2> VecEnv::velocities(int environment) const {
  return environment_of(*impl_, environment).velocities;
}
const Model& VecEnv::model(int environment) const {
  return environment_of(*impl_, environment).stage->model;
}

// ---- checkpoints ------------------------------------------------------------------

namespace {

class ByteWriter {
 public:
  template <typename T>
  void value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof(T));
  }
  template <typename T>
  void values(const std::vector<T>& values) {
    value(static_cast<std::uint64_t>(values.size()));
    for (const T& v : values) value(v);
  }
  void text(const std::string& text) { values(std::vector<char>(text.begin(), text.end())); }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  template <typename T>
  void value(T& value) {
    if (rest_.size() < sizeof(T)) refuse();
    std::memcpy(&value, rest_.data(), sizeof(T));
    rest_ = rest_.subspan(sizeof(T));
  }
  template <typename T>
  void values(std::vector<T>& values) {
    std::uint64_t size = 0;
    value(size);
    if (size > rest_.size() / sizeof(T)) refuse();
    values.resize(static_cast<std::size_t>(size));
    for (T& v : values) value(v);
  }
  // An array whose length is known.
  template <typename T>
  void fill(std::vector<T>& expected) {
    const std::size_t size = expected.size();
    values(expected);
    if (expected.size() != size) refuse();
  }
  std::string text() {
    std::vector<char> letters;
    values(letters);
    return {letters.begin(), letters.end()};
  }
  void finish() const {
    if (!rest_.empty()) refuse();
  }

  [[noreturn]] static void refuse() {
    throw error(Failure::data, "the saved environments do not belong to this task and robot");
  }

 private:
  std::span<const std::uint8_t> rest_;
};

void save_episode(ByteWriter& out, const Episode& episode) {
  out.value(static_cast<std::uint64_t>(episode.draws.integers.size()));
  for (const auto& [name, value] : episode.draws.integers) {
    out.text(name);
    out.value(value);
  }
  out.values(episode.draws.goals);
  out.value(episode.steps);
  out.value(episode.goal);
}

Episode load_episode(ByteReader& in) {
  Episode episode;
  std::uint64_t integers = 0;
  in.value(integers);
  for (std::uint64_t i = 0; i < integers; ++i) {
    const std::string name = in.text();
    in.value(episode.draws.integers[name]);
  }
  in.values(episode.draws.goals);
  in.value(episode.steps);
  in.value(episode.goal);
  return episode;
}

// Everything an environment has but its stage, which follows from the draws,
// and contact candidates, which are found again. One list for both directions.
template <typename Environment, typename Visit>
void for_each_array(Environment& e, Visit visit) {
  visit(e.state.x);
  visit(e.state.y);
  visit(e.state.vx);
  visit(e.state.vy);
  visit(e.state.previous_x);
  visit(e.state.previous_y);
  visit(e.state.targets);
  visit(e.positions);
  visit(e.velocities);
  visit(e.slots);
}

template <typename Reference, typename Visit>
void for_each_reference_array(Reference& reference, Visit visit) {
  visit(reference.direction);
  visit(reference.radius);
}

}  // namespace

std::vector<std::uint8_t> VecEnv::save() const {
  const Impl& impl = *impl_;
  ByteWriter out;
  const auto write = [&](const auto& values) { out.values(values); };
  out.value(static_cast<std::uint64_t>(impl.environments.size()));
  for (const Environment& e : impl.environments) {
    save_episode(out, e.episode);
    for_each_array(e, write);
    for (const OrientationReference& reference : e.references) {
      for_each_reference_array(reference, write);
      out.value(reference.radius_sum);
    }
  }
  write(impl.observations);
  write(impl.rewards);
  write(impl.terminated);
  write(impl.truncated);
  return out.take();
}

void VecEnv::load(std::span<const std::uint8_t> bytes) {
  const Impl& current = *impl_;
  auto loaded = std::make_unique<Impl>(current.arena, environments());
  ByteReader in(bytes);
  const auto read = [&](auto& values) { in.fill(values); };
  std::uint64_t count = 0;
  in.value(count);
  if (count != loaded->environments.size()) ByteReader::refuse();
  for (Environment& e : loaded->environments) {
    e.episode = load_episode(in);
    // Never reset: no draws yet.
    const bool begun = !e.episode.draws.integers.empty() || !moves_objects(loaded->arena.task);
    if (begun) loaded->place(e, stage_for(loaded->arena, e.episode.draws));
    for_each_array(e, read);
    e.state.restart_contacts();
    for (OrientationReference& reference : e.references) {
      for_each_reference_array(reference, read);
      in.value(reference.radius_sum);
    }
  }
  read(loaded->observations);
  read(loaded->rewards);
  read(loaded->terminated);
  read(loaded->truncated);
  in.finish();
  impl_ = std::move(loaded);
}

// ---- the pure part of a step -------------------------------------------------------

namespace {

std::vector<double> measured(const Arena::Compiled& arena, const Model& model,
                             const Snapshot& snapshot) {
  std::vector<double> slots(static_cast<std::size_t>(arena.slots));
  std::vector<Vec2> work;
  measure(arena, make_references(arena, model.initial_positions()), snapshot.positions, work,
          slots);
  return slots;
}

}  // namespace

void observe(const Arena& arena, const Model& model, const Episode& episode, const Snapshot& now,
             std::span<double> observation) {
  const Arena::Compiled& compiled = arena.compiled();
  observe(compiled, make_terrains(compiled, model), episode, {now.positions, now.velocities},
          measured(compiled, model, now), observation);
}

StepOutcome judge(const Arena& arena, const Model& model, Episode& episode, const Snapshot& pre,
                  const Snapshot& post, bool folded) {
  const Arena::Compiled& compiled = arena.compiled();
  return judge(compiled, episode, measured(compiled, model, pre), measured(compiled, model, post),
               folded);
}

}  // namespace evo
