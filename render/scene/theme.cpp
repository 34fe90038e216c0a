#include "render/scene/theme.h"

#include <array>
#include <cmath>

#include "libevo/base/error.h"

namespace evo::render {
namespace {

constexpr Color rgb(unsigned hex, unsigned alpha = 255) {
  return {static_cast<std::uint8_t>(hex >> 16 & 255U), static_cast<std::uint8_t>(hex >> 8 & 255U),
          static_cast<std::uint8_t>(hex & 255U), static_cast<std::uint8_t>(alpha)};
}

// The same in every theme, so that a robot looks alike wherever it is seen.
void voxels(Theme& t) {
  t.rigid = rgb(0x5c6573);
  t.soft = rgb(0xdde1e6);
  t.horizontal = rgb(0xfa9a45);
  t.vertical = rgb(0x3f8ccb);
  t.object_rigid = rgb(0x2f7c6c);
  t.object_soft = rgb(0x83c4b0);
}

Theme light() {
  Theme t;
  t.name = "light";
  t.sky_top = rgb(0xe3edf6);
  t.sky_bottom = rgb(0xfbfcfd);
  t.earth_top = rgb(0xd8d2c7);
  t.earth_bottom = rgb(0xc8c0b2);
  t.floor_line = rgb(0x8d8473);
  t.grid_minor = rgb(0x40608a, 20);
  t.grid_major = rgb(0x40608a, 52);
  t.paper = rgb(0xffffff);
  t.card = rgb(0xf3f5f8);
  t.text = rgb(0x1d2733);
  t.text_muted = rgb(0x5d6a79);
  t.text_on_earth = rgb(0x6a6253);
  t.label = rgb(0xffffff, 216);
  voxels(t);
  t.fixed = rgb(0x8b929c);
  t.outline = rgb(0x14181d);
  t.seam = rgb(0x14181d, 96);
  t.seam_on_dark = rgb(0xffffff, 56);
  t.fixed_outline = rgb(0x3a424d);
  t.fixed_seam = rgb(0x3a424d, 80);
  t.trail = rgb(0xc2255c);
  t.arrow = rgb(0x2f7d4f);
  return t;
}

Theme dark() {
  Theme t;
  t.name = "dark";
  t.sky_top = rgb(0x11161d);
  t.sky_bottom = rgb(0x202a36);
  t.earth_top = rgb(0x2f2b27);
  t.earth_bottom = rgb(0x221f1c);
  t.floor_line = rgb(0x7c7264);
  t.grid_minor = rgb(0xa9c4e6, 15);
  t.grid_major = rgb(0xa9c4e6, 44);
  t.paper = rgb(0x12161c);
  t.card = rgb(0x2b3541);
  t.text = rgb(0xeef2f6);
  t.text_muted = rgb(0x9aa7b5);
  t.text_on_earth = rgb(0xa79c8b);
  t.label = rgb(0x0c1015, 200);
  voxels(t);
  t.fixed = rgb(0x39414b);
  t.outline = rgb(0xe6ebf0);
  t.seam = rgb(0xe6ebf0, 84);
  t.seam_on_dark = t.seam;
  t.fixed_outline = rgb(0x93a0af);
  t.fixed_seam = rgb(0x93a0af, 60);
  t.trail = rgb(0xff7aa8);
  t.arrow = rgb(0x74d69b);
  return t;
}

Theme paper() {
  Theme t = light();
  t.name = "paper";
  t.signs = true;
  t.sky_top = t.sky_bottom = rgb(0xffffff);
  t.earth_top = t.earth_bottom = rgb(0xefefef);
  t.floor_line = rgb(0x777777);
  t.grid_minor = rgb(0x000000, 12);
  t.grid_major = rgb(0x000000, 34);
  t.card = rgb(0xffffff);
  t.text = rgb(0x111111);
  t.text_muted = rgb(0x555555);
  t.text_on_earth = rgb(0x444444);
  t.label = rgb(0xffffff, 230);
  t.fixed = rgb(0xbdbdbd);
  t.fixed_outline = rgb(0x555555);
  t.fixed_seam = rgb(0x555555, 60);
  return t;
}

std::uint8_t channel(double value) {
  return static_cast<std::uint8_t>(std::lround(std::min(255.0, std::max(0.0, value))));
}

}  // namespace

const Theme& theme_by_name(const std::string& name) {
  static const Theme themes[] = {light(), dark(), paper()};
  for (const Theme& theme : themes)
    if (theme.name == name) return theme;
  throw error(Failure::usage, "unknown theme '{}': allowed are light, dark and paper{}", name,
              did_you_mean(name, {"light", "dark", "paper"}));
}

Color color_of(const Theme& theme, Voxel voxel) {
  switch (voxel) {
    case Voxel::rigid:
      return theme.rigid;
    case Voxel::soft:
      return theme.soft;
    case Voxel::horizontal:
      return theme.horizontal;
    case Voxel::vertical:
      return theme.vertical;
    case Voxel::fixed:
      return theme.fixed;
    case Voxel::empty:
      break;
  }
  return {0, 0, 0, 0};
}

Color color_of_object(const Theme& theme, Voxel voxel) {
  if (voxel == Voxel::rigid) return theme.object_rigid;
  if (voxel == Voxel::soft) return theme.object_soft;
  return color_of(theme, voxel);
}

Color runner_color(std::size_t k) {
  static constexpr std::array colors{rgb(0xd6336c), rgb(0x1c7ed6), rgb(0x2b9a3e), rgb(0x845ef7),
                                     rgb(0xd9480f), rgb(0x0c8599), rgb(0xa87900), rgb(0x7b8794)};
  return colors[k % colors.size()];
}

double luminance(Color color) {
  const auto linear = [](std::uint8_t value) {
    const double share = value / 255.0;
    return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(color.r) + 0.7152 * linear(color.g) + 0.0722 * linear(color.b);
}

Color ink_on(Color background) {
  constexpr double even = 0.18;  // where black and white contrast alike
  return luminance(background) > even + 0.1 ? Color{17, 17, 17, 255} : Color{255, 255, 255, 255};
}

Color mix(Color a, Color b, double share) {
  const auto blend = [share](std::uint8_t x, std::uint8_t y) {
    return channel(x + (static_cast<double>(y) - x) * share);
  };
  return {blend(a.r, b.r), blend(a.g, b.g), blend(a.b, b.b), blend(a.a, b.a)};
}

Color with_alpha(Color color, double alpha) {
  color.a = channel(alpha * 255.0);
  return color;
}

}  // namespace evo::render
