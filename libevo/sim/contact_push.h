// Pushing, the second of the two steps of contact.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libevo/sim/contact_order.h"

namespace evo {

// A corner of one cell at an edge of another one, by sites: what a gradient has to know of a
// contact (adjoint.h).
struct Touch {
  std::uint32_t lane = 0;
  std::int32_t point = 0;
  std::array<std::int32_t, 2> edge{};
  bool is_within = false;  // of one object, which pushes twice
  bool is_missed = false;  // the corner is still outside, but near
};

// What pushes are worked out in, one per thread, so that pushing does not allocate.
struct ContactPushes {
  // Forces of a contact: on a point, and, the other way, on the ends of the edge it crossed.
  struct Push {
    std::int32_t point = 0;
    std::array<std::int32_t, 2> edge{};
    Vec2 on_point;
    std::array<Vec2, 2> on_edge;
    Vec2 friction;  // on the point; half of it on either end
  };
  // Pushes of corners of the first of two cells, then of the second's: [first, middle) and
  // [middle, last) of `all`.
  struct OfCells {
    std::uint32_t first = 0;
    std::uint32_t middle = 0;
    std::uint32_t last = 0;
  };
  std::vector<Push> all;
  std::vector<OfCells> of_cells;
  std::vector<contact::Meeting> meetings;
  // x of the force on each point pushed since it was emptied, y being a stride further on.
  std::vector<double*> forces;
  std::vector<Touch>* touches = nullptr;  // all pushes are added to, if anybody wants them
};

// Adds the forces of the candidates that are inside (contact_look-inl.h finds them), of one
// environment.
void push_contacts(const Model::Compiled& world, std::span<const ContactCandidate* const> inside,
                   const PointView& points, ContactLists& lists, ContactPushes& memory);

}  // namespace evo
