#include "libevo/control/transfer.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "libevo/control/policy_passes.h"
#include "tests/unit/control/arena.h"

using namespace evo;

namespace {

Policy fresh_policy(const Arena& arena, std::uint64_t seed) {
  TrainingSettings settings;
  settings.hidden = {12, 10};
  Policy policy = initial_policy(settings, arena.observation_length(), arena.action_length(), 0.6,
                                 1.6, {}, Stream(seed, "test"));
  Stream stream(seed, "moments");
  for (double& mean : policy.normalizer.mean) mean = stream.gaussian();
  for (double& variance : policy.normalizer.variance) variance = 1.0 + stream.uniform();
  policy.normalizer.count = 50000;
  return policy;
}

}  // namespace

TEST_CASE("points and actuators are known by their places on the lattice") {
  const Anatomy a = anatomy(Body::from_rows({"HR", ".V"}), {});
  CHECK(a.actuators == std::vector<Anatomy::Place>{{0, 0}, {1, 1}});
  CHECK(a.points.size() == 8);
  CHECK(a.points[0] == Anatomy::Place{0, 0});
  CHECK(a.points[3] == Anatomy::Place{1, 1});  // bottom right of the first cell
  CHECK(a.points[7] == Anatomy::Place{2, 2});
}

TEST_CASE("carried over to the same body, a policy acts as it did and keeps what it has seen") {
  const bool corners = GENERATE(false, true);
  const Arena arena(test::walker(10),
                    corners ? Body::from_rows({"HH.", "H.H", "HHH"}) : test::small_body());
  const Anatomy body = anatomy(arena);
  // With corners, voxels touch at one alone: two points are in the same place.
  const auto at_corner = std::count(body.points.begin(), body.points.end(), Anatomy::Place{1, 2});
  REQUIRE(at_corner == (corners ? 2 : 1));
  const Policy old_policy = fresh_policy(arena, 1);
  const Policy fresh = fresh_policy(arena, 2);
  const Policy policy = transferred(old_policy, body, fresh, body);
  CHECK(policy.actor == old_policy.actor);
  CHECK(policy.critic == old_policy.critic);
  CHECK(policy.normalizer == old_policy.normalizer);
  CHECK(policy.log_std == fresh.log_std);
}

TEST_CASE("where a body has one point for two of the old one, it is read as both") {
  const Arena apart(test::walker(10), Body::from_rows({"HH.", "H.H", "HHH"}));
  const Arena joined(test::walker(10), Body::from_rows({"HHH", "H.H", "HHH"}));
  const Policy old_policy = fresh_policy(apart, 1);
  const Policy policy =
      transferred(old_policy, anatomy(apart), fresh_policy(joined, 2), anatomy(joined));
  const std::vector<Anatomy::Place> from = anatomy(apart).points;
  const std::vector<Anatomy::Place> to = anatomy(joined).points;
  const auto column = [](const Policy& of, const std::vector<Anatomy::Place>& points,
                         std::vector<Anatomy::Place>::const_iterator point) {
    return of.actor.layers.front().weight.col(2 + (point - points.begin()));
  };
  const auto there = std::find(to.begin(), to.end(), Anatomy::Place{1, 2});
  const auto first = std::find(from.begin(), from.end(), *there);
  const auto second = std::find(first + 1, from.end(), *there);
  REQUIRE(second != from.end());
  CHECK(column(policy, to, there)
            .isApprox(column(old_policy, from, first) + column(old_policy, from, second)));
}

TEST_CASE("carried over to a body with a voxel more, old actuators do what they did at rest") {
  const Arena small(test::walker(10), test::small_body());  // HHH V.V
  const Arena large(test::walker(10), Body::from_rows({"HHH", "VHV"}));
  const Policy old_policy = fresh_policy(small, 1);
  const Policy policy =
      transferred(old_policy, anatomy(small), fresh_policy(large, 2), anatomy(large));
  CHECK(policy.normalizer.count == 10000);  // adapts
  // All points are the old ones but for their order: put them where they are.
  const std::vector<Anatomy::Place> from = anatomy(small).points;
  const std::vector<Anatomy::Place> to = anatomy(large).points;
  Stream stream(3, "test");
  std::vector<double> old_seen(static_cast<std::size_t>(small.observation_length()));
  for (double& x : old_seen) x = stream.gaussian();
  std::vector<double> seen(static_cast<std::size_t>(large.observation_length()));
  seen[0] = old_seen[0];
  seen[1] = old_seen[1];
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (std::size_t p = 0; p < to.size(); ++p) {
      const auto old = std::find(from.begin(), from.end(), to[p]);
      REQUIRE(old != from.end());
      seen[2 + axis * to.size() + p] =
          old_seen[2 + axis * from.size() + static_cast<std::size_t>(old - from.begin())];
    }
  REQUIRE(policy.action_length() == 6);
  std::vector<double> before(5);
  std::vector<double> after(6);
  act(old_policy, old_seen, std::vector{0}, before);
  act(policy, seen, std::vector{0}, after);
  const std::vector<std::size_t> old_ones{0, 1, 2, 3, 5};  // the new one is in the middle below
  for (std::size_t i = 0; i < 5; ++i) CHECK(after[old_ones[i]] == Approx(before[i]).margin(1e-5));
}

TEST_CASE("gaits and sequences are carried over to the nearest actuators") {
  const Anatomy from = anatomy(test::small_body(), {});
  const Anatomy to = anatomy(Body::from_rows({"HHH", "VHV"}), {});
  const SineController gait = transferred(travelling_wave(5, 0.3, 21.0, 0.5), from, to);
  CHECK(gait.period == 21.0);
  CHECK(gait.phase == std::vector<double>{0.0, 0.5, 1.0, 1.5, 0.5, 2.0});

  const ReplayController sequence{{1.0, 1.1, 1.2, 1.3, 1.4, 0.6, 0.7, 0.8, 0.9, 1.0}, 5};
  const ReplayController carried = transferred(sequence, from, to);
  CHECK(carried.actuators == 6);
  CHECK(carried.actions ==
        std::vector<double>{1.0, 1.1, 1.2, 1.3, 1.1, 1.4, 0.6, 0.7, 0.8, 0.9, 0.7, 1.0});
}

TEST_CASE("networks of another shape are refused") {
  const Arena arena(test::walker(10), test::small_body());
  const Policy old_policy = fresh_policy(arena, 1);
  Policy fresh = fresh_policy(arena, 2);
  fresh.actor.layers.erase(fresh.actor.layers.begin());
  CHECK_THROWS_WITH(transferred(old_policy, anatomy(arena), fresh, anatomy(arena)),
                    Catch::Contains("hidden layers"));
  fresh = fresh_policy(arena, 2);
  fresh.action_map = ActionMap::squash;
  CHECK_THROWS_WITH(transferred(old_policy, anatomy(arena), fresh, anatomy(arena)),
                    Catch::Contains("action_map"));
}
