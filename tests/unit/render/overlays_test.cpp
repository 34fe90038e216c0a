// What colours, arrows and captions over a scene say.
#include <catch2/catch.hpp>
#include <cmath>

#include "formats/rollout/ending.h"
#include "formats/task/physics_profile.h"
#include "libevo/task/contacts.h"
#include "render/figures/plot.h"
#include "render/render.h"
#include "render/scene/quantity.h"
#include "tests/unit/expect.h"
#include "tests/unit/render/example.h"

namespace evo::render {
namespace {

using Catch::Matchers::Contains;
using test::expect_error;

Rollout simulated(const std::string& task, int steps) {
  Rollout rollout = example::simulate(task, example::walker, steps);
  rollout.physics_yaml = physics_profiles().to_yaml(example::task(task).physics);
  return rollout;
}

RenderOptions with(Tint tint) {
  RenderOptions options;
  options.overlays.tint = tint;
  return options;
}

// ---- colours -----------------------------------------------------------------------

TEST_CASE("colours of values grow darker from the middle, and stay beyond the ends") {
  const ValueScale scale{"strain", -0.2, 0, 0.4};
  double before = 1;
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double high = luminance(color_of(scale, 0.4 * share));
    CHECK(high < before);
    before = high;
    // Either side uses its own half of the bar whole.
    CHECK(luminance(color_of(scale, -0.2 * share)) == Approx(high).margin(0.12));
  }
  CHECK(color_of(scale, 9) == color_of(scale, 0.4));
  CHECK(color_of(scale, -9) == color_of(scale, -0.2));
  CHECK(color_of(scale, 0.3).r > color_of(scale, 0.3).b);
  CHECK(color_of(scale, -0.15).b > color_of(scale, -0.15).r);
}

TEST_CASE("strain is the change of a cell's area; terrain has none") {
  // In the second moment, everything that moves is twice as wide.
  const Rollout rollout =
      example::moved(simulated("Walker-v0", 1), [](Vec2 start, Vec2 /*now*/, int step) {
        return Vec2{(1 + step) * start.x, start.y};
      });
  const Clip clip({&rollout, 0, ""}, with(Tint::strain), 1.5);
  const std::vector<float> rest = clip.values(0);
  const std::vector<float> wide = clip.values(1);
  for (std::size_t c = 0; c < rest.size(); ++c) {
    if (rollout.world.cells[c].type == Voxel::fixed) {
      CHECK(std::isnan(wide[c]));
      continue;
    }
    CHECK(rest[c] == Approx(0).margin(1e-5));
    CHECK(wide[c] == Approx(1).margin(1e-5));
    CHECK(clip.values(0.5)[c] == Approx(0.5).margin(1e-5));
  }
  CHECK(clip.scene(1).value_scale.high == Approx(1));
  CHECK(clip.scene(1).value_scale.low == Approx(-1));
}

TEST_CASE("stress follows from springs: nothing at rest, tension of what is drawn out") {
  Rollout rollout = simulated("Walker-v0", 1);
  rollout.episodes[0].actions.assign(rollout.episodes[0].actions.size(), 1.0);
  std::vector<Vec2>& positions = rollout.episodes[0].positions;
  const auto points = static_cast<std::size_t>(rollout.points);
  constexpr double stretch = 1.01;
  for (std::size_t p = 0; p < points; ++p)
    positions[points + p] = {stretch * positions[p].x, stretch * positions[p].y};
  const Physics physics = example::task("Walker-v0").physics;
  const Clip clip({&rollout, 0, ""}, with(Tint::stress), 1.5);
  for (const float value : clip.values(0))
    if (!std::isnan(value)) CHECK(value == Approx(0).margin(1e-3));
  // A soft cell between soft cells: four sides, each counted half, and two diagonals.
  const double weight = rollout.world.objects.front().points * physics.gravity;
  const double sides = 4 * 0.5 * physics.soft.edge * (stretch - 1) * stretch;
  const double diagonals = 2 * physics.soft.diagonal * (stretch - 1) * stretch * 2;
  const double expected =
      physics.voxel_length * (sides + diagonals) / (2 * stretch * stretch) / weight;
  std::size_t soft = 0;
  const std::vector<float> values = clip.values(1);
  for (std::size_t c = 0; c < values.size(); ++c) {
    if (rollout.world.cells[c].type == Voxel::fixed) continue;
    CHECK(values[c] > 0);
    if (rollout.world.cells[c].type != Voxel::soft) continue;
    ++soft;
    // Sides shared with actuators are stiffer, those at the surface count whole.
    CHECK(values[c] == Approx(expected).epsilon(0.35));
  }
  CHECK(soft == 3);

  // Springs twice as stiff, and those that say so in colour.
  Body& body = rollout.robot->body;
  body = with_stiffness(body, std::vector<double>(body.cells.size(), 2.0));
  const Clip stiffer({&rollout, 0, ""}, with(Tint::stress), 1.5);
  const Clip colours({&rollout, 0, ""}, with(Tint::stiffness), 1.5);
  for (std::size_t c = 0; c < values.size(); ++c) {
    if (rollout.world.cells[c].type == Voxel::fixed) continue;
    CHECK(stiffer.values(1)[c] == Approx(2 * values[c]));
    CHECK(colours.values(1)[c] == Approx(std::log10(2)));
  }
}

TEST_CASE("an actuator told to be longer presses until it is") {
  Rollout rollout = simulated("Walker-v0", 2);
  rollout.episodes[0].actions.assign(rollout.episodes[0].actions.size(), 1.6);
  std::vector<Vec2>& positions = rollout.episodes[0].positions;
  const auto points = static_cast<std::size_t>(rollout.points);
  for (std::size_t k = points; k < positions.size(); ++k) positions[k] = positions[k - points];
  const Clip clip({&rollout, 0, ""}, with(Tint::stress), 1.5);
  const Clip told({&rollout, 0, ""}, with(Tint::commanded), 1.5);
  for (std::size_t c = 0; c < rollout.world.cells.size(); ++c) {
    const bool actuator = is_actuator(rollout.world.cells[c].type);
    CHECK(std::isnan(told.values(1)[c]) == !actuator);
    if (!actuator) continue;
    CHECK(told.values(0)[c] == 1);
    CHECK(told.values(1)[c] == Approx(1.6));
    CHECK(clip.values(1)[c] < 0);
    CHECK(clip.values(2)[c] < clip.values(1)[c]);
  }
}

TEST_CASE("what a file does not carry is named") {
  Rollout rollout = simulated("Walker-v0", 3);
  rollout.episodes[0].actions.pop_back();
  expect_error(Failure::data, Contains("actions"), [&] {
    Clip({&rollout, 0, ""}, with(Tint::commanded), 1.5);
  });
  rollout.physics_yaml.clear();
  RenderOptions contacts;
  contacts.overlays.contacts = true;
  expect_error(Failure::data, Contains("physics_yaml"), [&] {
    Clip({&rollout, 0, ""}, contacts, 1.5);
  });
}

// ---- contacts ------------------------------------------------------------------------

TEST_CASE("a robot at rest is held up with its own weight, where it stands") {
  Rollout rollout = simulated("Walker-v0", 1);
  const TaskSpec task = example::task("Walker-v0");
  RenderOptions options;
  options.overlays.contacts = true;
  // The same positions again and again: no acceleration.
  RolloutEpisode& episode = rollout.episodes[0];
  const auto points = static_cast<std::size_t>(rollout.points);
  episode.positions.resize(points);
  for (int step = 0; step < 9; ++step)
    for (std::size_t k = 0; k < points; ++k) episode.positions.push_back(episode.positions[k]);
  episode.rewards.assign(9, 0);
  const Clip clip({&rollout, 0, ""}, options, 1.5);
  const Scene scene = clip.scene(5);
  // Its two feet, two corners each, and the corners of the ground below them.
  CHECK(scene.touches.size() >= 4);
  for (const Vec2& touch : scene.touches) CHECK(touch.y == Approx(1).margin(0.06));
  REQUIRE(scene.arrows.size() == 1);
  const Arrow& arrow = scene.arrows.front();
  CHECK(arrow.force);
  CHECK(arrow.from.y == Approx(1).margin(0.06));
  CHECK(arrow.to.y - arrow.from.y == Approx(scene.force_length));
  CHECK(arrow.to.x == Approx(arrow.from.x));
}

TEST_CASE("the force from outside is what moves the centre") {
  Physics physics;
  physics.drag = 0;
  const double step = physics.substep * physics.substeps;
  const auto path = [&](double acceleration) {
    std::vector<Vec2> centres;
    for (int t = 0; t < 12; ++t)
      centres.push_back({0, 0.5 * acceleration * t * t * step * step / physics.voxel_length});
    return centres;
  };
  CHECK(outside_force(path(-physics.gravity), 6, physics).y == Approx(0).margin(1e-9));
  CHECK(outside_force(path(0), 0, physics).y == Approx(1));
  CHECK(outside_force(path(physics.gravity), 11, physics).y == Approx(2));
  CHECK(outside_force(std::vector<Vec2>(2), 1, physics).y == 0);
}

TEST_CASE("a package on a robot touches it and is held") {
  const Rollout rollout = simulated("Carrier-v0", 60);
  RenderOptions options;
  options.overlays.contacts = true;
  const Clip clip({&rollout, 0, ""}, options, 1.5);
  std::size_t held = 0;
  for (int step = 30; step <= 60; ++step) {
    const Contacts contacts =
        contacts_of(clip.mesh().objects, clip.mesh().cells, clip.points(step));
    held += contacts.held.size();
    CHECK(contacts.points.size() >= contacts.ground.size());
  }
  CHECK(held > 15);
}

// ---- captions ------------------------------------------------------------------------

TEST_CASE("why an episode ended stands in its last moment, and videos stay there") {
  Rollout rollout = example::simulate("Walker-v0", example::walker, 5);
  CHECK(Clip({&rollout, 0, ""}, {}, 1.5).caption(5).ending.empty());
  CHECK_FALSE(Clip({&rollout, 0, ""}, {}, 1.5).over());
  rollout.episodes[0].truncations.back() = 1;
  const Clip clip({&rollout, 0, ""}, {}, 1.5);
  CHECK(clip.caption(4.9).ending.empty());
  CHECK(clip.caption(5).ending == "time is up");

  const test::ScratchFolder folder;
  const auto frames = [&](RenderOptions options, const std::string& name) {
    options.size = {96, 54};
    options.fps = 20;
    options.speed = 0.4;
    return render_video({{&rollout, 0, ""}}, options, folder / name);
  };
  RenderOptions cut;
  cut.to = 3;
  CHECK(frames({}, "held.gif") == 6 + 10);
  CHECK(frames(cut, "held.gif") == 4);
  CHECK(frames({}, "held-%d.png") == 6);
}

TEST_CASE("heights have a ruler where the task rewards them") {
  for (const std::string name :
       {"Climber-v0", "Climber-v1", "Climber-v2", "Jumper-v0", "HeightMaximizer-v0", "Lifter-v0"})
    CHECK(rewards_height(example::simulate(name, example::walker, 0)));
  for (const std::string name :
       {"Walker-v0", "Carrier-v0", "Catcher-v0", "BeamToppler-v0", "Balancer-v0", "UpStepper-v0"})
    CHECK_FALSE(rewards_height(example::simulate(name, example::walker, 0)));
  CHECK_FALSE(rewards_height({}));
}

// ---- curves --------------------------------------------------------------------------

TEST_CASE("a plot takes a share of the picture and ends at the moment shown") {
  const Rollout rollout = simulated("Walker-v0", 20);
  RenderOptions options;
  options.overlays.plot = Plot::reward_sum;
  const auto strokes = [&](double step) {
    const Drawing drawing = draw_moment({&rollout, 0, ""}, step, options);
    const Rect area = plot_area(drawing.whole());
    std::vector<std::size_t> lengths;
    for (const Drawing::Item& item : drawing.items())
      if (const auto* stroke = std::get_if<Stroke>(&item.shape);
          stroke && item.clip == area && stroke->points.size() > 2)  // the curve's alone
        lengths.push_back(stroke->points.size());
    return lengths;
  };
  // What comes, and what was.
  CHECK(strokes(0) == std::vector<std::size_t>{21});
  CHECK(strokes(5) == std::vector<std::size_t>{16, 6});
  CHECK(strokes(20) == std::vector<std::size_t>{21});
  Rollout silent = rollout;
  silent.episodes[0].actions.clear();
  options.overlays.plot = Plot::actuation;
  expect_error(Failure::data, Contains("actions"), [&] {
    draw_moment({&silent, 0, ""}, 3, options);
  });
}

}  // namespace
}  // namespace evo::render
