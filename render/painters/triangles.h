// A drawing as triangles, for the painter of pixels.
#pragma once

#include <vector>

#include "render/painters/drawing.h"

namespace evo::render {

// A corner of a triangle, all of whose corners describe one rounded box by its
// half extents and corner radius; (u, v) is the corner in the box's own frame,
// the centre being (0, 0). The shader cuts the triangle at the border of the box
// and smooths it over one pixel. Lines and discs are such boxes with round ends;
// fills use position and colour only.
struct Vertex {
  float x, y;
  float u, v;
  float half_length, half_width, radius;
  Color color;
};

struct Triangles {
  // Painted alike, one after the other, up to the next batch.
  enum class Kind { fill, box };
  struct Batch {
    Kind kind = Kind::fill;
    Rect clip;
    std::size_t first_vertex = 0;
  };
  std::vector<Vertex> vertices;  // three a triangle
  std::vector<Batch> batches;
};

Triangles triangulate(const Drawing& drawing);

}  // namespace evo::render
