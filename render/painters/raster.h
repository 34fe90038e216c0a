// Pixels from a drawing by cairo, for programs that use the library. Slower than painter.h,
// but it needs no OpenGL: it may be called from any thread, and in a process forked from one
// that drew.
#pragma once

#include "render/painters/drawing.h"

namespace evo::render {

// Paints over all of `target`, which has the drawing's size.
void rasterise(const Drawing& drawing, PixelTarget target);

}  // namespace evo::render
