// What a batch is made of: lanes, and groups of lanes that the kernels step side by
// side. Private to libevo/sim.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "libevo/sim/batch.h"
#include "libevo/sim/compiled.h"
#include "libevo/sim/contact_lists.h"
#include "libevo/sim/workspace.h"

namespace evo {

// Models that move alike, with equal dynamics and physics: one plan and its tables
// serve them all, wherever their objects and terrain lie.
class Kind {
 public:
  explicit Kind(std::shared_ptr<const Model> model) : model_(std::move(model)) {}

  bool holds(const Model& other) const {
    return &other == model_.get() || (model_->compiled().dynamics == other.compiled().dynamics &&
                                      model_->physics() == other.physics());
  }
  const Plan& plan() const { return model_->compiled().plan; }
  const Physics& physics() const { return model_->physics(); }

  const Tables& tables(const Layout& layout);

 private:
  std::shared_ptr<const Model> model_;  // any one of them
  std::vector<std::unique_ptr<const Tables>> tables_;
};

// All of a simulation but its place in the rows of its group.
struct Lane {
  std::shared_ptr<const Model> model;
  std::shared_ptr<Kind> kind;
  std::vector<double> targets;  // [actuators] share of rest length
  ContactLists contacts;
  LaneStatus status = LaneStatus::done;
};

// Lanes of one kind, the i-th of them in lane i of the rows. Lanes of the rows beyond
// them hold nothing; kernels fill them with a copy.
struct Group {
  Group(std::shared_ptr<Kind> of_kind, const Layout& layout)
      : kind(std::move(of_kind)), tables(&kind->tables(layout)), rows(kind->plan(), layout.lanes) {}

  std::size_t width() const { return tables->layout.lanes; }

  std::shared_ptr<Kind> kind;
  const Tables* tables;
  Rows rows;
  std::vector<Lane*> lanes;
};

}  // namespace evo
