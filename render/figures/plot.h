// Curves of an episode below its picture, in step with it.
#pragma once

#include "render/scene/clip.h"

namespace evo::render {

// Fills `area`: what was up to `step` is drawn strongly, what comes is pale. Throws
// Error(data) for commanded lengths of an episode without actions.
void draw_plot(const Clip& clip, Plot plot, double step, const Theme& theme, const Rect& area,
               Drawing& drawing);

// What a plot takes from the bottom of `whole`.
Rect plot_area(const Rect& whole);

}  // namespace evo::render
