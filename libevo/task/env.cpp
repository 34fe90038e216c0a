#include "libevo/task/env.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libevo/base/bytes.h"
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
const Model& Arena::model() const { return compiled_->world->model; }
const std::vector<ObservationSlice>& Arena::layout() const { return compiled_->layout; }
int Arena::observation_length() const { return compiled_->observation_length; }
int Arena::action_length() const { return compiled_->world->model.actuators(); }

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

// All of an environment but its simulation, which is a lane of the batch.
struct Environment {
  const Arena* arena = nullptr;
  std::size_t observation_offset = 0;
  std::size_t action_offset = 0;
  LaneStatus status = LaneStatus::done;
  Episode episode;
  std::shared_ptr<const EpisodeWorld> world;
  std::vector<InitialShape> initial_shapes;
  std::size_t point_offset = 0;
  std::span<Vec2> positions;  // as queries see them: stale after self-folding
  std::span<Vec2> velocities;
  std::vector<double> quantities;  // measured in positions
  std::vector<double> previous_quantities;
  std::vector<double> targets;  // of the step under way, clipped
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
    throw error(Failure::usage, "task '{}' draws goals, and none was given", task.name);
  if (!task.goals && !draws.goals.empty())
    throw error(Failure::usage, "task '{}' does not draw goals", task.name);
}

bool moves_objects(const TaskSpec& task) {
  return std::any_of(task.objects.begin(), task.objects.end(), [](const Placement& placement) {
    return !placement.offset_x.empty() || !placement.offset_y.empty();
  });
}

std::shared_ptr<const EpisodeWorld> episode_world_for(const Arena::Compiled& arena,
                                                      const Draws& draws) {
  if (!moves_objects(arena.task)) return arena.world;
  try {
    return make_episode_world(arena, draws);
  } catch (const Error& failure) {
    throw failure.at("task '" + arena.task.name + "' with these draws");
  }
}

void clip(std::span<const double> targets, const Physics& physics, std::vector<double>& clipped) {
  clipped.clear();
  for (const double target : targets) clipped.push_back(physics.clip(target));
}

void shift(State& state, double amount, std::uint64_t seed) {
  Stream stream(seed, "jitter");
  for (Vec2& position : state.positions) {
    position.x += amount * (2.0 * stream.uniform() - 1.0);
    position.y += amount * (2.0 * stream.uniform() - 1.0);
  }
  state.previous = state.positions;
}

}  // namespace

struct VecEnv::Impl {
  explicit Impl(std::span<const Arena* const> arenas)
      : environments(arenas.size()),
        batch(arenas.size()),
        rewards(arenas.size()),
        terminated(arenas.size()),
        truncated(arenas.size()) {
    std::size_t observation_lengths = 0;
    std::size_t points = 0;
    for (const Arena* arena : arenas) points += static_cast<std::size_t>(arena->model().points());
    positions.resize(points);
    velocities.resize(points);
    points = 0;
    for (std::size_t i = 0; i < arenas.size(); ++i) {
      Environment& e = environments[i];
      e.arena = arenas[i];
      e.observation_offset = observation_lengths;
      e.action_offset = action_lengths;
      observation_lengths += static_cast<std::size_t>(e.arena->observation_length());
      action_lengths += static_cast<std::size_t>(e.arena->action_length());
      // Draws move objects and leave their number of points.
      const auto own = static_cast<std::size_t>(e.arena->model().points());
      e.point_offset = points;
      e.positions = std::span(positions).subspan(points, own);
      e.velocities = std::span(velocities).subspan(points, own);
      points += own;
      place(i, e.arena->compiled().world);
    }
    observations.resize(observation_lengths);
  }

  // In its world, at rest, in the arrays' final sizes.
  void place(std::size_t index, std::shared_ptr<const EpisodeWorld> world) {
    Environment& e = environments[index];
    const Arena::Compiled& arena = e.arena->compiled();
    e.world = std::move(world);
    e.status = LaneStatus::done;
    batch.place(index, {e.world, &e.world->model});
    const std::vector<Vec2>& initial = e.world->model.initial_positions();
    std::copy(initial.begin(), initial.end(), e.positions.begin());
    std::fill(e.velocities.begin(), e.velocities.end(), Vec2{});
    e.quantities.resize(arena.quantities);
    e.previous_quantities.resize(arena.quantities);
    e.initial_shapes = make_initial_shapes(arena, e.positions);
  }

  std::span<const double> observation(std::size_t index) const {
    const Environment& e = environments[index];
    return std::span(observations)
        .subspan(e.observation_offset, static_cast<std::size_t>(e.arena->observation_length()));
  }
  std::span<double> observation(std::size_t index) {
    const std::size_t length = std::as_const(*this).observation(index).size();
    return std::span(observations).subspan(environments[index].observation_offset, length);
  }

  // Points elsewhere: what is seen from there, and compared with after the next step.
  void move(std::size_t index, const State& to) {
    Environment& e = environments[index];
    batch.set_state(index, to);
    batch.read_moving(index, e.positions, e.velocities);
    measure(e.arena->compiled(), e.initial_shapes, e.positions, e.work, e.quantities);
    look(index);
  }

  void look(std::size_t index) {
    const Environment& e = environments[index];
    evo::observe(e.arena->compiled(), e.world->terrains, e.episode, {e.positions, e.velocities},
                 e.quantities, observation(index));
  }

  void begin(std::size_t index, StepTape::Impl::Step& step) const;
  void finish(std::size_t index);
  void finish(std::size_t index, StepTape::Impl::Step& step) const;

  void pass(Bytes& bytes);
  void pass(Bytes& bytes, std::size_t index);
  void place_saved(const Bytes& bytes, std::size_t index);

  std::vector<Environment> environments;
  Batch batch;  // environment i is lane i
  std::size_t action_lengths = 0;
  std::vector<double> observations;
  std::vector<double> rewards;
  std::vector<std::uint8_t> terminated;
  std::vector<std::uint8_t> truncated;
  std::vector<Vec2> positions;
  std::vector<Vec2> velocities;
};

namespace {

template <typename Impl>
const Environment& environment_of(const Impl& impl, int environment) {
  return impl.environments[static_cast<std::size_t>(environment)];
}

std::vector<const Arena*> copies(const Arena& arena, int environments) {
  if (environments < 1)
    throw error(Failure::usage, "at least one environment is needed, found {}", environments);
  return std::vector<const Arena*>(static_cast<std::size_t>(environments), &arena);
}

}  // namespace

VecEnv::VecEnv(const Arena& arena, int environments) : VecEnv(copies(arena, environments)) {}
VecEnv::VecEnv(std::span<const Arena* const> arenas) : impl_(std::make_unique<Impl>(arenas)) {}
VecEnv::~VecEnv() = default;
VecEnv::VecEnv(VecEnv&&) noexcept = default;
VecEnv& VecEnv::operator=(VecEnv&&) noexcept = default;

int VecEnv::environments() const { return static_cast<int>(impl_->environments.size()); }

const Arena& VecEnv::arena(int environment) const {
  return *environment_of(*impl_, environment).arena;
}
std::size_t VecEnv::observation_offset(int environment) const {
  return environment_of(*impl_, environment).observation_offset;
}
std::size_t VecEnv::action_offset(int environment) const {
  return environment_of(*impl_, environment).action_offset;
}
std::size_t VecEnv::point_offset(int environment) const {
  return environment_of(*impl_, environment).point_offset;
}

void VecEnv::reset(int environment, const EpisodeStart& start) {
  Impl& impl = *impl_;
  const auto index = static_cast<std::size_t>(environment);
  Environment& e = impl.environments[index];
  const Arena::Compiled& arena = e.arena->compiled();
  check_draws(arena.task, start.draws);

  impl.place(index, episode_world_for(arena, start.draws));
  if (start.jitter != 0.0) {
    State state = impl.batch.state(index);
    shift(state, start.jitter * arena.voxel_length, start.jitter_seed);
    impl.batch.set_state(index, state);
    impl.batch.read_moving(index, e.positions, e.velocities);
    e.initial_shapes = make_initial_shapes(arena, e.positions);
  }
  e.episode = {start.draws, 0, 0, {}};
  measure(arena, e.initial_shapes, e.positions, e.work, e.quantities);
  impl.look(index);
  impl.rewards[index] = 0.0;
  impl.terminated[index] = 0;
  impl.truncated[index] = 0;
}

// ---- stepping -------------------------------------------------------------------

// After self-folding all queries still see the snapshot before the step, while
// the simulation continues where it stopped (docs/tasks.md, "A step").
void VecEnv::Impl::finish(std::size_t index) {
  Environment& e = environments[index];
  const Arena::Compiled& arena = e.arena->compiled();
  e.status = batch.status(index);
  const bool folded = e.status == LaneStatus::self_folding;
  e.previous_quantities = e.quantities;
  if (!folded) {
    batch.read_moving(index, e.positions, e.velocities);
    measure(arena, e.initial_shapes, e.positions, e.work, e.quantities);
  }
  look(index);
  clip(batch.targets(index), arena.task.physics, e.targets);
  const StepOutcome outcome =
      judge(arena, e.episode, e.previous_quantities, e.quantities, e.targets, folded);
  rewards[index] = outcome.reward;
  terminated[index] = outcome.terminated ? 1 : 0;
  truncated[index] = outcome.truncated ? 1 : 0;

  double sum = outcome.reward;  // finite only if all are
  for (const double value : observation(index)) sum += value;
  if (!std::isfinite(sum)) e.status = LaneStatus::unstable;
}

void VecEnv::Impl::begin(std::size_t index, StepTape::Impl::Step& step) const {
  const Environment& e = environments[index];
  step.is_active = true;
  step.arena = e.arena;
  step.world = e.world;
  step.observation_offset = e.observation_offset;
  step.action_offset = e.action_offset;
  step.initial_shapes = e.initial_shapes;
  step.episode = e.episode;
  step.before.assign(e.positions.begin(), e.positions.end());
  step.quantities_before = e.quantities;
}

void VecEnv::Impl::finish(std::size_t index, StepTape::Impl::Step& step) const {
  const Environment& e = environments[index];
  step.is_done = e.status == LaneStatus::done;
  step.goal = e.episode.goal;
  step.after.assign(e.positions.begin(), e.positions.end());
  step.quantities_after = e.quantities;
}

void VecEnv::step(std::span<const double> actions, std::span<const std::uint8_t> active,
                  ThreadPool* pool, StepTape* tape) {
  Impl& impl = *impl_;
  std::vector<StepTape::Impl::Step>* steps = tape == nullptr ? nullptr : &tape->impl().steps;
  if (steps != nullptr) steps->resize(impl.environments.size());
  for (std::size_t i = 0; i < impl.environments.size(); ++i) {
    if (steps != nullptr) (*steps)[i].is_active = false;
    if (!active.empty() && active[i] == 0) continue;
    const Environment& e = impl.environments[i];
    // The robot's; other objects have no actuators (Arena).
    const std::span<double> targets = impl.batch.targets(i);
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const double target = actions[e.action_offset + k];
      if (!std::isfinite(target))
        throw error(Failure::work, "target {} of environment {} is not a finite number", k, i);
      targets[k] = target;
    }
    if (steps == nullptr) continue;
    impl.begin(i, (*steps)[i]);
    (*steps)[i].targets.assign(targets.begin(), targets.end());
  }
  const auto finish = [&](std::size_t i) {
    impl.finish(i);
    if (steps != nullptr) impl.finish(i, (*steps)[i]);
  };
  impl.batch.step(active, pool, finish, tape == nullptr ? nullptr : &tape->impl().simulation);
}

LaneStatus VecEnv::status(int environment) const {
  return environment_of(*impl_, environment).status;
}

void require_stable(const VecEnv& env) {
  for (int i = 0; i < env.environments(); ++i)
    if (env.status(i) == LaneStatus::unstable)
      throw error(Failure::work,
                  "task '{}': the simulation became unstable in step {} of an episode: a value is "
                  "not a number, or points fly further than a voxel in a substep",
                  env.arena(i).task().name, env.steps(i));
}

std::span<const double> VecEnv::observations() const { return impl_->observations; }
std::span<const double> VecEnv::rewards() const { return impl_->rewards; }
std::span<const std::uint8_t> VecEnv::terminated() const { return impl_->terminated; }
std::span<const std::uint8_t> VecEnv::truncated() const { return impl_->truncated; }

int VecEnv::steps(int environment) const {
  return environment_of(*impl_, environment).episode.steps;
}
std::span<const Vec2> VecEnv::positions() const { return impl_->positions; }
std::span<const Vec2> VecEnv::velocities() const { return impl_->velocities; }
std::span<const Vec2> VecEnv::positions(int environment) const {
  return environment_of(*impl_, environment).positions;
}
std::span<const Vec2> VecEnv::velocities(int environment) const {
  return environment_of(*impl_, environment).velocities;
}
const Model& VecEnv::model(int environment) const {
  return environment_of(*impl_, environment).world->model;
}

// ---- checkpoints ------------------------------------------------------------------

namespace {

constexpr const char* refusal = "the saved environments do not belong to this task and robot";

}  // namespace

// Everything an environment has but its world, which follows from the draws,
// and contact candidates, which are found again.
void VecEnv::Impl::pass(Bytes& bytes, std::size_t index) {
  Environment& e = environments[index];
  Episode& episode = e.episode;
  bytes(episode.draws.integers, episode.draws.goals, episode.steps, episode.goal, episode.targets);
  if (bytes.reads()) place_saved(bytes, index);
  State state = batch.state(index);
  for_each_array(state, [&](auto& values) { bytes.known(values); });
  if (bytes.reads()) batch.set_state(index, state);
  bytes.known(e.positions);
  bytes.known(e.velocities);
  bytes.known(e.quantities);
  for (InitialShape& shape : e.initial_shapes) {
    bytes.known(shape.direction);
    bytes.known(shape.radius);
    bytes(shape.radius_sum);
  }
  bytes.known(observation(index));
  bytes(rewards[index], terminated[index], truncated[index]);
}

// In the world of the draws that were read.
void VecEnv::Impl::place_saved(const Bytes& bytes, std::size_t index) {
  const Environment& e = environments[index];
  const Arena::Compiled& arena = e.arena->compiled();
  const Draws& draws = e.episode.draws;
  // Never reset: no draws yet.
  const bool no_draws = draws.integers.empty() && draws.goals.empty();
  if (!no_draws || e.episode.steps > 0) {
    try {
      check_draws(arena.task, draws);
    } catch (const Error&) {
      bytes.refuse();
    }
  }
  const bool begun = !draws.integers.empty() || !moves_objects(arena.task);
  if (begun) place(index, episode_world_for(arena, draws));
}

void VecEnv::Impl::pass(Bytes& bytes) {
  std::uint64_t count = environments.size();
  bytes(count);
  if (count != environments.size()) bytes.refuse();
  for (std::size_t i = 0; i < environments.size(); ++i) pass(bytes, i);
}

std::vector<std::uint8_t> VecEnv::save() const {
  Bytes bytes;
  impl_->pass(bytes);
  return bytes.take();
}

void VecEnv::load(std::span<const std::uint8_t> bytes) {
  std::vector<const Arena*> arenas;
  for (const Environment& e : impl_->environments) arenas.push_back(e.arena);
  auto loaded = std::make_unique<Impl>(arenas);
  Bytes in(bytes, refusal);
  loaded->pass(in);
  in.finish();
  impl_ = std::move(loaded);
}

std::vector<std::uint8_t> VecEnv::save(int environment) const {
  Bytes bytes;
  impl_->pass(bytes, static_cast<std::size_t>(environment));
  return bytes.take();
}

void VecEnv::load(int environment, std::span<const std::uint8_t> bytes) {
  Bytes in(bytes, refusal);
  impl_->pass(in, static_cast<std::size_t>(environment));
  in.finish();
}

void VecEnv::perturb(int environment, double jitter, std::uint64_t seed) {
  Impl& impl = *impl_;
  const auto index = static_cast<std::size_t>(environment);
  const double amount = jitter * impl.environments[index].arena->compiled().voxel_length;
  State state = impl.batch.state(index);
  evo::perturb(state, amount, seed);
  impl.move(index, state);
}

void VecEnv::translate(int environment, std::size_t object, Vec2 by) {
  const auto index = static_cast<std::size_t>(environment);
  State state = impl_->batch.state(index);
  evo::translate(model(environment), object, by, state);
  impl_->move(index, state);
}

// ---- the pure part of a step -------------------------------------------------------

namespace {

std::vector<double> measured(const Arena::Compiled& arena, const Model& model,
                             const Snapshot& snapshot) {
  std::vector<double> quantities(arena.quantities);
  std::vector<Vec2> work;
  measure(arena, make_initial_shapes(arena, model.initial_positions()), snapshot.positions, work,
          quantities);
  return quantities;
}

}  // namespace

void observe(const Arena& arena, const Model& model, const Episode& episode, const Snapshot& now,
             std::span<double> observation) {
  const Arena::Compiled& compiled = arena.compiled();
  observe(compiled, make_terrains(compiled, model), episode, {now.positions, now.velocities},
          measured(compiled, model, now), observation);
}

StepOutcome judge(const Arena& arena, const Model& model, Episode& episode, const Snapshot& pre,
                  const Snapshot& post, std::span<const double> targets, bool folded) {
  const Arena::Compiled& compiled = arena.compiled();
  std::vector<double> clipped;
  clip(targets, compiled.task.physics, clipped);
  return judge(compiled, episode, measured(compiled, model, pre), measured(compiled, model, post),
               clipped, folded);
}

}  // namespace evo
