// What there is to see, before any pixel: shapes in voxels, and how they are
// laid out in a panel of a drawing.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/painters/drawing.h"
#include "render/scene/mesh.h"
#include "render/scene/options.h"
#include "render/scene/theme.h"
#include "render/scene/value_scale.h"

namespace evo::render {

struct Arrow {
  Vec2 from;
  Vec2 to;
  bool force = false;  // else a velocity
};

// Where everything was at an earlier moment, drawn paler.
struct Ghost {
  std::vector<Vec2> points;
  std::vector<float> values;  // as of Scene
  double pale = 0.5;          // share of the background in every colour
  std::vector<bool> objects;  // those that it has
};

// A word in the world, on a plate of the trail's colour or its own.
struct Note {
  Vec2 at;
  std::string text;
  std::optional<Color> color = {};
};

// A place on the ground the robot is sent to.
struct Goal {
  Vec2 at;
  double away = 0;  // voxels from the robot's centre, to the right
};

// One moment. Lengths in voxels.
struct Scene {
  const Mesh* mesh = nullptr;
  std::vector<Vec2> points;
  std::vector<Ghost> ghosts;    // oldest first
  std::vector<bool> travels;    // of each object: drawn as a ghost, too; empty: none
  std::vector<Color> outlines;  // of each object that moves; empty: the theme's
  ViewRect view;
  bool backdrop = true;  // sky, grid, floor, what stands still; else what was drawn before
  bool grid = true;
  bool fine_grid = true;  // a line every voxel where there is room, not every ten
  bool floor = true;      // the world's floor at y = 0
  bool white = false;     // in the place of sky and earth
  bool edges = true;      // of objects
  bool voxels = true;
  float ruler_text = 0;       // size of the distances along the floor; 0: from the panel's
  bool heights = false;       // count: a ruler along the left border
  float captions = 0;         // pixels that captions will take at the top left
  bool tint = true;           // actuators by how long they are
  std::vector<float> values;  // of cells, for the colours of `value_scale`; NaN: none
  ValueScale value_scale;
  std::vector<Vec2> trail;                       // oldest first
  std::vector<Vec2> marks;                       // dots on the trail
  std::vector<std::vector<Vec2>> object_trails;  // of what is thrown, carried or caught
  std::vector<Arrow> arrows;
  double velocity_length = 0;  // of an arrow, voxels for one voxel per second; 0: none shown
  double force_length = 0;     // the same for the robot's weight
  std::vector<std::array<Vec2, 4>> framed;  // places with a border to catch the eye
  std::vector<Note> tags;                   // above what they name (notes.h)
  std::vector<Note> pins;                   // at the border: where something was, the latest last
  std::vector<Vec2> touches;                // where the robot touches something
  std::optional<Goal> goal;
  std::optional<double> finish;  // x of a chequered line across the whole height
};

// Fills `panel` with the scene, cut at its border. Line widths follow the size
// of a voxel in pixels, text follows the size of the panel.
void draw_scene(const Scene& scene, const Theme& theme, const Rect& panel, Drawing& drawing);

// `view` enlarged, not cut, to the panel's proportions.
ViewRect fit(ViewRect view, double aspect);

// The size of label text in a panel, pixels.
float label_size(const Rect& panel);

}  // namespace evo::render
