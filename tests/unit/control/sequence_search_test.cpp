#include "libevo/control/sequence_search.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/unit/control/arena.h"

using namespace evo;

namespace {

// Flat ground with a step of two voxels ahead of the robot, which walks no further
// without a trick.
TaskSpec stair(int steps) {
  TaskSpec task = test::walker(steps);
  const Body block(2, 20, std::vector<Voxel>(40, Voxel::fixed));
  task.objects.push_back({Object{"stair", block, 6, 1}, "", ""});
  return task;
}

TrainingSettings brief() {
  TrainingSettings settings;
  settings.environments = 4;
  settings.shortest_period = 6;
  settings.longest_period = 40;
  return settings;
}
EvaluationSettings once() { return {}; }
Stream stream(std::uint64_t seed) { return {seed, "test"}; }

double best_of(const Arena& arena, const std::vector<ReplayController>& sequences) {
  double best = -1e9;
  for (const ReplayController& sequence : sequences)
    best = std::max(best, evaluate(arena, sequence, once()).mean());
  return best;
}

}  // namespace

TEST_CASE("exploration takes the steps it may, and goes further with more") {
  const Arena arena(test::walker(60), test::body_a());
  SequenceSearch search(arena, brief(), once(), stream(1));
  CHECK(search.explore(4 * 60 - 1) == 0);  // too few for the first episodes
  CHECK(search.levels() == 0);
  const std::int64_t taken = search.explore(1000);
  CHECK(taken <= 1000);
  CHECK(taken > 1000 - 4);
  const double first = search.highest();
  CHECK(search.levels() > 2);
  std::int64_t more = 0;
  for (int k = 0; k < 10; ++k) more += search.explore(1000);
  CHECK(more > 9960);
  CHECK(search.highest() > first);
}

TEST_CASE("a sequence that is news earns what its level says, from the beginning") {
  const Arena arena(stair(80), test::body_a());
  SequenceSearch search(arena, brief(), once(), stream(2));
  double highest = 0.0;
  for (int k = 0; k < 4; ++k) {
    search.explore(2000);
    const auto news = search.news();
    REQUIRE(news.size() <= 2);
    for (const ReplayController& sequence : news) {
      REQUIRE(sequence.steps() == 80);
      REQUIRE(sequence.actuators == arena.action_length());
      for (const double target : sequence.actions) {
        REQUIRE(target >= 0.6);
        REQUIRE(target <= 1.6);
        REQUIRE(target * 1024 == std::round(target * 1024));
      }
      const Evaluation episode = evaluate(arena, sequence, once());
      highest = std::max(highest, episode.peaks[0]);
    }
    CHECK(search.news().empty());  // not twice
  }
  // To the last bit: states that were put back continued as if nothing had happened.
  CHECK(highest >= search.highest());
}

TEST_CASE("a search that starts from a sequence has at once what that reaches") {
  const Arena arena(test::walker(60), test::body_a());
  SequenceSearch old_search(arena, brief(), once(), stream(3));
  old_search.explore(6000);
  const auto old_news = old_search.news();
  REQUIRE(!old_news.empty());
  const ReplayController& start = old_news.front();
  const Evaluation episode = evaluate(arena, start, once());
  SequenceSearch search(arena, brief(), once(), stream(4), start);
  search.explore(60 + 4 * 60);
  CHECK(search.highest() >= 0.9 * episode.peaks[0]);
  CHECK(best_of(arena, search.news()) >= episode.returns[0]);
}

TEST_CASE("a search that starts from a gait does all that this does") {
  const Arena arena(test::walker(60), test::body_a());
  SineController gait;
  gait.period = 20;
  const auto actuators = static_cast<std::size_t>(arena.action_length());
  gait.amplitude.assign(actuators, 0.8);  // beyond the range of targets: cut off
  for (std::size_t i = 0; i < actuators; ++i) gait.phase.push_back(0.7 * static_cast<double>(i));
  const double earns = evaluate(arena, gait, once()).mean();
  SequenceSearch search(arena, brief(), once(), stream(7), gait);
  search.explore(60 + 4 * 60);
  CHECK(best_of(arena, search.news()) >= earns);
  SequenceSearch offered(arena, brief(), once(), stream(7));
  offered.explore(4 * 60 + 8);
  offered.offer(gait);
  offered.explore(60 + 4 * 60);
  CHECK(best_of(arena, offered.news()) >= earns);
}

TEST_CASE("levels stay so many that they fit in memory") {
  const Arena arena(test::walker(400), test::body_a());
  // A start that earns nothing asks for very low levels.
  ReplayController rest{std::vector<double>(400 * 11, 1.0), arena.action_length()};
  rest.actions.assign(static_cast<std::size_t>(400 * arena.action_length()), 1.0);
  SequenceSearch search(arena, brief(), once(), stream(5), rest);
  search.explore(12000);
  CHECK(search.levels() > 20);
  CHECK(search.levels() <= 200);
}

TEST_CASE("a search for a sequence resumes to the same bytes") {
  const Arena arena(stair(60), test::body_a());
  SequenceSearch whole(arena, brief(), once(), stream(6));
  whole.explore(3000);
  (void)whole.news();
  Checkpoint checkpoint;
  whole.serialize(Archive::saving(checkpoint));
  SequenceSearch resumed(arena, brief(), once(), stream(6));
  resumed.serialize(Archive::loading(checkpoint));
  CHECK(resumed.explore(2000) == whole.explore(2000));
  CHECK(resumed.news() == whole.news());
  Checkpoint a;
  Checkpoint b;
  whole.serialize(Archive::saving(a));
  resumed.serialize(Archive::saving(b));
  CHECK(a == b);
  for (const std::string part : {"highest", "soonest"}) {
    Checkpoint damaged = a;
    std::vector<std::uint8_t> cut = a.get<std::uint8_t>(part);
    cut.pop_back();
    damaged.put(part, cut);
    CHECK_THROWS_WITH(resumed.serialize(Archive::loading(damaged)), Catch::Contains("is damaged"));
  }
  // Moments of times instead of levels, of which none is that of the start.
  Checkpoint late = a;
  late.put("soonest", a.get<std::uint8_t>("highest"));
  CHECK_THROWS_WITH(resumed.serialize(Archive::loading(late)),
                    Catch::Contains("does not begin where episodes do"));
}

TEST_CASE("a search does what came too early once more, so as to end with it") {
  // A jump counts at the end of the episode only.
  TaskSpec task = test::walker(150);
  task.reward = {{1.0, reward::Displacement{robot_name, Axis::y}, {}}};
  const Arena arena(task, test::body_a());
  const auto actuators = static_cast<std::size_t>(arena.action_length());
  int rested = 0;  // searches whose best episode begins with that
  double late = 0.0;
  double early = 0.0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SequenceSearch search(arena, brief(), once(), stream(seed));
    search.explore(12000);
    Checkpoint checkpoint;
    search.serialize(Archive::saving(checkpoint));
    const auto& ended = checkpoint.get<double>("ended");
    REQUIRE(ended.size() == 150 * actuators);
    const auto twenty_steps = static_cast<std::ptrdiff_t>(20 * actuators);
    const auto at_rest = [](double target) { return target == 1.0; };
    if (std::all_of(ended.begin(), ended.begin() + twenty_steps, at_rest)) ++rested;
    late += checkpoint.get<double>("numbers", 3)[1];
    early += search.highest();
  }
  CHECK(rested > 0);  // without: none, and 0.7 of it
  CHECK(late > 0.8 * early);
}
