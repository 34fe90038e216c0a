// Colours. Themes with the same roles and the same voxels, whose hues are those of
// the benchmark's viewer. Any two kinds of a robot's voxels differ in luminance by
// 1.5 to 1 at least (a test measures it), so that they can be told apart with any
// kind of colour vision and on a grey print.
#pragma once

#include <string>

#include "libevo/body/body.h"
#include "render/painters/image.h"

namespace evo::render {

struct Theme {
  std::string name;    // "light", "dark", "paper"
  bool signs = false;  // on actuators, which way they stretch; for prints without colour
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
  Color object_rigid, object_soft;  // voxels of packages and the like, never a robot's
  Color outline;                    // surfaces of bodies and objects
  Color seam;                       // between cells of one object
  Color seam_on_dark;               // between rigid cells
  Color fixed_outline;              // surfaces of terrain
  Color fixed_seam;
  Color trail;
  Color arrow;
};

// "light", "dark" or "paper"; Error(usage) otherwise.
const Theme& theme_by_name(const std::string& name);

Color color_of(const Theme& theme, Voxel voxel);         // of a robot
Color color_of_object(const Theme& theme, Voxel voxel);  // of everything else

// The colour of robot k in a race, the same in every theme, seen on each; they come again.
Color runner_color(std::size_t k);

// The colour of series k of a chart, the same in every theme: Okabe and Ito's, safe for
// colour-blind readers, with olive and grey for their yellow and black; they come again. The site
// has them, too.
Color chart_color(std::size_t k);

// Relative luminance (WCAG 2), 0 to 1.
double luminance(Color color);
// Black or white, whichever is read more easily on `background`.
Color ink_on(Color background);

// a + (b - a) * share, each channel; share in [0, 1].
Color mix(Color a, Color b, double share);
Color with_alpha(Color color, double alpha);  // alpha in [0, 1]

}  // namespace evo::render
