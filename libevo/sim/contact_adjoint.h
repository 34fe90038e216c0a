// Contact's part of a gradient (adjoint.h): which corners nearly touch, and the derivatives of
// the forces of one touch. Scalar code, as the forces are (contact.h).
#pragma once

#include <vector>

#include "libevo/sim/contact.h"
#include "libevo/sim/contact_push.h"

namespace evo {

// Adds the corners of other objects that are outside a cell, but nearer than `reach` to one of
// its surface edges, raw length.
void find_missed(const Model::Compiled& world, const ContactLists& lists, const PointView& view,
                 double reach, std::vector<Touch>& touches);

// One lane's arrays of pairs, as in PointView; of what moves.
struct ContactAdjoint {
  const double* by_force = nullptr;  // derivatives by contact forces
  double* by_position = nullptr;     // are added to, as is
  double* by_previous = nullptr;
  double* by_constants = nullptr;  // rows of gradient_constants, a stride apart
};

void pull_back_touch(const Model::Compiled& world, const Touch& touch, const PointView& view,
                     double onset, const ContactAdjoint& adjoint);

}  // namespace evo
