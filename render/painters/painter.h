// Pixels from a drawing: OpenGL 3.3 core in memory (OSMesa), no display, no GPU.
#pragma once

#include <memory>

#include "render/painters/drawing.h"
#include "render/painters/text.h"

namespace evo::render {

// One GL context, current in the thread that made it. Mesa's software
// rasteriser does not survive fork(): a process that owns a Painter must not
// start Workers (workers.h), which is why they own the Painters.
class Painter {
 public:
  Painter();  // throws Error(work) where an OSMesa gives no context
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  // Paints over all of `target`, which has the drawing's size. Pictures larger
  // than a tile are painted tile by tile, so that memory stays small.
  void paint(const Drawing& drawing, PixelTarget target);

  Typesetter& typesetter() { return typesetter_; }

 private:
  struct Gl;
  std::unique_ptr<Gl> gl_;
  Typesetter typesetter_;
};

}  // namespace evo::render
