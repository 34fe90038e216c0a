// Captions over a picture.
#pragma once

#include "render/painters/text.h"
#include "render/scene/clip.h"

namespace evo::render {

// Text on rounded plates in the upper corners of a panel: who on the left, when
// and how well on the right. What finds no room is left out, the score last.
void draw_caption(const Caption& caption, const Theme& theme, const Rect& panel,
                  Typesetter& typesetter, Drawing& drawing);

// Size of the text of captions and keys in a panel, pixels.
float key_size(const Rect& panel);
inline constexpr float row_of_labels = 2.3F;  // from one row to the next, sizes of text
// What rows of captions take from the top of a panel, pixels.
float caption_height(const Rect& panel, int rows);

}  // namespace evo::render
