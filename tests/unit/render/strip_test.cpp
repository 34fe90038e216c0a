// Panoramas, and the moments they show.
#include "render/figures/strip.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "render/film/loop.h"
#include "render/scene/moments.h"
#include "tests/unit/render/example.h"

namespace evo::render {
namespace {

using Catch::Matchers::Contains;

// The robot of a rollout standing where it began, its upper parts swinging with this
// period.
Rollout swinging(Rollout rollout, double period) {
  return example::moved(std::move(rollout), [&](Vec2 start, Vec2 /*now*/, int step) {
    const double swing = std::sin(6.283185307179586 * step / period);
    return Vec2{start.x + 0.3 * start.y * swing, start.y};
  });
}

const Theme& light() { return theme_by_name("light"); }

TEST_CASE("the period of a gait is that of the robot's shape") {
  const Rollout rollout = swinging(example::simulate("Walker-v0", example::walker, 200), 20);
  const Clip clip({&rollout, 0, ""}, {}, 1.5);
  CHECK(gait_period(clip, 60, 200) == 20);
  const Rollout still = example::simulate("Walker-v0", {"SS", "SS"}, 200);
  CHECK_FALSE(gait_period(Clip({&still, 0, ""}, {}, 1.5), 100, 200));
  CHECK_FALSE(gait_period(clip, 60, 63));  // too short to tell
}

TEST_CASE("moments are spread over the episode, and over the cycle if it is asked for") {
  const Rollout rollout = swinging(example::simulate("Walker-v0", example::walker, 200), 20);
  const Clip clip({&rollout, 0, ""}, {}, 1.5);
  CHECK(choose_moments(clip, 0, 200, 6, Choice::time) ==
        std::vector<int>{0, 40, 80, 120, 160, 200});
  // 40 steps are two cycles of 20: the same pose six times.
  const std::vector<int> spread = choose_moments(clip, 0, 200, 6, Choice::gait);
  REQUIRE(spread.size() == 6);
  CHECK(spread.front() == 0);
  CHECK(spread.back() == 200);
  std::vector<int> phases;
  for (std::size_t k = 0; k + 1 < spread.size(); ++k) {
    CHECK(std::abs(spread[k] - static_cast<int>(40 * k)) <= 10);
    phases.push_back(spread[k] % 20);
  }
  std::sort(phases.begin(), phases.end());
  CHECK(std::adjacent_find(phases.begin(), phases.end()) == phases.end());
  CHECK(choose_moments(clip, 0, 200, 1, Choice::gait) == std::vector<int>{200});
}

TEST_CASE("moments are where something happens") {
  // A robot that rests for 180 steps and then leaves.
  Rollout rollout = example::moved(example::simulate("Walker-v0", example::small_box, 200),
                                   [](Vec2 start, Vec2 /*now*/, int step) {
                                     return Vec2{start.x + 0.05 * std::max(0, step - 180), start.y};
                                   });
  std::ranges::fill(rollout.episodes[0].rewards, 0.0);
  const Clip clip({&rollout, 0, ""}, {}, 1.5);
  const std::vector<int> steps = choose_moments(clip, 0, 200, 5, Choice::event);
  CHECK(steps.front() == 0);
  CHECK(steps.back() == 200);
  CHECK(std::ranges::is_sorted(steps));
  CHECK(std::ranges::count_if(steps, [](int step) { return step > 180; }) >= 3);
  CHECK(choose_moments(clip, 0, 2, 5, Choice::event).size() == 5);  // fewer steps than moments
  CHECK(choose_moments(clip, 7, 7, 1, Choice::event) == std::vector<int>{7});
}

TEST_CASE("a robot that turns around is counted") {
  const Rollout rollout =
      example::moved(example::simulate("Flipper-v0", example::small_box, 100),
                     [](Vec2 start, Vec2 /*now*/, int step) {
                       const double angle = 2 * 3.141592653589793 * 2.5 * step / 100;
                       const Vec2 arm{start.x - 6.1, start.y - 0.2};  // about a place inside
                       return Vec2{6.1 + std::cos(angle) * arm.x - std::sin(angle) * arm.y,
                                   0.2 + std::sin(angle) * arm.x + std::cos(angle) * arm.y};
                     });
  const Clip clip({&rollout, 0, ""}, {}, 1.5);
  CHECK(clip.turns(0) == "0.0 turns");
  CHECK(clip.turns(100) == "2.5 turns");
  CHECK(clip.caption(40).goal == "1.0 turns");
  const Rollout walk = example::simulate("Walker-v0", example::small_box, 10);
  CHECK(Clip({&walk, 0, ""}, {}, 1.5).turns(10).empty());
}

TEST_CASE("a gait is repeated for ever, and what is none goes there and back") {
  const Rollout rollout = swinging(example::simulate("Walker-v0", example::walker, 200), 20);
  const Clip clip({&rollout, 0, ""}, {}, 1.0);
  const std::string svg = gait_loop(clip, 60, 200, {320, 320}, "a <walk>");
  CHECK_THAT(svg, Contains("<title>a &lt;walk&gt;") && Contains("dur=\"0.40s\""));
  std::size_t shapes = 0;
  for (std::size_t at = 0; (at = svg.find("class=\"c r", at)) != std::string::npos; ++at) ++shapes;
  CHECK(static_cast<int>(shapes) == rollout.world.objects.front().cells);
  // As many pictures as steps, and the first again.
  const std::size_t first = svg.find("values=\"");
  const std::string values = svg.substr(first, svg.find("\"/>", first) - first);
  CHECK(std::ranges::count(values, ';') == 20);
  // Too short for a gait: every second step, there and back, before the ground.
  const std::string back = gait_loop(clip, 0, 15, {320, 320}, "a start");
  CHECK_THAT(back, Contains("dur=\"0.56s\"") && Contains("<polygon class=\"c w\""));
  CHECK_NOTHROW(gait_loop(clip, 7, 7, {320, 320}, "a moment"));
  // A bridge is no ground, and is drawn.
  const Rollout bridge = swinging(example::simulate("BridgeWalker-v0", example::walker, 200), 20);
  CHECK_THAT(gait_loop(Clip({&bridge, 0, ""}, {}, 1.0), 60, 200, {320, 320}, "a bridge"),
             Contains("class=\"c oS\""));
  CHECK_THAT(gait_loop(clip, 0, 15, {320, 60}, "a flat one"), Contains(" height=\"60\""));
}

TEST_CASE("a strip suits what goes far, and does not lie over itself") {
  const Rollout still = example::simulate("Walker-v0", example::walker, 60);
  const auto suits = [&](Vec2 a_step, const std::vector<int>& moments) {
    const Rollout rollout = example::carried(still, a_step);
    return suits_strip(Clip({&rollout, 0, ""}, {}, 1.5), moments);
  };
  const std::vector<int> moments{0, 15, 30, 45, 60};
  CHECK(suits({0.05, 0}, moments));        // 30 voxels
  CHECK(suits({0, 0.05}, moments));        // a climb
  CHECK_FALSE(suits({0, 0.01}, moments));  // a hop on the spot
  CHECK_FALSE(suits({0, 0}, moments));
  CHECK_FALSE(suits({0.05, 0}, {0, 3, 6, 9}));
  CHECK_FALSE(suits({0.05, 0}, {60}));
}

TEST_CASE("labels of a strip stand under their robots, in order, and never touch") {
  Rollout rollout =
      example::carried(example::simulate("Walker-v0", example::walker, 60), {0.02, 0});
  const Clip clip({&rollout, 0, ""}, {}, 1.5);
  Typesetter typesetter;
  const Drawing drawing = strip(clip, {0, 12, 24, 36, 48, 60}, light(), {600, 400}, typesetter);
  CHECK(drawing.size().width == 600);
  CHECK(drawing.size().height < 400);
  std::vector<const Text*> steps;
  for (const Text& text : drawing.texts())
    if (text.text.starts_with("step ")) steps.push_back(&text);
  REQUIRE(steps.size() == 6);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const float half = typesetter.width(steps[k]->text, steps[k]->size) / 2;
    CHECK(steps[k]->at.x - half >= 0);
    CHECK(steps[k]->at.x + half <= 600);
    if (k > 0)
      CHECK(steps[k]->at.x - half >
            steps[k - 1]->at.x + typesetter.width(steps[k - 1]->text, steps[k]->size) / 2);
  }
}

TEST_CASE("a climber gets a picture that stands") {
  const Rollout rollout =
      example::carried(example::simulate("Climber-v0", example::small_box, 60), {0, 0.05});
  const Clip clip({&rollout, 0, ""}, {}, 1.5);
  Typesetter typesetter;
  const Drawing drawing = strip(clip, {0, 30, 60}, light(), {800, 500}, typesetter);
  CHECK(drawing.size().height == 500);
  CHECK(drawing.size().width < 500);
}

}  // namespace
}  // namespace evo::render
