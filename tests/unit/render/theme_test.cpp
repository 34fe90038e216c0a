// Colours that can be told apart.
#include "render/scene/theme.h"

#include <array>
#include <catch2/catch.hpp>

namespace evo::render {
namespace {

// WCAG 2.
double contrast(Color a, Color b) {
  const double x = luminance(a);
  const double y = luminance(b);
  return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

constexpr std::array kinds{Voxel::rigid, Voxel::soft, Voxel::horizontal, Voxel::vertical};

TEST_CASE("luminance is that of the standard") {
  CHECK(luminance({255, 255, 255, 255}) == Approx(1));
  CHECK(luminance({0, 0, 0, 255}) == 0);
  CHECK(luminance({255, 0, 0, 255}) == Approx(0.2126));
  CHECK(contrast({119, 119, 119, 255}, {255, 255, 255, 255}) == Approx(4.48).epsilon(0.01));
}

TEST_CASE("kinds of voxels differ in lightness, and are the same in every theme") {
  const Theme& light = theme_by_name("light");
  for (const char* name : {"light", "dark", "paper"}) {
    const Theme& theme = theme_by_name(name);
    for (const Voxel a : kinds) {
      CHECK(color_of(theme, a) == color_of(light, a));
      for (const Voxel b : kinds)
        if (a != b) CHECK(contrast(color_of(theme, a), color_of(theme, b)) > 1.5);
    }
    // Rigid voxels do not vanish before the sky, nor on a card.
    CHECK(contrast(theme.rigid, theme.sky_top) > 2.4);
    CHECK(contrast(theme.rigid, theme.sky_bottom) > 2.4);
    CHECK(contrast(theme.rigid, theme.card) > 2.1);
  }
}

TEST_CASE("objects do not have the colours of robots") {
  const Theme& theme = theme_by_name("light");
  for (const Voxel a : {Voxel::rigid, Voxel::soft})
    for (const Voxel b : kinds) CHECK(color_of_object(theme, a) != color_of(theme, b));
  CHECK(color_of_object(theme, Voxel::fixed) == color_of(theme, Voxel::fixed));
}

TEST_CASE("robots of a race are seen in every theme, and differ") {
  for (std::size_t k = 0; k < 8; ++k) {
    for (const char* name : {"light", "dark", "paper"}) {
      CHECK(contrast(runner_color(k), theme_by_name(name).sky_top) > 2.9);
      CHECK(contrast(runner_color(k), theme_by_name(name).sky_bottom) > 2.9);
    }
    CHECK(contrast(runner_color(k), ink_on(runner_color(k))) > 3);
    for (std::size_t j = 0; j < k; ++j) CHECK(runner_color(j) != runner_color(k));
  }
  CHECK(runner_color(8) == runner_color(0));
}

TEST_CASE("signs are written in the ink that shows") {
  CHECK(ink_on({255, 255, 255, 255}).r < 128);
  CHECK(ink_on({20, 20, 20, 255}).r > 128);
}

}  // namespace
}  // namespace evo::render
