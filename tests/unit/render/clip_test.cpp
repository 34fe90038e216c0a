#include "render/scene/clip.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/base/error.h"
#include "tests/unit/expect.h"
#include "tests/unit/render/example.h"

namespace evo::render {
namespace {

using Catch::Matchers::Contains;
using test::expect_error;

TEST_CASE("50 frames per second show every step, other rates and speeds their share") {
  RenderOptions options;
  CHECK(timeline(options, 4, 50) == std::vector<double>{0, 1, 2, 3, 4});
  options.fps = 25;
  CHECK(timeline(options, 5, 50) == std::vector<double>{0, 2, 4, 5});  // the end is always shown
  options.speed = 0.25;
  CHECK(timeline(options, 1, 50) == std::vector<double>{0, 0.5, 1});
  options.speed = 1.5;
  CHECK(timeline(options, 6, 50) == std::vector<double>{0, 3, 6});
  options.from = 2;
  options.to = 4;
  CHECK(timeline(options, 6, 50) == std::vector<double>{2, 4});
  options.to = 100;
  CHECK(timeline(options, 6, 50).back() == 6);
  CHECK(timeline(RenderOptions{}, 0, 50) == std::vector<double>{0});
  options.from = 7;
  expect_error(Failure::usage, Contains("7"), [&] { timeline(options, 6, 50); });
}

TEST_CASE("shapes lie between those of two steps") {
  const Rollout rollout = example::simulate("Walker-v0", example::walker, 10);
  const Clip clip({&rollout, 0, ""}, {}, 1.5);
  CHECK(clip.steps() == 10);
  const auto a = clip.scene(4).points;
  const auto b = clip.scene(5).points;
  const auto middle = clip.scene(4.5).points;
  for (std::size_t k = 0; k < a.size(); ++k) {
    CHECK(middle[k].x == Approx((a[k].x + b[k].x) / 2).margin(1e-12));
    CHECK(middle[k].y == Approx((a[k].y + b[k].y) / 2).margin(1e-12));
  }
  CHECK(clip.scene(99).points[0].x == clip.scene(10).points[0].x);
  // In voxels: the robot stands at cell 1,1.
  CHECK(clip.scene(0).points[0].x == Approx(1));
}

TEST_CASE("captions tell task, robot, step, time and return so far") {
  Rollout rollout = example::simulate("Walker-v0", example::walker, 10);
  rollout.episodes[0].rewards.assign(10, -0.5);
  const Clip clip({&rollout, 0, ""}, {}, 1.5);
  const Caption caption = clip.caption(7.5);
  CHECK(caption.title == "Walker-v0");
  CHECK(caption.detail == rollout.robot->id);
  CHECK(caption.moment == "step \u20077 / 10   0.14 s");
  CHECK(caption.score == "return \u22123.500");
  CHECK(clip.score(10) == -5);
  CHECK(caption.brief == "Walker-v0");
  CHECK(Clip({&rollout, 0, "seed 3"}, {}, 1.5).caption(0).detail == "seed 3");
  CHECK(Clip({&rollout, 0, "seed 3"}, {}, 1.5).caption(0).brief == "seed 3");
}

TEST_CASE("overlays are made on demand") {
  const Rollout rollout = example::simulate("Carrier-v0", example::walker, 12);
  RenderOptions options;
  options.overlays.trail = options.overlays.velocities = true;
  const Clip clip({&rollout, 0, ""}, options, 1.5);
  const Scene scene = clip.scene(12);
  CHECK(scene.trail.size() >= 12);
  std::size_t moving = 0;
  for (const ModelObject& object : rollout.world.objects)
    if (!object.is_static) moving += static_cast<std::size_t>(object.points);
  CHECK(scene.arrows.size() == moving);
  CHECK(Clip({&rollout, 0, ""}, {}, 1.5).scene(12).arrows.empty());
}

TEST_CASE("the camera follows what the task says, or what is asked for") {
  const Rollout rollout = example::simulate("Thrower-v0", example::walker, 60);
  const Clip task({&rollout, 0, ""}, {}, 1.5);
  RenderOptions alone;
  alone.camera.objects = {"robot"};
  const Clip robot({&rollout, 0, ""}, alone, 1.5);
  CHECK(task.scene(60).view.width > robot.scene(60).view.width);
  Camera world;
  world.mode = CameraMode::world;
  const Bounds everything = task.boxes(world)[60];
  for (const ModelObject& object : task.mesh().objects) {
    CHECK(everything.x0 <= task.extent(60, object).x0);
    CHECK(everything.x1 >= task.extent(60, object).x1);
  }
  alone.camera.objects = {"packag"};
  expect_error(Failure::usage, Contains("did you mean 'package'"), [&] {
    Clip({&rollout, 0, ""}, alone, 1.5);
  });
}

TEST_CASE("what cannot be drawn is refused with the reason") {
  Rollout rollout = example::simulate("Walker-v0", example::walker, 3);
  const auto open = [&](int episode) { Clip({&rollout, episode, ""}, {}, 1.5); };
  expect_error(Failure::usage, Contains("no episode 1") && Contains("0 to 0"), [&] { open(1); });
  expect_error(Failure::usage, Contains("no episode -1"), [&] { open(-1); });

  struct Damage {
    const char* words;
    void (*of)(Rollout& rollout);
  };
  const Damage damage = GENERATE(values<Damage>(
      {{"evo-eval --rollout", [](Rollout& it) { it.world.cells.clear(); }},  // of other makers
       {"no episodes", [](Rollout& it) { it.episodes.clear(); }},
       {"point 5 is at", [](Rollout& it) { it.episodes[0].positions[5].y = std::nan(""); }},
       {"positions", [](Rollout& it) { it.episodes[0].positions.pop_back(); }},
       {"points", [](Rollout& it) { it.world.objects[1].points += 1; }}}));
  damage.of(rollout);
  expect_error(Failure::data, Contains(damage.words), [&] { open(0); });
}

TEST_CASE("borders of cells that touch without a link are surfaces") {
  Body body = Body::from_rows({"HH"});
  std::vector<Vec2> points;
  const auto surfaces = [](const Mesh& mesh) {
    return std::count_if(mesh.edges.begin(), mesh.edges.end(),
                         [](const Mesh::Edge& edge) { return edge.other < 0; });
  };
  CHECK(surfaces(make_mesh(body, points)) == 6);
  CHECK(make_mesh(body, points).edges.size() == 7);
  body.links.clear();
  CHECK(surfaces(make_mesh(body, points)) == 8);
  // Unlinked, each has an outline of its own.
  CHECK(make_mesh(body, points).outlines[0].size() == 2);
  // A ring has one outside and one inside.
  const auto ring = make_mesh(Body::from_rows({"HHH", "H.H", "HHH"}), points).outlines[0];
  REQUIRE(ring.size() == 2);
  CHECK((ring[0].closed && ring[1].closed));
  CHECK(ring[0].points.size() + ring[1].points.size() == 12 + 4);
  // The same from a compiled model.
  const Model model = example::build(example::task("Walker-v0"), {"HH"});
  CHECK(surfaces(make_mesh(
            {{model.objects()[0]}, {model.cells().begin(), model.cells().begin() + 2}})) == 6);
}

}  // namespace
}  // namespace evo::render
