// Words in the world: who a robot is, and where earlier ones came to.
#pragma once

#include <vector>

#include "render/scene/projection.h"
#include "render/scene/scene.h"

namespace evo::render {

// Plates of the size of their words, above what they name and inside of the panel. One
// that would lie over an earlier one goes up, gradually as the two come near, so that
// nothing jumps in a film.
std::vector<Rect> tag_plates(const std::vector<Note>& tags, const Projection& to_pixels);
void draw_tags(const std::vector<Note>& tags, const Theme& theme, const Projection& to_pixels,
               Drawing& drawing);

// The scene's, along the lower border, or the left one where heights count, each with a
// mark where it is; of those whose words would lie over each other, the latest has its word.
void draw_pins(const Scene& scene, const Theme& theme, const Projection& to_pixels,
               Drawing& drawing);
// Height of the row that pins take from the lower border of a panel, pixels.
float pin_row(const Rect& panel);

}  // namespace evo::render
