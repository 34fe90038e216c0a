// Pictures and videos: the whole of this room from outside but for still.h. Drawing happens in
// processes of its own (workers.h), so that these functions may be called from
// any program, with any number of threads.
#pragma once

#include <string>
#include <vector>

#include "formats/robot/robot.h"
#include "render/figures/poster.h"
#include "render/figures/sheet.h"
#include "render/film/evolution_film.h"
#include "render/film/movie.h"
#include "render/painters/image.h"
#include "render/painters/png.h"
#include "render/scene/clip.h"
#include "render/scene/moments.h"
#include "render/scene/options.h"

namespace evo::render {

// ---- still pictures ---------------------------------------------------------------
// Errors: usage for options out of range, data for what cannot be drawn. Strips,
// sheets and grids have options.size.width and the height they need.

// One moment; `step` may lie between two steps.
Drawing draw_moment(const Episode& episode, double step, const RenderOptions& options);
// The same of several episodes side by side; one that is over stands at its end.
Drawing draw_moment(const std::vector<Episode>& episodes, double step,
                    const RenderOptions& options);
// `moments` moments of one episode from `from` to `to`.
enum class Layout {
  strip,   // on one axis of the world; side by side where they would lie on each other
  panels,  // side by side
};
struct Moments {
  int count = 6;
  Layout layout = Layout::strip;
  Choice choice = Choice::event;
};
Drawing draw_moments(const Episode& episode, const Moments& moments, const RenderOptions& options);
// A cycle of its gait, for ever, as the text of an SVG (film/loop.h).
std::string draw_gait(const Episode& episode, const RenderOptions& options);
Drawing draw_robot(const Robot& robot, const RenderOptions& options);
Drawing draw_robots(const std::vector<Robot>& robots, const RenderOptions& options);

// A run on one page, `best` being an episode of its best robot; options.size does not matter.
Drawing draw_poster(const PosterContent& content, const Episode& best,
                    const RenderOptions& options);

// Pixels of a drawing, painted by a process of its own.
Image paint(const Drawing& drawing);
// A file's bytes by the ending of its name: .png, .svg or .pdf; Error(usage) for
// another. `title` is what vector formats say the picture shows.
std::string encode_picture(const Drawing& drawing, const std::string& title,
                           const std::string& name);

// ---- moving pictures ----------------------------------------------------------------

// Episodes as a video, side by side when they are several (a shorter one stays at
// its end). The form follows from `output` (movie.h). Files appear whole or not at
// all. Returns the number of frames. Throws Error(usage) for another ending or odd sizes of
// videos.
std::size_t render_video(const std::vector<Episode>& episodes, const RenderOptions& options,
                         const std::string& output, const Progress& progress = {});
// The same episodes in one world, with a ranking (race.h).
std::size_t render_race(const std::vector<Episode>& episodes, const RenderOptions& options,
                        const std::string& output, const Progress& progress = {});
// The best robots of an evolution, one after the other (evolution_film.h).
std::size_t render_evolution(const std::vector<Champion>& champions, const RenderOptions& options,
                             const std::string& output, const Progress& progress = {});

}  // namespace evo::render
