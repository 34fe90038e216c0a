#include "render/scene/theme.h"

#include <array>
#include <cmath>

#include "libevo/base/error.h"

namespace evo::render {
namespace {

constexpr Color rgba(std::uint32_t hex) {
  const auto part = [hex](int shift) { return static_cast<std::uint8_t>(hex >> shift & 255U); };
  return {part(24), part(16), part(8), part(0)};
}

constexpr std::array names{"light", "dark", "paper"};

// What a role looks like in each theme. Voxels are the same in all, so that a robot looks alike
// wherever it is seen.
struct Role {
  Color Theme::*color;
  std::array<std::uint32_t, names.size()> looks;
};
constexpr std::array roles{
    Role{&Theme::sky_top, {0xe3edf6ff, 0x11161dff, 0xffffffff}},
    Role{&Theme::sky_bottom, {0xfbfcfdff, 0x202a36ff, 0xffffffff}},
    Role{&Theme::earth_top, {0xd8d2c7ff, 0x2f2b27ff, 0xefefefff}},
    Role{&Theme::earth_bottom, {0xc8c0b2ff, 0x221f1cff, 0xefefefff}},
    Role{&Theme::floor_line, {0x8d8473ff, 0x7c7264ff, 0x777777ff}},
    Role{&Theme::grid_minor, {0x40608a14, 0xa9c4e60f, 0x0000000c}},
    Role{&Theme::grid_major, {0x40608a34, 0xa9c4e62c, 0x00000022}},
    Role{&Theme::paper, {0xffffffff, 0x12161cff, 0xffffffff}},
    Role{&Theme::card, {0xf3f5f8ff, 0x2b3541ff, 0xffffffff}},
    Role{&Theme::text, {0x1d2733ff, 0xeef2f6ff, 0x111111ff}},
    Role{&Theme::text_muted, {0x5d6a79ff, 0x9aa7b5ff, 0x555555ff}},
    Role{&Theme::text_on_earth, {0x6a6253ff, 0xa79c8bff, 0x444444ff}},
    Role{&Theme::label, {0xffffffd8, 0x0c1015c8, 0xffffffe6}},
    Role{&Theme::rigid, {0x5c6573ff, 0x5c6573ff, 0x5c6573ff}},
    Role{&Theme::soft, {0xdde1e6ff, 0xdde1e6ff, 0xdde1e6ff}},
    Role{&Theme::horizontal, {0xfa9a45ff, 0xfa9a45ff, 0xfa9a45ff}},
    Role{&Theme::vertical, {0x3f8ccbff, 0x3f8ccbff, 0x3f8ccbff}},
    Role{&Theme::object_rigid, {0x2f7c6cff, 0x2f7c6cff, 0x2f7c6cff}},
    Role{&Theme::object_soft, {0x83c4b0ff, 0x83c4b0ff, 0x83c4b0ff}},
    Role{&Theme::fixed, {0x8b929cff, 0x39414bff, 0xbdbdbdff}},
    Role{&Theme::outline, {0x14181dff, 0xe6ebf0ff, 0x14181dff}},
    Role{&Theme::seam, {0x14181d60, 0xe6ebf054, 0x14181d60}},
    Role{&Theme::seam_on_dark, {0xffffff38, 0xe6ebf054, 0xffffff38}},
    Role{&Theme::fixed_outline, {0x3a424dff, 0x93a0afff, 0x555555ff}},
    Role{&Theme::fixed_seam, {0x3a424d50, 0x93a0af3c, 0x5555553c}},
    Role{&Theme::trail, {0xc2255cff, 0xff7aa8ff, 0xc2255cff}},
    Role{&Theme::arrow, {0x2f7d4fff, 0x74d69bff, 0x2f7d4fff}},
};

Theme theme(std::size_t k) {
  Theme made;
  made.name = names[k];
  made.signs = made.name == "paper";
  for (const Role& role : roles) made.*role.color = rgba(role.looks[k]);
  return made;
}

std::uint8_t channel(double value) {
  return static_cast<std::uint8_t>(std::lround(std::min(255.0, std::max(0.0, value))));
}

}  // namespace

const Theme& theme_by_name(const std::string& name) {
  static const std::array themes{theme(0), theme(1), theme(2)};
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
  static constexpr std::array colors{rgba(0xd6336cff), rgba(0x1c7ed6ff), rgba(0x2b9a3eff),
                                     rgba(0x845ef7ff), rgba(0xd9480fff), rgba(0x0c8599ff),
                                     rgba(0xa87900ff), rgba(0x7b8794ff)};
  return colors[k % colors.size()];
}

Color chart_color(std::size_t k) {
  static constexpr std::array colors{rgba(0xd55e00ff), rgba(0x0072b2ff), rgba(0x009e73ff),
                                     rgba(0xcc79a7ff), rgba(0xe69f00ff), rgba(0x56b4e9ff),
                                     rgba(0x8a7a17ff), rgba(0x7f8894ff)};
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
  constexpr double even = 0.179;  // where black and white contrast alike, 4.6 to 1
  return luminance(background) > even ? Color{0, 0, 0, 255} : Color{255, 255, 255, 255};
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
