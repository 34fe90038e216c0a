// The same bits whatever the way: plain oracle, one by one, side by side, any
// instruction set, any state of the contact lists.
#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <memory>
#include <thread>

#include "libevo/base/error.h"
#include "libevo/body/operators.h"
#include "libevo/sim/compiled.h"
#include "tests/unit/sim/fixtures.h"
#include "tests/unit/sim/plain_simulator.h"
#include "tests/unit/sim/reference_case.h"

namespace evo {
namespace {

const std::vector<std::string> body_a{"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"};

World flat_world(Body body) { return {{fixed_ground(40), {"robot", std::move(body), 2, 1}}}; }

// Steps one state `steps` times under random targets, alone or as the last of
// `width` lanes that do something else.
std::uint64_t hash_after(const Model& model, int steps, std::size_t width) {
  std::vector<State> states(width, initial_state(model));
  std::vector<Lane> lanes;
  std::vector<Stream> randoms;
  for (std::size_t i = 0; i < width; ++i) {
    lanes.push_back({&model, &states[i]});
    randoms.emplace_back(1, "targets", width - 1 - i);
  }
  for (int t = 0; t < steps; ++t) {
    for (std::size_t i = 0; i < width; ++i) draw_targets(states[i], randoms[i]);
    step(lanes);
  }
  return hash_of(states.back());
}

// Runs both simulators side by side; the number of steps after which they differ.
int steps_until_different(const World& world, int steps, std::uint64_t seed) {
  const Model model(world, Physics{});
  State plain = initial_state(model);
  State fast = plain;
  Stream random(seed, "targets");
  for (int t = 0; t < steps; ++t) {
    draw_targets(plain, random);
    fast.targets = plain.targets;
    const StepResult expected = plain_step(model, plain);
    Lane lane{&model, &fast};
    step({&lane, 1});
    if (lane.result != expected || hash_of(plain) != hash_of(fast)) return t;
  }
  return steps;
}

Object block(const std::string& name, const std::vector<std::string>& rows, int x, int y) {
  return {name, Body::from_rows(rows), x, y};
}

}  // namespace

TEST_CASE("stepping agrees with the plain simulator to the last bit") {
  SECTION("a robot on flat ground") {
    CHECK(steps_until_different(flat_world(Body::from_rows(body_a)), 60, 1) == 60);
  }
  SECTION("random robots, double points and thin limbs among them") {
    for (std::uint64_t i = 0; i < 12; ++i) {
      Stream random(7, "bodies", i);
      INFO("body " << i);
      CHECK(steps_until_different(flat_world(sample_body(5, 5, default_weights, random)), 25, i) ==
            25);
    }
  }
  SECTION("a long fall onto the ground, a package beside it") {
    World world{{fixed_ground(40), block("robot", {"HVH", "S.S"}, 3, 30),
                 block("package", {"SS", "SS"}, 9, 22)}};
    CHECK(steps_until_different(world, 60, 2) == 60);
  }
  SECTION("the world floor, without ground") {
    World world{{block("robot", {"HVH", "S.S"}, 3, 1)}};
    CHECK(steps_until_different(world, 40, 3) == 40);
  }
  SECTION("two robots in a heap of blocks") {
    World world{{fixed_ground(20), block("robot", {"HHH", "V.V"}, 3, 5),
                 block("second", {"VV", "HS"}, 4, 3), block("a", {"RR", "RR"}, 3, 1),
                 block("b", {"R"}, 5, 1), block("c", {"SS"}, 6, 1), block("peg", {"##"}, 8, 2)}};
    CHECK(steps_until_different(world, 60, 4) == 60);
  }
  SECTION("an object of fixed, soft and rigid cells") {
    World world{
        {block("bridge", {"#SSSR#", "#....#", "######"}, 0, 0), block("robot", {"HVH"}, 1, 4)}};
    CHECK(steps_until_different(world, 60, 5) == 60);
  }
  SECTION("limbs that touch the body they belong to") {
    World world = flat_world(Body::from_rows({"HVHVH", "V...V", "VHHVV", "V....", "VHHHV"}));
    CHECK(steps_until_different(world, 60, 6) == 60);
  }
  SECTION("benchmark worlds") {
    for (const char* name :
         {"Traverser-v0_A", "BridgeWalker-v0_A", "Climber-v1_B", "Catcher-v0_B"}) {
      INFO(name);
      CHECK(steps_until_different(read_reference(name).world, 4, 8) == 4);
    }
  }
}

TEST_CASE("stepping agrees with the plain simulator over whole episodes", "[.slow]") {
  for (const std::string& name : reference_names()) {
    INFO(name);
    CHECK(steps_until_different(read_reference(name).world, 200, 9) == 200);
  }
}

TEST_CASE("bits do not depend on width, neighbours or instruction set") {
  const IsaGuard guard;
  const Model walker(flat_world(Body::from_rows(body_a)), Physics{});
  const Model other(flat_world(Body::from_rows({"HH", "VV"})), Physics{});
  // Pinned: a change here is a change of results, to be explained.
  constexpr std::uint64_t pinned = 0xbee33ccc5aa515dd;
  for (const std::string& isa : available_isas()) {
    select_isa(isa);
    for (const std::size_t width : {1U, 2U, 3U, 4U, 5U, 8U, 11U}) {
      INFO(isa << ", " << width << " lanes");
      CHECK(hash_after(walker, 50, width) == pinned);
    }
    // Bodies mixed in one call.
    std::vector<State> states;
    for (int i = 0; i < 6; ++i) states.push_back(initial_state(i % 3 == 1 ? other : walker));
    std::vector<Lane> lanes;
    for (std::size_t i = 0; i < 6; ++i)
      lanes.push_back({i % 3 == 1 ? &other : &walker, &states[i]});
    std::vector<Stream> randoms(6, Stream(1, "targets"));
    for (int t = 0; t < 50; ++t) {
      for (std::size_t i = 0; i < 6; ++i) draw_targets(states[i], randoms[i]);
      step(lanes);
    }
    for (const std::size_t i : {0U, 2U, 3U, 5U}) CHECK(hash_of(states[i]) == pinned);
    CHECK(hash_of(states[1]) == hash_of(states[4]));
  }
}

TEST_CASE("lanes of equal objects in different places share registers and keep their bits") {
  const IsaGuard guard;
  std::vector<std::unique_ptr<Model>> models;
  for (int i = 0; i < 5; ++i) {
    World world = flat_world(Body::from_rows(body_a));
    world.objects.push_back(block("package", {"SS"}, 3 + i, 8));
    world.objects.push_back(block("peg", {"#"}, 12 - i, 2));
    models.push_back(std::make_unique<Model>(world, Physics{}));
  }
  std::vector<State> together;
  std::vector<Lane> lanes;
  for (const auto& model : models) together.push_back(initial_state(*model));
  for (std::size_t i = 0; i < models.size(); ++i) lanes.push_back({models[i].get(), &together[i]});
  std::vector<State> alone = together;
  for (int t = 0; t < 40; ++t) {
    step(lanes);
    for (std::size_t i = 0; i < models.size(); ++i) {
      Lane lane{models[i].get(), &alone[i]};
      step({&lane, 1});
      CHECK(hash_of(alone[i]) == hash_of(together[i]));
    }
  }
}

TEST_CASE("a copied state goes on with the same bits, with or without its contact lists") {
  const Model model(flat_world(Body::from_rows(body_a)), Physics{});
  State state = initial_state(model);
  Stream random(5, "targets");
  for (int t = 0; t < 20; ++t) {
    draw_targets(state, random);
    Lane lane{&model, &state};
    step({&lane, 1});
  }
  State copy = state;
  State restarted = state;
  for (int t = 0; t < 20; ++t) {
    draw_targets(state, random);
    copy.targets = restarted.targets = state.targets;
    restarted.restart_contacts();
    Lane first{&model, &state}, second{&model, &copy}, third{&model, &restarted};
    step({&first, 1});
    step({&second, 1});
    step({&third, 1});
  }
  CHECK(hash_of(copy) == hash_of(state));
  CHECK(hash_of(restarted) == hash_of(state));
}

TEST_CASE("a lane that folds stops alone, with the state of its folding substep") {
  const ReferenceCase reference = read_reference("extra/Walker-v0_fold0");
  const Model model(reference.world, Physics{});
  std::vector<State> states(4, initial_state(model));
  State plain = states[0];
  std::vector<Lane> lanes;
  for (State& state : states) lanes.push_back({&model, &state});
  for (int t = 0; t < reference.steps; ++t) {
    const auto action = reference.action(t);
    std::copy(action.begin(), action.end(), plain.targets.begin());
    states[2].targets = plain.targets;  // the others keep still
    step(lanes);
    const StepResult expected = plain_step(model, plain);
    CHECK(lanes[2].result == expected);
    CHECK(lanes[0].result == StepResult::done);
    CHECK(hash_of(states[2]) == hash_of(plain));
  }
  CHECK(lanes[2].result == StepResult::self_folding);
  CHECK(hash_of(states[0]) == hash_of(states[3]));
}

TEST_CASE("targets are clipped to the range of the physics") {
  const Model model(flat_world(Body::from_rows(body_a)), Physics{});
  State wild = initial_state(model);
  State tame = wild;
  std::fill(wild.targets.begin(), wild.targets.end(), 99.0);
  std::fill(tame.targets.begin(), tame.targets.end(), 1.6);
  Lane first{&model, &wild}, second{&model, &tame};
  step({&first, 1});
  step({&second, 1});
  CHECK(hash_of(wild) == hash_of(tame));
}

TEST_CASE("states that are not numbers are stepped without harm") {
  const Model model(flat_world(Body::from_rows(body_a)), Physics{});
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, 1e300, -1e300}) {
    std::vector<State> states(5, initial_state(model));
    states[1].x[3] = bad;
    states[2].vy[0] = bad;
    std::vector<Lane> lanes;
    for (State& state : states) {
      state.restart_contacts();
      lanes.push_back({&model, &state});
    }
    for (int t = 0; t < 3; ++t) step(lanes);
    CHECK(hash_of(states[0]) == hash_of(states[4]));
  }
}

TEST_CASE("threads step independently") {
  const Model model(flat_world(Body::from_rows(body_a)), Physics{});
  const std::uint64_t expected = hash_after(model, 20, 4);
  std::vector<std::uint64_t> found(3);
  std::vector<std::thread> threads;
  for (std::uint64_t& hash : found)
    threads.emplace_back([&model, &hash] { hash = hash_after(model, 20, 4); });
  for (std::thread& thread : threads) thread.join();
  for (const std::uint64_t hash : found) CHECK(hash == expected);
}

TEST_CASE("an unknown instruction set is refused") {
  CHECK_THROWS_WITH(select_isa("x86-64-v9"),
                    Catch::Contains("x86-64-v9") && Catch::Contains(best_isa()));
  CHECK(available_isas().back() == best_isa());
}

}  // namespace evo
