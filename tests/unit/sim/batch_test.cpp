// What a batch is: lanes that come, go and change, and keep their bits.
#include "libevo/sim/batch.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>
#include <thread>
#include <vector>

#include "libevo/base/parallel.h"
#include "libevo/body/operators.h"
#include "tests/unit/sim/fixtures.h"

namespace evo {
namespace {

std::shared_ptr<const Model> walking(Body body) {
  const World world{{fixed_ground(40), {"robot", std::move(body), 2, 1}}};
  return std::make_shared<const Model>(world, Physics{});
}

// Bodies of several shapes, some of them more than once.
std::vector<std::shared_ptr<const Model>> mixed_bodies(std::size_t count) {
  std::vector<std::shared_ptr<const Model>> models;
  for (std::size_t i = 0; i < count; ++i) {
    Stream random(3, "bodies", i % 4);
    models.push_back(walking(sample_body(4, 4, default_weights, random)));
  }
  return models;
}

// Each lane's targets follow from its number and its steps alone.
void draw(Batch& batch, std::size_t lane, int step, std::size_t as_lane) {
  Stream random(as_lane, "targets", static_cast<std::uint64_t>(step));
  draw_targets(batch.targets(lane), random);
}

// Steps `from` to `to` of all lanes, the first of them as lane `first` of so many.
void run(Batch& batch, int from, int to, std::size_t first = 0, std::size_t of = 1000) {
  for (int t = from; t < to; ++t) {
    for (std::size_t i = 0; i < batch.lanes(); ++i) draw(batch, i, t, (first + i) % of);
    batch.step();
  }
}

// States of one lane, stepped alone.
State alone(const std::shared_ptr<const Model>& model, std::size_t as_lane, int steps) {
  Batch batch(1);
  batch.place(0, model);
  run(batch, 0, steps, as_lane);
  return batch.state(0);
}

}  // namespace

TEST_CASE("a batch of mixed bodies equals each alone, for any threads", "[threads]") {
  constexpr std::size_t count = 14;
  constexpr int steps = 20;
  const auto models = mixed_bodies(count);
  std::vector<State> expected;
  for (std::size_t i = 0; i < count; ++i) expected.push_back(alone(models[i], i, steps));
  for (const int threads : {1, 2, 3, 8}) {
    ThreadPool pool(threads);
    Batch batch(count);
    for (std::size_t i = 0; i < count; ++i) batch.place(i, models[i]);
    std::vector<int> calls(count, 0);
    for (int t = 0; t < steps; ++t) {
      for (std::size_t i = 0; i < count; ++i) draw(batch, i, t, i);
      batch.step({}, &pool, [&](std::size_t lane) { ++calls[lane]; });
    }
    INFO(threads << " threads");
    for (std::size_t i = 0; i < count; ++i) {
      CHECK(batch.state(i) == expected[i]);
      CHECK(calls[i] == steps);
    }
  }
}

TEST_CASE("lanes stepped in any company keep their bits, others their state") {
  constexpr std::size_t count = 9;
  const auto models = mixed_bodies(count);
  Batch batch(count);
  for (std::size_t i = 0; i < count; ++i) batch.place(i, models[i]);
  std::vector<int> steps(count, 0);
  Stream random(11, "masks");
  for (int t = 0; t < 60; ++t) {
    std::vector<std::uint8_t> active(count);
    for (std::uint8_t& mark : active) mark = random.uniform() < 0.5 ? 1 : 0;
    if (t % 10 == 3) std::fill(active.begin(), active.end(), std::uint8_t{1});
    if (t % 10 == 6) active.assign(count, 0), active[static_cast<std::size_t>(t) % count] = 1;
    std::vector<State> before;
    for (std::size_t i = 0; i < count; ++i) {
      if (active[i] != 0) draw(batch, i, steps[i]++, i);
      before.push_back(batch.state(i));
    }
    batch.step(active);
    for (std::size_t i = 0; i < count; ++i)
      if (active[i] == 0) CHECK(batch.state(i) == before[i]);
  }
  for (std::size_t i = 0; i < count; ++i) CHECK(batch.state(i) == alone(models[i], i, steps[i]));
}

TEST_CASE("a lane takes another model, and its neighbours continue") {
  const auto models = mixed_bodies(4);
  Batch batch(6);
  for (std::size_t i = 0; i < 6; ++i) batch.place(i, models[0]);
  run(batch, 0, 10);
  batch.place(1, models[2]);
  batch.place(4, models[3]);
  for (int t = 0; t < 10; ++t) {
    for (std::size_t i = 0; i < 6; ++i) draw(batch, i, i == 1 || i == 4 ? t : 10 + t, i);
    batch.step();
  }
  for (const std::size_t i : {0U, 2U, 3U, 5U}) CHECK(batch.state(i) == alone(models[0], i, 20));
  CHECK(batch.state(1) == alone(models[2], 1, 10));
  CHECK(batch.state(4) == alone(models[3], 4, 10));
  CHECK(&batch.model(1) == models[2].get());
  // And back, into a group that has a gap.
  batch.place(1, models[0]);
  for (std::size_t i = 0; i < 6; ++i)
    if (i != 1) batch.place(i, models[0]);
  run(batch, 0, 10);
  for (std::size_t i = 0; i < 6; ++i) CHECK(batch.state(i) == alone(models[0], i, 10));
}

TEST_CASE("states can be saved, perturbed and restored") {
  const auto models = mixed_bodies(1);
  Batch batch(5);
  for (std::size_t i = 0; i < 5; ++i) batch.place(i, models[0]);
  run(batch, 0, 10);
  const State saved = batch.state(3);
  const auto go_on = [&] {
    run(batch, 10, 20);
    return batch.state(3);
  };
  const State went_on = go_on();
  // Far from where its contacts were found: they must be found anew by themselves.
  State moved = saved;
  for (Vec2& position : moved.positions) position.x += 0.35;
  moved.previous = moved.positions;
  batch.set_state(3, moved);
  CHECK(batch.state(3) == moved);
  Batch other(1);
  other.place(0, models[0]);
  other.set_state(0, moved);
  run(other, 10, 20, 3);
  CHECK(go_on() == other.state(0));
  CHECK_FALSE(batch.state(3) == went_on);

  batch.set_state(3, saved);
  CHECK(go_on() == went_on);
}

TEST_CASE("two batches live at the same time, each in a thread", "[threads]") {
  constexpr std::size_t count = 6;
  constexpr int steps = 20;
  const auto models = mixed_bodies(count);
  std::vector<State> expected;
  for (std::size_t i = 0; i < count; ++i) expected.push_back(alone(models[i], i, steps));
  Batch one(count);
  Batch other(count);
  for (std::size_t i = 0; i < count; ++i) {
    one.place(i, models[i]);
    other.place(i, models[(i + 1) % count]);
  }
  std::thread thread([&] { run(one, 0, steps, 0, count); });
  run(other, 0, steps, 1, count);
  thread.join();
  for (std::size_t i = 0; i < count; ++i) {
    CHECK(one.state(i) == expected[i]);
    CHECK(other.state(i) == expected[(i + 1) % count]);
  }
  // Or by turns in one thread, contact searches in between.
  for (std::size_t i = 0; i < count; ++i) {
    one.place(i, models[i]);
    other.place(i, models[(i + 1) % count]);
  }
  for (int t = 0; t < steps; ++t) {
    run(one, t, t + 1, 0, count);
    run(other, t, t + 1, 1, count);
  }
  for (std::size_t i = 0; i < count; ++i)
    CHECK(one.state(i) == other.state((i + count - 1) % count));
}

// ---- voxels of another length --------------------------------------------------------

namespace {

// The same physics with all lengths `scale` times as long.
Physics scaled(double scale) {
  Physics physics;
  physics.voxel_length *= scale;
  physics.gravity *= scale;
  physics.contact_margin *= scale;
  return physics;
}

Model heap(const Physics& physics) {
  return {{{fixed_ground(20),
            {"robot", Body::from_rows({"HVH", "S.S"}), 3, 4},
            {"package", Body::from_rows({"SR"}), 4, 2},
            {"peg", Body::from_rows({"#"}), 8, 1}}},
          physics};
}

State after(const Physics& physics, int steps) {
  const Model model = heap(physics);
  Batch batch(1);
  batch.place(0, model);
  Stream random(2, "targets");
  for (int t = 0; t < steps; ++t) {
    draw_targets(batch.targets(0), random);
    batch.step();
  }
  return batch.state(0);
}

}  // namespace

// Scaled by a power of two, every operation has the same mantissa.
TEST_CASE("voxels of another length move as they do at 0.1, to the last bit") {
  const State usual = after(Physics{}, 80);
  for (const double scale : {0.125, 8.0}) {
    INFO(scale);
    const State other = after(scaled(scale), 80);
    for (std::size_t p = 0; p < usual.positions.size(); ++p) {
      CHECK(other.positions[p] == usual.positions[p] * scale);
      CHECK(other.velocities[p].x == scale * usual.velocities[p].x);
    }
  }
}

TEST_CASE("robots of small and large voxels do not sink into the terrain") {
  for (const double voxel_length : {0.01, 0.1, 1.0}) {
    const State state = after(scaled(voxel_length / 0.1), 150);
    INFO(voxel_length);
    for (const Vec2& position : state.positions) CHECK(position.y > 0.9 * voxel_length);
  }
}

}  // namespace evo
