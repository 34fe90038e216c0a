// What arrows and colours over a scene measure.
#pragma once

#include "render/painters/text.h"
#include "render/scene/scene.h"

namespace evo::render {

// Plates at the right of the panel, below `captions` rows of labels: how long an arrow of
// some velocity or force is, and the bar of the colours of cells. Nothing for a scene
// without them.
void draw_key(const Scene& scene, const Theme& theme, const Rect& panel, int captions,
              Typesetter& typesetter, Drawing& drawing);

// The bar of colours alone, in one line of text around `centre`.
void draw_value_line(const ValueScale& scale, const Theme& theme, Point centre, float size,
                     Typesetter& typesetter, Drawing& drawing);

}  // namespace evo::render
