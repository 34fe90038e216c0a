// Colours. Two themes with the same roles; the voxel colours stay near those of
// the benchmark's viewer and differ in lightness as well as in hue, orange
// against blue, so that they can be told apart with any kind of colour vision.
#pragma once

#include <string>

#include "libevo/body/body.h"
#include "render/image.h"

namespace evo::render {

struct Theme {
  std::string name;  // "light", "dark"
  Color sky_top;
  Color sky_bottom;
  Color earth_top;  // below the world floor
  Color earth_bottom;
  Color floor_line;
  Color grid_minor;  // every voxel
  Color grid_major;  // every 10 voxels
  Color paper;       // behind sheets
  Color card;        // behind one robot of a sheet
  Color text;
  Color text_muted;
  Color text_on_earth;
  Color label;  // behind text over a scene, translucent
  Color rigid, soft, horizontal, vertical, fixed;
  Color outline;        // surfaces of bodies and objects
  Color seam;           // between cells of one object
  Color seam_on_dark;   // between rigid cells
  Color fixed_outline;  // surfaces of terrain
  Color fixed_seam;
  Color trail;
  Color arrow;
};

// "light" or "dark"; Error(usage) otherwise.
const Theme& theme_by_name(const std::string& name);

Color color_of(const Theme& theme, Voxel voxel);

// a + (b - a) * share, each channel; share in [0, 1].
Color mix(Color a, Color b, double share);
Color with_alpha(Color color, double alpha);  // alpha in [0, 1]

}  // namespace evo::render
