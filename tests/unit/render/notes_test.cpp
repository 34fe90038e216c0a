// Words over robots and at the borders of films.
#include "render/scene/notes.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "formats/task/task.h"
#include "render/film/evolution_film.h"
#include "render/film/race.h"
#include "tests/unit/render/example.h"

namespace evo::render {
namespace {

using Catch::Matchers::Contains;

constexpr Rect panel{0, 0, 640, 360};
const Projection to_pixels({16, 9, 32, 18}, panel);

bool overlap(const Rect& a, const Rect& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

bool apart(const std::vector<Rect>& plates) {
  for (std::size_t k = 0; k < plates.size(); ++k) {
    if (plates[k].x < 0 || plates[k].x + plates[k].width > panel.width || plates[k].y < 0 ||
        plates[k].y + plates[k].height > panel.height)
      return false;
    for (std::size_t j = 0; j < k; ++j)
      if (overlap(plates[j], plates[k])) return false;
  }
  return true;
}

// Plates of one colour.
std::vector<Rect> plates_of(const Drawing& drawing, Color color) {
  std::vector<Rect> plates;
  for (const Drawing::Item& item : drawing.items())
    if (const auto* plate = std::get_if<RoundedRectangle>(&item.shape);
        plate && plate->color == color)
      plates.push_back(plate->area);
  return plates;
}

TEST_CASE("tags stand above what they name, and never over one another") {
  const std::vector<Note> far{{{5, 6}, "A"}, {{20, 8}, "B"}};
  const auto alone = tag_plates(far, to_pixels);
  for (std::size_t k = 0; k < far.size(); ++k) {
    const Point at = to_pixels(far[k].at);
    CHECK(alone[k].x + alone[k].width / 2 == Approx(at.x));
    CHECK(alone[k].y + alone[k].height / 2 == Approx(at.y));
  }
  std::vector<Note> heap;
  for (int k = 0; k < 12; ++k)
    heap.push_back(
        {{10 + 0.3 * std::sin(k), 15 + 0.2 * k}, std::string(1, static_cast<char>('A' + k))});
  CHECK(apart(tag_plates(heap, to_pixels)));
  const std::vector<Note> outside{{{-40, 9}, "A"}, {{-50, 9}, "B"}, {{99, 40}, "C"}};
  CHECK(apart(tag_plates(outside, to_pixels)));
}

TEST_CASE("a tag that another one passes moves without a jump") {
  constexpr double stride = 0.02;
  float before = 0;
  for (double x = 4; x < 12; x += stride) {
    const auto plates = tag_plates({{{8, 6}, "A"}, {{x, 6.1}, "B"}}, to_pixels);
    REQUIRE(apart(plates));
    if (x > 4) CHECK(std::abs(plates[1].y - before) < 2);
    before = plates[1].y;
  }
}

TEST_CASE("letters of a race from one start can all be read") {
  const Rollout rollout = example::simulate("Climber-v0", example::walker, 20);
  RenderOptions options;
  options.size = {640, 360};
  const Race race(std::vector<Episode>(5, Episode{&rollout, 0, "walker"}), options);
  Typesetter typesetter;
  for (const double step : {0.0, 10.5, 20.0}) {
    const Drawing drawing = race.frame(step, typesetter);
    std::vector<Rect> plates;  // over robots, and in the ranking
    for (std::size_t k = 0; k < 5; ++k)
      for (const Rect& plate : plates_of(drawing, runner_color(k))) plates.push_back(plate);
    CHECK(plates.size() == 10);
    CHECK(apart(plates));
  }
}

TEST_CASE("who runs along the ground has a lane, and a place when it has arrived") {
  const Rollout slow = example::simulate("Walker-v0", example::walker, 40);
  // One that is carried over the finish in its last step.
  Rollout quick = example::simulate("Walker-v0", example::walker, 30);
  quick.task_yaml = task_to_yaml(example::task("Walker-v0"));
  RolloutEpisode& episode = quick.episodes[0];
  const ModelObject& robot = quick.world.objects.front();
  for (int p = robot.first_point; p < robot.first_point + robot.points; ++p)
    episode.positions[static_cast<std::size_t>(30 * quick.points + p)].x += 9.9;
  episode.terminations.back() = 1;
  RenderOptions options;
  options.size = {640, 360};
  const Race race({{&quick, 0, "quick"}, {&slow, 0, "slow"}}, options);
  Typesetter typesetter;
  const auto words = [&](double step) {
    std::string all;
    const Drawing drawing = race.frame(step, typesetter);
    for (const Text& text : drawing.texts()) all += text.text + "|";
    return all;
  };
  CHECK_THAT(words(10), !Contains("1st"));
  CHECK_THAT(words(30), Contains("1st   0.60 s") && !Contains("2nd"));
  CHECK_THAT(words(40), Contains("1st   0.60 s") && Contains("2nd   "));
  for (std::size_t k = 0; k < 2; ++k)
    CHECK(plates_of(race.frame(40, typesetter), runner_color(k)).size() == 1);
  const Race tie({{&slow, 0, "one"}, {&slow, 0, "the same"}}, options);
  const Drawing end = tie.frame(40, typesetter);
  CHECK(std::ranges::count_if(end.texts(),
                              [](const Text& text) { return text.text.starts_with("1st"); }) == 2);
}

TEST_CASE("a lane shows what the task follows from the feet to the top, from the first moment") {
  const std::string task = GENERATE("Walker-v0", "Carrier-v0");  // and its package
  Rollout rollout = example::simulate(task, example::walker, 60);
  rollout.task_yaml = task_to_yaml(example::task(task));
  RenderOptions options;
  options.size = {640, 480};
  constexpr float lane = 160;
  const Race race(std::vector<Episode>(3, Episode{&rollout, 0, "walker"}), options);
  Typesetter typesetter;
  for (const double step : {0.0, 5.0, 60.0}) {
    const Drawing drawing = race.frame(step, typesetter);
    std::array<int, 3> seen{};
    for (const Drawing::Item& item : drawing.items())
      for (std::size_t k = 0; k < 3; ++k)
        if (const auto* stroke = std::get_if<Stroke>(&item.shape);
            stroke && stroke->color == runner_color(k))
          for (const Point& p : stroke->points) {
            ++seen[k];
            CHECK(p.y > lane * static_cast<float>(k));
            CHECK(p.y < lane * static_cast<float>(k + 1));
          }
    for (const int points : seen) CHECK(points > 8);
  }
}

// Rollouts of one robot that differ in how far it goes.
struct Champions {
  std::vector<Rollout> rollouts;
  std::vector<Champion> champions;
  explicit Champions(int count) {
    for (int k = 0; k < count; ++k)
      rollouts.push_back(example::simulate("Walker-v0", example::walker, 20 + 10 * k));
    for (int k = 0; k < count; ++k)
      champions.push_back({{&rollouts[static_cast<std::size_t>(k)], 0, ""}, k, k, 0.1 * k});
  }
};

TEST_CASE("a film marks where earlier generations came to, their words apart") {
  const Champions five(5);
  RenderOptions options;
  options.size = {640, 360};
  const EvolutionFilm film(five.champions, options);
  Typesetter typesetter;
  const Drawing first = film.frame(0, typesetter);
  CHECK(plates_of(first, theme_by_name("light").trail).empty());
  const Drawing last = film.frame(film.frames() - 1, typesetter);
  const auto plates = plates_of(last, theme_by_name("light").trail);
  CHECK(plates.size() >= 1);
  CHECK(apart(plates));
  // The latest of them has its word.
  CHECK(std::ranges::any_of(last.texts(), [](const Text& text) { return text.text == "gen 3"; }));
  for (const Rect& plate : plates) CHECK(plate.y > 0.9F * panel.height);
}

TEST_CASE("one colour is one value in all generations of a film, and in all its panels") {
  const Champions two(2);
  RenderOptions options;
  options.overlays.tint = Tint::strain;
  std::vector<Clip> clips;
  for (const Champion& champion : two.champions) clips.emplace_back(champion.episode, options, 1.5);
  clips[0].value_scale({"strain", -0.1, 0, 0.2});
  clips[1].value_scale({"strain", -0.5, 0, 0.1});
  share_value_scale(clips);
  for (const Clip& clip : clips) {
    CHECK(clip.scene(5).value_scale.low == -0.5);
    CHECK(clip.scene(5).value_scale.high == 0.2);
  }
}

}  // namespace
}  // namespace evo::render
