// Many simulations that are stepped together: their models and states, what they
// know of contacts, and how each came out of its last step.
//
// A lane is the place of one simulation. Lanes whose models share their moving
// objects are kept in groups, side by side in the lanes of vector registers, and
// are stepped where they are kept: states are copied only when they are read or
// written here, and when groups change. The bits of a lane's result do not depend
// on its neighbours, on the number of lanes or threads, or on the instruction set
// (in fast arithmetic only on whether it fuses multiply-adds).
//
// Two batches share nothing that changes: each may be stepped in a thread of its
// own. One batch is one thread's at a time, but for what step() does in a pool.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "libevo/base/parallel.h"
#include "libevo/sim/model.h"
#include "libevo/sim/state.h"

namespace evo {

class Tape;

// How a lane came out of its last step.
enum class LaneStatus : std::uint8_t {
  done,
  self_folding,  // a robot folded onto itself: stopped after the folding substep
  unstable,      // values are not finite any more, or it folded at over a voxel per substep
};

class Batch {
 public:
  // `lanes` of them, empty: every one needs a place() before anything else.
  explicit Batch(std::size_t lanes);
  ~Batch();
  Batch(Batch&&) noexcept;

  std::size_t lanes() const;

  // Puts a simulation of the model into a lane, at rest at its initial positions
  // with all targets 1. The batch keeps the model alive as long as it needs it; one
  // given by reference must outlive the batch.
  void place(std::size_t lane, std::shared_ptr<const Model> model);
  void place(std::size_t lane, const Model& model);
  const Model& model(std::size_t lane) const;

  // A lane's state, whole; one that is put back, of the same model, continues to the same bits.
  State state(std::size_t lane) const;
  void set_state(std::size_t lane, const State& state);

  // What the next steps aim for, per actuator of any robot: share of the rest
  // length, clipped to the physics' range. To be written to.
  std::span<double> targets(std::size_t lane);

  // Positions and velocities, raw units, of the points that can move: their
  // entries in arrays over all points of the world, [model.points()] each, in
  // world order. The entries of static points are left alone.
  void read_moving(std::size_t lane, std::span<Vec2> positions, std::span<Vec2> velocities) const;

  // Called with each lane as soon as it has been stepped, by the thread that did.
  using Stepped = std::function<void(std::size_t lane)>;

  // One control step (docs/physics.md, "Time" and "Order of one substep") of the lanes marked in
  // `active`, [lanes], or of all if it is empty; empty lanes stay so. The work is done
  // by the calling thread, or by the threads of `pool`, a group at a time. A group has
  // as many lanes of equal objects as a register (2 to 8, by instruction set and
  // arithmetic), or one where fewer are left or there are at most two lanes per
  // thread; with fewer groups than threads, some threads have nothing to do. Gradients can
  // be pulled back through the step with `tape` (adjoint.h), whose last step is forgotten.
  void step(std::span<const std::uint8_t> active = {}, ThreadPool* pool = nullptr,
            const Stepped& stepped = {}, Tape* tape = nullptr);

  // How the lane came out of its last step, which later ones of other lanes do not change; `done`
  // after place() and set_state(). An unstable lane can be stepped on, or placed anew.
  LaneStatus status(std::size_t lane) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace evo
