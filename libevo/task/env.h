// Episodes. An Arena is one robot in one task, compiled once; a VecEnv runs any
// number of episodes side by side, of one arena or of several. See docs/tasks.md, "A step".
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libevo/base/parallel.h"
#include "libevo/sim/batch.h"
#include "libevo/task/spec.h"

namespace evo {

// Where a part of the observation lies in the vector.
struct ObservationSlice {
  std::string name;
  int offset = 0;
  int length = 0;
  bool operator==(const ObservationSlice&) const = default;
};

class Arena {
 public:
  // Throws Error(data) where the robot cannot stand in the task's world or has
  // no actuator, and where the task makes no sense: an object that does not
  // exist, a world object with actuators, goals observed but never drawn.
  Arena(TaskSpec task, Body robot);
  ~Arena();
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  const TaskSpec& task() const;
  const Body& robot() const;
  const Model& model() const;  // with all draws at their lowest value
  const std::vector<ObservationSlice>& layout() const;
  int observation_length() const;
  int action_length() const;

  // The draws of episode `index` under `seed`: the same for every robot.
  Draws draw(std::uint64_t seed, std::uint64_t index) const;

  struct Compiled;  // private to libevo/task
  const Compiled& compiled() const { return *compiled_; }

 private:
  std::unique_ptr<const Compiled> compiled_;
};

// How an episode starts.
struct EpisodeStart {
  Draws draws;
  double jitter = 0.0;  // every start coordinate moved by up to this, voxels
  std::uint64_t jitter_seed = 0;
};

class StepTape;

class VecEnv {
 public:
  // `environments` episodes of one arena, which must outlive this. All arrays
  // are environment-major: observations [E x D], actions [E x A].
  VecEnv(const Arena& arena, int environments);
  // An episode of each of these arenas, which must outlive this: other bodies, tasks
  // and lengths side by side. Arrays are environment-major: the observation of
  // environment e is the arena's observation_length() values from
  // observation_offset(e) on, its action the action_length() ones from
  // action_offset(e) on.
  explicit VecEnv(std::span<const Arena* const> arenas);
  ~VecEnv();
  VecEnv(VecEnv&&) noexcept;
  VecEnv& operator=(VecEnv&&) noexcept;

  int environments() const;
  const Arena& arena(int environment) const;
  std::size_t observation_offset(int environment) const;
  std::size_t action_offset(int environment) const;
  std::size_t point_offset(int environment) const;

  // Throws Error(usage) for draws that are not the task's.
  void reset(int environment, const EpisodeStart& start);

  // One step (TaskSpec::hold control steps) of the environments marked in `active` (all, if empty);
  // the others stay as they are. Targets are absolute, share of the rest length,
  // clipped to the physics' range. Does not reset what ended. The work is done by
  // the calling thread, or by the threads of `pool`, with the same bits. Threads share
  // it by groups of environments of one body: as many as a vector register has lanes,
  // or single ones where there are at most two per thread (Batch::step). Throws
  // Error(work), before anything is stepped, for a target that is not a number. Gradients can
  // be pulled back through the step with `tape` (step_tape.h), whose last step is forgotten.
  void step(std::span<const double> actions, std::span<const std::uint8_t> active = {},
            ThreadPool* pool = nullptr, StepTape* tape = nullptr);

  // How an environment came out of its last step; `done` after reset. Where it is
  // unstable, a position, a velocity, the observation or the reward is not a finite
  // number: all that is left to do is to reset it. The others are not touched by it.
  LaneStatus status(int environment) const;

  // After reset and step, of every environment (zeros before its first reset):
  std::span<const double> observations() const;      // [E x D], or by offsets
  std::span<const double> rewards() const;           // [E]
  std::span<const std::uint8_t> terminated() const;  // [E] ended by a rule
  std::span<const std::uint8_t> truncated() const;   // [E] ended by the time limit
  int steps(int environment) const;                  // steps taken in this episode

  // What queries of the benchmark read: all points of the world in world
  // order, raw units; after self-folding those of the step before (docs/tasks.md, "A step").
  // Those of all environments one after the other, from point_offset(e) on, or of one.
  std::span<const Vec2> positions() const;
  std::span<const Vec2> velocities() const;
  std::span<const Vec2> positions(int environment) const;
  std::span<const Vec2> velocities(int environment) const;
  const Model& model(int environment) const;  // of this episode (draws move objects)

  // All that decides how the episodes continue, for checkpoints: an opaque array
  // of bytes of this build's layout, restored by load() into a VecEnv of the
  // same arenas. load() throws Error(data) for bytes that do not fit.
  std::vector<std::uint8_t> save() const;
  void load(std::span<const std::uint8_t> bytes);
  // One environment's, to be put into any of the same arena: an episode continues from
  // there as often as it is asked to, each time to the same bits. After an Error(data)
  // the environment has to be reset.
  std::vector<std::uint8_t> save(int environment) const;
  void load(int environment, std::span<const std::uint8_t> bytes);

  // Moves every point of an episode in progress by up to `jitter` voxels in each
  // coordinate, together with its previous position: velocities and the step counter
  // stay, and no step's reward counts the move.
  void perturb(int environment, double jitter, std::uint64_t seed);
  // Moves an object that is no terrain, as it is, by raw units; the rest as above.
  void translate(int environment, std::size_t object, Vec2 by);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Throws Error(work) that names the task and the step if an environment is unstable:
// for callers who have no use for the others then.
void require_stable(const VecEnv& env);

// ---- the pure part of a step ------------------------------------------------

// All points of the world in world order, raw units.
struct Snapshot {
  std::vector<Vec2> positions;
  std::vector<Vec2> velocities;
};

// What an episode remembers besides the simulation.
struct Episode {
  Draws draws;
  int steps = 0;
  int goal = 0;                 // goals reached; the next one counts
  std::vector<double> targets;  // [A] of the last step, clipped; empty before the first
};

struct StepOutcome {
  double reward = 0.0;
  bool terminated = false;
  bool truncated = false;
};

// Snapshots in, observation, reward and end flags out: what VecEnv does after
// the simulation, for states that no simulation gave. Orientations are measured
// against `model`'s initial positions. In a step, observe() comes first: it
// shows the goal from before the step.
void observe(const Arena& arena, const Model& model, const Episode& episode, const Snapshot& now,
             std::span<double> observation);
// Counts the step in `episode`. `targets`: [A], as they were given. `folded`: the simulator
// reported self-folding, and `post` is what `pre` was.
StepOutcome judge(const Arena& arena, const Model& model, Episode& episode, const Snapshot& pre,
                  const Snapshot& post, std::span<const double> targets, bool folded);

}  // namespace evo
