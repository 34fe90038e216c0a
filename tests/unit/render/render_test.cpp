#include "render/render.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "formats/io/files.h"
#include "tests/unit/expect.h"
#include "tests/unit/render/example.h"
#include "tests/unit/render/read_png.h"

namespace evo::render {
namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using test::expect_error;

RenderOptions tiny() {
  RenderOptions options;
  options.size = {96, 54};
  return options;
}

TEST_CASE("the number of workers changes no byte") {
  const test::ScratchFolder folder;
  const Rollout rollout = example::simulate("Walker-v0", example::walker, 9);
  const std::string name = GENERATE("a.gif", "a.mp4");
  std::string first;
  for (const int workers : {1, 3}) {
    RenderOptions options = tiny();
    options.workers = workers;
    CHECK(render_video({{&rollout, 0, ""}}, options, folder / name) == 10);
    const std::string bytes = read_file(folder / name);
    if (first.empty()) first = bytes;
    CHECK(bytes == first);
  }
}

TEST_CASE("a sequence has a file per frame, equal to the picture of that moment") {
  const test::ScratchFolder folder;
  const Rollout rollout = example::simulate("Walker-v0", example::walker, 6);
  RenderOptions options = tiny();
  options.speed = 2;
  options.workers = 2;
  options.overlays.labels = false;  // stills have a legend, too
  CHECK(render_video({{&rollout, 0, ""}}, options, folder / "frames/%05d.png") == 4);
  CHECK(read_png(folder / "frames/00002.png").rgba ==
        paint(draw_moment({&rollout, 0, ""}, 4, options)).rgba);
  CHECK(fs::exists(folder / "frames/00003.png"));
  CHECK_FALSE(fs::exists(folder / "frames/00004.png"));
}

TEST_CASE("names of sequences are padded as asked for") {
  const test::ScratchFolder folder;
  const Rollout rollout = example::simulate("Walker-v0", example::walker, 1);
  render_video({{&rollout, 0, ""}}, tiny(), folder / "a-%d.png");
  CHECK(fs::exists(folder / "a-1.png"));
  render_video({{&rollout, 0, ""}}, tiny(), folder / "b-%03d-c.png");
  CHECK(fs::exists(folder / "b-001-c.png"));
  for (const std::string name : {"%5d.png", "%05x.png", "%0999d.png", "%d-%d.png", "%.png"})
    expect_error(Failure::usage, Contains("frames/%05d.png"), [&] {
      render_video({{&rollout, 0, ""}}, tiny(), folder / name);
    });
}

TEST_CASE("several episodes share a picture, the shorter one waits at its end") {
  const Rollout one = example::simulate("Walker-v0", example::walker, 4);
  const Rollout two = example::simulate("Carrier-v0", example::small_box, 8);
  const test::ScratchFolder folder;
  CHECK(render_video({{&one, 0, "one"}, {&two, 0, "two"}, {&one, 0, "three"}}, tiny(),
                     folder / "a.gif") == 9);
}

TEST_CASE("large pictures are painted in tiles without a seam") {
  // The same scene twice, once beyond the tile's side: rows and columns around
  // the joint must not stand out.
  const Robot robot(Body::from_rows(example::walker));
  RenderOptions options;
  options.size = {4096, 2304};
  const Image large = paint(draw_robot(robot, options));
  options.size = {1024, 576};
  const Image small = paint(draw_robot(robot, options));
  double worst = 0;
  for (int y = 0; y < 576; ++y)
    for (int x = 508; x < 516; ++x) {
      const auto a = 4 * static_cast<std::size_t>(y * 1024 + x);
      const auto b = 4 * static_cast<std::size_t>((4 * y + 2) * 4096 + 4 * x + 2);
      worst += std::abs(small.rgba[a] - large.rgba[b]);
    }
  CHECK(worst / (576 * 8) < 3);
}

TEST_CASE("options out of range are named with what they may be") {
  const Rollout rollout = example::simulate("Walker-v0", example::walker, 2);
  const auto fails = [&](auto change, const std::string& words) {
    RenderOptions options = tiny();
    change(options);
    expect_error(Failure::usage, Contains(words), [&] {
      render_video({{&rollout, 0, ""}}, options, "never.gif");
    });
    CHECK_FALSE(fs::exists("never.gif"));
  };
  fails([](RenderOptions& o) { o.size = {0, 100}; }, "0x100");
  fails([](RenderOptions& o) { o.size = {100, 8193}; }, "8192");
  fails([](RenderOptions& o) { o.fps = 0; }, "240");
  fails([](RenderOptions& o) { o.speed = -1; }, "speed of -1");
  fails([](RenderOptions& o) { o.theme = "lihgt"; }, "did you mean 'light'");
  fails([](RenderOptions& o) { o.from = 5; }, "steps 0 to 2");
  fails([](RenderOptions& o) { o.camera.zoom = 0; }, "zoom");
  fails([](RenderOptions& o) { o.workers = 0; }, "1 or more");
}

TEST_CASE("outputs that make no sense are refused") {
  const Rollout rollout = example::simulate("Walker-v0", example::walker, 2);
  const auto to = [&](const std::string& output, Size size) {
    RenderOptions options = tiny();
    options.size = size;
    render_video({{&rollout, 0, ""}}, options, output);
  };
  expect_error(Failure::usage, Contains(".avi") && Contains(".mp4"), [&] {
    to("a.avi", {96, 54});
  });
  expect_error(Failure::usage, Contains("%05d"), [&] { to("a%s.png", {96, 54}); });
  expect_error(Failure::usage, Contains("96x56"), [&] { to("a.mp4", {96, 55}); });
  expect_error(Failure::cannot_create, Contains("nowhere"), [&] { to("nowhere/a.gif", {96, 54}); });
  expect_error(Failure::data, Contains("no episode"), [&] { render_video({}, tiny(), "a.gif"); });
  expect_error(Failure::data, Contains("no robot"), [&] { draw_robots({}, tiny()); });
  expect_error(Failure::usage, Contains("101"), [&] {
    draw_moments({&rollout, 0, ""}, {101}, tiny());
  });
  expect_error(Failure::usage, Contains("steps 0 to 2"), [&] {
    draw_moment({&rollout, 0, ""}, 3, tiny());
  });
}

}  // namespace
}  // namespace evo::render
