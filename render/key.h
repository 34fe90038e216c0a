// What arrows and colours over a scene measure.
#pragma once

#include "render/scene.h"
#include "render/text.h"

namespace evo::render {

// Plates at the right of the panel, below `captions` rows of labels: how long an arrow of
// some velocity or force is, and the bar of the colours of cells. Nothing for a scene
// without them.
void draw_key(const Scene& scene, const Theme& theme, const Rect& panel, int captions,
              Typesetter& typesetter, Drawing& drawing);

}  // namespace evo::render
