// Vector formats, as text.
#include "render/painters/vector.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>

#include "formats/io/files.h"
#include "formats/run/run.h"
#include "render/film/race.h"
#include "render/painters/raster.h"
#include "render/render.h"
#include "tests/unit/expect.h"
#include "tests/unit/render/example.h"

namespace evo::render {
namespace {

using Catch::Matchers::Contains;
using test::expect_error;

std::string svg(const Drawing& drawing) {
  Typesetter typesetter;
  return encode_svg(drawing, "a <title>", typesetter);
}

TEST_CASE("shapes become elements, alike ones in a row one path") {
  Drawing drawing({40, 20});
  drawing.quad({Point{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {255, 0, 0, 255});
  drawing.quad({Point{4, 0}, {4, 4}, {8, 4}, {8, 0}}, {255, 0, 0, 255});  // turns the other way
  drawing.line({1, 2}, {3, 2}, 0.5F, {0, 0, 255, 128});
  drawing.disc({30, 10}, 2.5F, {0, 0, 0, 255});
  drawing.clip({0, 0, 20, 20});
  drawing.rounded_rectangle({1, 1, 8, 4}, 2, {1, 2, 3, 255});
  drawing.text({20, 10}, 8, "5 < 6", {0, 0, 0, 255}, Align::centre, true);
  const std::string text = svg(drawing);
  CHECK_THAT(text, Contains("<title>a &lt;title&gt;</title>"));
  CHECK_THAT(text, Contains("<path fill=\"#ff0000\" d=\"M0 0L4 0L4 4L0 4zM8 0L8 4L4 4L4 0z\"/>"));
  CHECK_THAT(text, Contains("stroke=\"#0000ff\" stroke-opacity=\".5\" stroke-width=\".5\" "
                            "stroke-linecap=\"round\" d=\"M1 2L3 2\""));
  CHECK_THAT(text, Contains("stroke-linecap=\"round\" d=\"M30 10h0\""));
  CHECK_THAT(text, Contains("<clipPath id=\"c1\"><rect x=\"0\" y=\"0\" width=\"20\""));
  CHECK_THAT(text, Contains("<g clip-path=\"url(#c1)\">\n<rect x=\"1\""));
  CHECK_THAT(text, Contains("text-anchor=\"middle\" font-weight=\"bold\""));
  CHECK_THAT(text, Contains(">5 &lt; 6</text>"));
}

TEST_CASE("control characters and bytes that are no UTF-8 leave an SVG well-formed") {
  Drawing drawing({40, 20});
  drawing.text({20, 10}, 8, "a\x1b[31m\x01\xff\n\"b'", {0, 0, 0, 255});
  CHECK_THAT(svg(drawing), Contains(">a\\x1b[31m\\x01\\xff\n&quot;b&#39;</text>"));
}

TEST_CASE("a gradient is defined once") {
  Drawing drawing({40, 20});
  for (const float x : {0.0F, 20.0F})
    drawing.gradient({x, 0, 20, 20}, {255, 255, 255, 255}, {0, 0, 0, 255});
  const std::string text = svg(drawing);
  CHECK_THAT(text, Contains("<path fill=\"url(#g1)\" d=\"M0 0h20v20h-20zM20 0h20v20h-20z\"/>"));
  CHECK(text.find("<linearGradient") == text.rfind("<linearGradient"));
}

TEST_CASE("cairo paints what OpenGL does, but for the borders") {
  const Rollout rollout = example::simulate("Walker-v0", example::walker, 30);
  RenderOptions options;
  options.size = {320, 180};
  const Drawing drawing = draw_moment({&rollout, 0, ""}, 25, options);
  const Image by_gl = paint(drawing);
  Image by_cairo(drawing.size());
  rasterise(drawing, target(by_cairo));
  std::size_t far = 0;
  for (std::size_t i = 0; i < by_gl.rgba.size(); ++i)
    far += std::abs(by_gl.rgba[i] - by_cairo.rgba[i]) > 40 ? 1 : 0;
  CAPTURE(far);
  CHECK(far < by_gl.rgba.size() / 100);
}

// Pictures as text; UPDATE_GOLDEN=1 writes them anew, then look at them.
void compare(const std::string& name, const Drawing& drawing) {
  const std::string text = svg(drawing);
  const std::string golden = "tests/data/render/" + name + ".svg";
  if (std::getenv("UPDATE_GOLDEN") != nullptr) write_file(golden, text);
  if (text != read_file(golden)) write_file("differs-" + name + ".svg", text);
  CHECK(text == read_file(golden));
}

TEST_CASE("golden: a strip as a vector picture") {
  const Rollout rollout = example::simulate("Carrier-v0", example::walker, 60);
  RenderOptions options;
  options.size = {480, 270};
  options.theme = "paper";
  const Rollout far = example::carried(rollout, {0.03, 0});
  compare("strip-paper", draw_moments({&far, 0, ""}, {3}, options));
}

TEST_CASE("golden: a moment of a race, the end of a film, a sheet with colours") {
  const Rollout slow = example::simulate("Climber-v0", example::small_box, 60);
  const Rollout quick = example::simulate("Climber-v0", example::walker, 60);
  RenderOptions options;
  options.size = {480, 270};
  Typesetter typesetter;
  const Race race({{&slow, 0, "box"}, {&quick, 0, "walker"}, {&slow, 0, "box again"}}, options);
  compare("race", race.frame(40, typesetter));
  options.theme = "dark";
  const EvolutionFilm film(
      {{{&slow, 0, ""}, 0, 0, 0.5}, {{&quick, 0, ""}, 1, 2, 0.7}, {{&slow, 0, ""}, 3, 3, 0.9}},
      options);
  compare("film", film.frame(film.frames() - 1, typesetter));
  options.theme = "light";
  options.overlays.tint = Tint::strain;
  compare("sheet-strain", draw_moments({&quick, 0, ""}, {3, Layout::panels}, options));
}

TEST_CASE("a PDF is one page of the drawing's size, the same every time") {
  const Rollout rollout = example::simulate("Walker-v0", example::walker, 20);
  RenderOptions options;
  options.size = {480, 270};
  const Drawing drawing = draw_moment({&rollout, 0, ""}, 20, options);
  Typesetter typesetter;
  const std::string bytes = encode_pdf(drawing, "Walker-v0", typesetter);
  CHECK(bytes.substr(0, 5) == "%PDF-");
  CHECK_THAT(bytes, Contains("/MediaBox [ 0 0 360 202.5 ]"));
  CHECK_THAT(bytes, Contains("DejaVu"));  // its letters are in the file
  CHECK(encode_pdf(drawing, "Walker-v0", typesetter) == bytes);
}

TEST_CASE("the curve of a poster begins with the first robot that has not failed") {
  struct Scored {
    std::optional<double> fitness;
  };
  const auto best = best_so_far(std::vector<Scored>{{}, {1.5}, {}, {1.0}, {2.5}});
  CHECK(std::isnan(best[0]));
  CHECK(std::vector(best.begin() + 1, best.end()) == std::vector{1.5, 1.5, 1.5, 2.5});
  const Robot robot(Body::from_rows({"HV"}));
  Typesetter typesetter;
  const std::string page = svg(poster({"Walker-v0", "", {{robot, 0}}, best}, Drawing({8, 8}),
                                      theme_by_name("light"), typesetter));
  CHECK(page.find("nan") == std::string::npos);
}

TEST_CASE("the ending of a name says which format") {
  const Drawing drawing({8, 8});
  CHECK(encode_picture(drawing, "", "a.png").substr(1, 3) == "PNG");
  CHECK(encode_picture(drawing, "", "a.svg").substr(0, 4) == "<svg");
  CHECK(encode_picture(drawing, "", "a.pdf").substr(0, 4) == "%PDF");
  expect_error(Failure::usage, Contains(".svg or .pdf"),
               [&] { encode_picture(drawing, "", "a.eps"); });
}

}  // namespace
}  // namespace evo::render
