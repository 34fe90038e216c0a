// What is kept of one control step of a group, so that gradients can be pulled back through it
// (adjoint.h). Private to libevo/sim.
#pragma once

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "libevo/sim/adjoint.h"
#include "libevo/sim/group.h"

namespace evo {

class StepRecord {
 public:
  // Arrays of N pairs (workspace.h), of every substep.
  enum Row : std::size_t {
    position,      // at its start
    velocity,      // of points that are integrated
    third_stage,   // positions at which stage 3 evaluates
    fourth_stage,  // and stage 4
    after_stages,  // before strain is limited
    rows
  };

  // `first_lane` of the batch; `onset` in voxels.
  void begin(const Group& group, const Lane* first_lane, double onset);
  void begin_substep(const double* previous);
  double* row(std::size_t substep, Row row) { return values_.get() + (substep * rows + row) * n_; }
  const double* row(std::size_t substep, Row row) const {
    return values_.get() + (substep * rows + row) * n_;
  }
  void keep(Row which, const double* pairs) { std::copy_n(pairs, n_, row(substeps() - 1, which)); }
  // After the pushes of a lane: they are its own, and so is what it nearly touches.
  void end_touches(const Model::Compiled& world, const ContactLists& lists, const PointView& view,
                   std::size_t lane);
  void end(const double* positions, const std::vector<Lane*>& lanes);

  std::size_t substeps() const { return first_touch.size(); }
  // Positions before those of the substep, and after it.
  const double* before(std::size_t substep) const {
    return substep > 0 ? row(substep - 1, position) : row(most_substeps_, position);
  }
  const double* after(std::size_t substep) const {
    return substep + 1 < substeps() ? row(substep + 1, position)
                                    : row(most_substeps_, position) + n_;
  }

  std::shared_ptr<Kind> kind;
  std::size_t width = 1;
  double onset = 0.0;  // raw length
  struct Member {
    std::size_t lane = 0;  // of the batch
    std::shared_ptr<const Model> model;
    std::vector<double> targets;
    bool is_done = true;  // neither folded nor unstable
  };
  std::vector<Member> members;
  std::vector<std::size_t> first_touch;  // of each substep
  std::vector<Touch> touches;

 private:
  std::size_t lane_touches_ = 0;  // first of the lane's
  std::size_t n_ = 0;             // values in a row
  std::size_t most_substeps_ = 0;
  std::size_t capacity_ = 0;
  hwy::AlignedFreeUniquePtr<double[]> values_;
};

struct Tape::Impl {
  void begin(std::size_t groups) {
    used = groups;
    if (records.size() < groups) records.resize(groups);
  }

  double onset = 0.0;    // voxels
  std::size_t used = 0;  // of `records`, one for each group of the last step
  std::vector<StepRecord> records;
};

// All of the record's lanes: see Tape::pull_back.
void pull_back(const StepRecord& record, std::span<Gradient> gradients);

}  // namespace evo
