#include "cli/report/film.h"

#include "render/render.h"

namespace evo::report {
namespace {

constexpr int moments = 6;
constexpr int width = 1140;  // pixels, as wide as the page
constexpr int deflate_level = 9;

std::string draw(const Rollout& rollout, const char* theme) {
  render::RenderOptions options;
  options.size.width = width;
  options.theme = theme;
  const render::Image image =
      render::paint(render::draw_moments({&rollout, 0, ""}, {moments}, options));
  return render::encode_png(render::view(image), deflate_level);
}

}  // namespace

Film draw_film(const Rollout& rollout) { return {draw(rollout, "light"), draw(rollout, "dark")}; }

}  // namespace evo::report
