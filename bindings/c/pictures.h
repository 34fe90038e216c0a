// Pictures of evo/evo.h, of whatever has a model and positions.
#pragma once

#include <span>

#include "evo/evo.h"
#include "libevo/sim/model.h"
#include "libevo/task/spec.h"

namespace evo::c {

// Draws `given`, or `now` where that is NULL. `task` says what is followed; it may be NULL. Throws
// Error(usage) for a view or a buffer that makes no sense.
void draw(const Model& model, std::span<const Vec2> now, const double* given, const TaskSpec* task,
          const evo_view* view, std::size_t size, std::uint8_t* pixels, std::size_t bytes);

}  // namespace evo::c
