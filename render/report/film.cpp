#include "render/report/film.h"

#include "render/render.h"

namespace evo::report {
namespace {

constexpr int moments = 6;
constexpr render::Size page{1140, 560};  // pixels, as wide as the page

std::string draw(const Rollout& rollout, const char* theme) {
  render::RenderOptions options;
  options.size = page;
  options.theme = theme;
  return render::encode_picture(render::draw_moments({&rollout, 0, ""}, {moments}, options),
                                rollout.task, "film.svg");
}

}  // namespace

Film draw_film(const Rollout& rollout) { return {draw(rollout, "light"), draw(rollout, "dark")}; }

}  // namespace evo::report
