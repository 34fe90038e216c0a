// Gradients through control steps against central differences.
#include "libevo/sim/adjoint.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "libevo/base/error.h"
#include "libevo/sim/step_record.h"
#include "tests/unit/sim/fixtures.h"

namespace evo {
namespace {

constexpr int lanes = 8;

std::vector<std::string> quadruped() { return {"HVHVH", "VHVHV", "HHSHH", "V.R.V", "H.H.H"}; }

World flat(std::vector<std::string> rows) {
  return {{fixed_ground(20), {"robot", Body::from_rows(rows), 3, 1}}};
}

struct Case {
  const char* name;
  World world;
  double fall = 0.0;    // raw velocity at the start, downwards
  double eps = 1e-4;    // of differences, times what stands in direction()
  double worst = 1e-8;  // median of relative errors
};

std::vector<Case> cases() {
  Body bridge = Body::from_rows({"#SSS#"});
  return {
      {"walker", flat(quadruped()), 0.0},
      {"rigid robot that lands hard", flat({"RRR", "HRV", "R.R"}), 6.0},
      {"on the world's floor", {{{"robot", Body::from_rows({"HV", "RS"}), 2, 0}}}, 3.0, 1e-6, 1e-6},
      {"box on top",
       {{fixed_ground(20),
         {"robot", Body::from_rows({"HVHV", "V..H"}), 3, 1},
         {"box", Body::from_rows({"SS", "RR"}), 4, 3}}},
       0.0},
      {"bridge",
       {{{"robot", Body::from_rows({"HVH", "V.V"}), 2, 3}, {"soft bridge", bridge, 1, 2}}},
       1.0},
      {"wall",
       {{fixed_ground(20),
         {"robot", Body::from_rows({"HVV", "H.V"}), 3, 1},
         {"wall", Body::from_rows({"#", "#", "#"}), 6, 1}}},
       0.0},
      {"arms that touch each other", flat({"HHHHH", "H...H", "HV.VH"}), 0.0}};
}

std::vector<double*> values_of(State& state) {
  std::vector<double*> values;
  for (auto* points : {&state.positions, &state.velocities, &state.previous})
    for (Vec2& point : *points) values.insert(values.end(), {&point.x, &point.y});
  for (double& target : state.targets) values.push_back(&target);
  return values;
}

double dot(State a, State b) {
  const auto x = values_of(a);
  const auto y = values_of(b);
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += *x[i] * *y[i];
  return sum;
}

State plus(State a, double share, State b) {
  const auto x = values_of(a);
  const auto y = values_of(b);
  for (std::size_t i = 0; i < x.size(); ++i) *x[i] += share * *y[i];
  return a;
}

// Eight copies of a world on ways of their own, after some steps.
struct Flock {
  Flock(const Case& of, int steps) : model(of.world, Physics{}), batch(lanes) {
    for (std::size_t i = 0; i < lanes; ++i) {
      batch.place(i, model);
      State state = batch.state(i);
      Stream random(7, "flock", i);
      for (std::size_t p = 0; p < state.positions.size(); ++p) {
        if (model.compiled().dynamics.fixed[p] != 0) continue;
        state.positions[p] += {1e-3 * random.gaussian(), 1e-3 * random.gaussian()};
        state.velocities[p].y = -of.fall;
      }
      state.previous = state.positions;
      batch.set_state(i, state);
    }
    for (int t = 0; t < steps; ++t) {
      for (std::size_t i = 0; i < lanes; ++i) {
        Stream random(i, "targets", static_cast<std::uint64_t>(t / 4));
        draw_targets(batch.targets(i), random);
      }
      batch.step();
    }
    for (std::size_t i = 0; i < lanes; ++i) before.push_back(batch.state(i));
  }

  // Which touches each substep had, lane by lane.
  static std::vector<std::vector<int>> contacts(Tape& tape) {
    std::vector<std::vector<int>> all(lanes);
    for (const StepRecord& record : tape.impl().records)
      for (std::size_t k = 0; k < record.substeps(); ++k) {
        const std::size_t last =
            k + 1 < record.substeps() ? record.first_touch[k + 1] : record.touches.size();
        for (std::size_t t = record.first_touch[k]; t < last; ++t) {
          const Touch& touch = record.touches[t];
          auto& of_lane = all[record.members[touch.lane].lane];
          of_lane.insert(of_lane.end(), {static_cast<int>(k), touch.point, touch.edge[0]});
        }
      }
    return all;
  }

  std::vector<State> step(const std::vector<State>& from, Tape& tape) {
    for (std::size_t i = 0; i < lanes; ++i) batch.set_state(i, from[i]);
    batch.step({}, nullptr, {}, &tape);
    std::vector<State> after;
    for (std::size_t i = 0; i < lanes; ++i) after.push_back(batch.state(i));
    return after;
  }

  Model model;
  Batch batch;
  std::vector<State> before;
};

enum Kind { positions, velocities, targets };

// A direction in which the points that are not fixed may be moved.
State direction(const Model& model, State like, Kind kind, Stream& random) {
  for (double* value : values_of(like)) *value = 0.0;
  const std::vector<std::uint8_t>& fixed = model.compiled().dynamics.fixed;
  const auto fill = [&](std::vector<Vec2>& points, double size) {
    for (const auto axis : {&Vec2::x, &Vec2::y})
      for (std::size_t p = 0; p < points.size(); ++p)
        points[p].*axis = fixed[p] != 0 ? 0.0 : size * random.gaussian();
  };
  if (kind == velocities) {
    fill(like.velocities, 1.0);
  } else if (kind == positions) {
    fill(like.positions, 1e-3);
    fill(like.previous, 1e-3);
    for (std::size_t p = 0; p < fixed.size(); ++p)  // friction knows the difference alone
      like.previous[p] = like.positions[p] + like.previous[p] * 1e-3;
  } else {
    for (double& value : like.targets) value = 0.1 * random.gaussian();
  }
  return like;
}

struct Errors {
  std::vector<double> relative;
  int excluded = 0;  // contacts changed between the two sides
  std::size_t touches = 0;
  double median() {
    std::sort(relative.begin(), relative.end());
    return relative[relative.size() / 2];
  }
};

// Derivatives of one control step from where `flock` is.
void compare(Flock& flock, double eps, Errors& errors) {
  Tape tape(0.0);
  Tape lower(0.0);
  Tape upper(0.0);
  flock.step(flock.before, tape);
  const auto touched = Flock::contacts(tape);
  Stream random(9, "directions");
  std::vector<Gradient> weights;
  for (std::size_t i = 0; i < lanes; ++i) {
    Gradient weight = zero_gradient(flock.model);
    for (auto* points : {&weight.state.positions, &weight.state.previous, &weight.state.velocities})
      for (const auto axis : {&Vec2::x, &Vec2::y})
        for (Vec2& point : *points) point.*axis = random.gaussian();
    for (Vec2& velocity : weight.state.velocities) velocity = velocity * 1e-3;
    weights.push_back(weight);
    errors.touches += touched[i].size();
  }
  std::vector<Gradient> gradients = weights;
  tape.pull_back(gradients);
  for (const Kind kind : {positions, velocities, targets}) {
    std::vector<State> ways, low, high;
    for (std::size_t i = 0; i < lanes; ++i) {
      ways.push_back(direction(flock.model, flock.before[i], kind, random));
      low.push_back(plus(flock.before[i], -eps, ways[i]));
      high.push_back(plus(flock.before[i], eps, ways[i]));
    }
    const std::vector<State> after_low = flock.step(low, lower);
    const std::vector<State> after_high = flock.step(high, upper);
    const auto low_touched = Flock::contacts(lower);
    const auto high_touched = Flock::contacts(upper);
    for (std::size_t i = 0; i < lanes; ++i) {
      if (flock.batch.status(i) != LaneStatus::done) continue;
      if (low_touched[i] != touched[i] || high_touched[i] != touched[i]) {
        ++errors.excluded;
        continue;
      }
      State weight = weights[i].state;
      const double difference =
          (dot(after_high[i], weight) - dot(after_low[i], weight)) / (2.0 * eps);
      const double exact = dot(gradients[i].state, ways[i]);
      errors.relative.push_back(std::abs(difference - exact) / std::max(std::abs(exact), 1e-9));
    }
  }
}

}  // namespace

// Relative errors of central differences are about 1e-9 here. On the world's floor, friction
// turns from one side to the other within a velocity of 0.005, so that differences have to be
// smaller.
TEST_CASE("gradients through a control step are central differences") {
  for (const Case& of : cases()) {
    INFO(of.name);
    Errors errors;
    for (const int steps : {0, 1, 6, 20, 45}) {
      Flock flock(of, steps);
      compare(flock, of.eps, errors);
    }
    CHECK(errors.relative.size() >= 110);  // of 120
    CHECK(errors.median() < of.worst);
    CHECK(errors.relative[errors.relative.size() * 8 / 10] < 100.0 * of.worst);
    CHECK((errors.touches > 500 || of.fall == 3.0));
  }
}

TEST_CASE("gradients by stiffness are central differences over other bodies") {
  const std::vector<std::string> rows{"HRV", "S.H"};
  const auto step = [&](std::size_t cell, double change, Tape& tape) {
    std::vector<double> factors{1.2, 0.7, 1.0, 1.5, 1.0, 0.8};
    factors[cell] += change;
    World world = flat(rows);
    world.objects[1].body = with_stiffness(world.objects[1].body, factors);
    auto model = std::make_shared<const Model>(world, Physics{});
    Batch batch(1);
    batch.place(0, model);
    State state = batch.state(0);
    Stream random(5, "stretched");
    for (Vec2& position : state.positions) position.x += 3e-3 * random.gaussian();
    state.previous = state.positions;
    batch.set_state(0, state);
    draw_targets(batch.targets(0), random);
    batch.step({}, nullptr, {}, &tape);
    double sum = 0.0;
    const State after = batch.state(0);
    for (const Vec2& velocity : after.velocities) sum += velocity.x * random.gaussian();
    return std::pair(sum, model);
  };
  Tape tape(0.0);
  Tape other(0.0);
  const auto model = step(0, 0.0, tape).second;
  std::vector<Gradient> gradient{zero_gradient(*model, {.stiffness = true})};
  Stream random(5, "stretched");
  for (std::size_t i = 0; i < gradient[0].state.positions.size(); ++i) random.gaussian();
  for (std::size_t i = 0; i < gradient[0].state.targets.size(); ++i) random.uniform();
  for (Vec2& velocity : gradient[0].state.velocities) velocity.x = random.gaussian();
  tape.pull_back(gradient);
  REQUIRE(model->cells()[2].type == Voxel::vertical);
  for (const auto& [cell, place] : {std::pair{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 5}}) {
    const auto at = static_cast<std::size_t>(place);
    const double eps = 1e-5;
    const double difference =
        (step(at, eps, other).first - step(at, -eps, other).first) / (2.0 * eps);
    CHECK(gradient[0].stiffness[static_cast<std::size_t>(cell)] ==
          Approx(difference).epsilon(1e-5));
  }
}

TEST_CASE("gradients by constants of the physics are central differences over other physics") {
  const World world = flat(quadruped());
  Stream random(7, "constants");
  Batch warm(1);
  warm.place(0, std::make_shared<const Model>(world, Physics{}));
  for (int t = 0; t < 30; ++t) {
    draw_targets(warm.targets(0), random);
    warm.step();
  }
  const State start = warm.state(0);
  std::vector<Vec2> share;
  for (std::size_t i = 0; i < start.velocities.size(); ++i) {
    const double of_both = random.gaussian();
    share.push_back({of_both, of_both});
  }
  std::vector<Tape> tapes;
  for (int t = 0; t < 4; ++t) tapes.emplace_back(0.0);
  const auto run_with = [&](const Physics& physics) {
    auto model = std::make_shared<const Model>(world, physics);
    Batch batch(1);
    batch.place(0, model);
    batch.set_state(0, start);
    for (Tape& tape : tapes) batch.step({}, nullptr, {}, &tape);
    const State after = batch.state(0);
    double sum = 0.0;
    for (std::size_t i = 0; i < share.size(); ++i) sum += dot(share[i], after.velocities[i]);
    return std::pair(sum, model);
  };
  std::vector<Gradient> gradient{zero_gradient(*run_with({}).second, {.constants = true})};
  gradient[0].state.velocities = share;
  for (auto tape = tapes.rbegin(); tape != tapes.rend(); ++tape) tape->pull_back(gradient);
  const std::pair<GradientConstant, double Physics::*> constants[] = {
      {GradientConstant::gravity, &Physics::gravity},
      {GradientConstant::drag, &Physics::drag},
      {GradientConstant::contact_stiffness, &Physics::contact_stiffness},
      {GradientConstant::contact_damping, &Physics::contact_damping},
      {GradientConstant::friction_multiplier, &Physics::friction_multiplier}};
  for (const auto& [which, member] : constants) {
    Physics more, less;
    const double eps = 1e-5 * (more.*member);
    more.*member += eps;
    less.*member -= eps;
    const double difference =
        (run_with(more).first - run_with(less).first) / (more.*member - less.*member);
    CAPTURE(static_cast<int>(which));
    CHECK(difference != 0.0);
    CHECK(gradient[0].constants[static_cast<std::size_t>(which)] ==
          Approx(difference).epsilon(1e-3));
  }
}

namespace {

// How far the robot is after some steps with these targets, and its derivative by them.
struct Run {
  double x = 0.0;
  std::vector<double> by_targets;
};

std::vector<Run> run(Flock& flock, const std::vector<std::vector<double>>& targets,
                     std::vector<Tape>& tapes) {
  for (std::size_t i = 0; i < lanes; ++i) flock.batch.set_state(i, flock.before[0]);
  for (Tape& tape : tapes) {
    for (std::size_t i = 0; i < lanes; ++i)
      std::copy(targets[i].begin(), targets[i].end(), flock.batch.targets(i).begin());
    flock.batch.step({}, nullptr, {}, &tape);
  }
  std::vector<Run> runs(lanes);
  std::vector<Gradient> gradients(lanes, zero_gradient(flock.model));
  const auto points = static_cast<std::size_t>(flock.model.objects()[0].points);
  for (std::size_t i = 0; i < lanes; ++i) {
    const State state = flock.batch.state(i);
    for (std::size_t p = 0; p < points; ++p) {
      runs[i].x += state.positions[p].x / static_cast<double>(points);
      gradients[i].state.positions[p].x = 1.0 / static_cast<double>(points);
    }
  }
  for (auto tape = tapes.rbegin(); tape != tapes.rend(); ++tape) tape->pull_back(gradients);
  for (std::size_t i = 0; i < lanes; ++i) runs[i].by_targets = gradients[i].state.targets;
  return runs;
}

double cosine(const std::vector<double>& a, const std::vector<double>& b) {
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += a[i] * b[i];
    aa += a[i] * a[i];
    bb += b[i] * b[i];
  }
  return ab / std::sqrt(aa * bb);
}

}  // namespace

// Antithetic random differences know of every jump.
TEST_CASE("gradients with a smoothed onset point where random differences do") {
  Flock flock(cases()[0], 45);
  const std::size_t actuators = flock.before[0].targets.size();
  constexpr int pairs = 256;
  constexpr double sigma = 0.1;
  double cosines[2] = {};
  for (const bool is_smoothed : {false, true}) {
    std::vector<Tape> tapes;
    for (int t = 0; t < 16; ++t) tapes.emplace_back(is_smoothed ? usual_onset : 0.0);
    Stream random(11, "differences");
    std::vector<double> middle(actuators);
    for (double& value : middle) value = 0.9 + 0.4 * random.uniform();
    std::vector<double> by_differences(actuators), by_gradient(actuators);
    for (int pair = 0; pair < pairs; pair += lanes / 2) {
      std::vector<std::vector<double>> ways(lanes), targets(lanes, middle);
      for (std::size_t i = 0; i < lanes; ++i) {
        ways[i] = i % 2 == 0 ? std::vector<double>(actuators) : ways[i - 1];
        for (std::size_t a = 0; a < actuators; ++a) {
          if (i % 2 == 0) ways[i][a] = random.gaussian();
          targets[i][a] += (i % 2 == 0 ? sigma : -sigma) * ways[i][a];
        }
      }
      const std::vector<Run> runs = run(flock, targets, tapes);
      for (std::size_t i = 0; i < lanes; ++i)
        for (std::size_t a = 0; a < actuators; ++a) {
          by_differences[a] += (i % 2 == 0 ? runs[i].x : -runs[i].x) * ways[i][a];
          by_gradient[a] += runs[i].by_targets[a];
        }
    }
    cosines[is_smoothed ? 1 : 0] = cosine(by_differences, by_gradient);
  }

  CHECK(cosines[0] < 0.75);
  CHECK(cosines[1] > 0.8);
}

TEST_CASE("a tape changes no bits, and gradients have the same bits in any company") {
  std::vector<std::vector<double>> seen;
  for_each_isa([&] {
    for (const std::size_t count : {std::size_t{1}, std::size_t{lanes}}) {
      const Model model(cases()[0].world, Physics{});
      Batch batch(count);
      Batch plain(count);
      std::vector<Tape> tapes(6);
      for (std::size_t i = 0; i < count; ++i) {
        batch.place(i, model);
        plain.place(i, model);
      }
      for (Tape& tape : tapes) {
        for (std::size_t i = 0; i < count; ++i) {
          Stream random(i, "targets");
          draw_targets(batch.targets(i), random);
          std::copy_n(batch.targets(i).begin(), batch.targets(i).size(), plain.targets(i).begin());
        }
        batch.step({}, nullptr, {}, &tape);
        plain.step();
      }
      CHECK(hash_of(batch.state(0)) == hash_of(plain.state(0)));
      std::vector<Gradient> gradients(count,
                                      zero_gradient(model, {.stiffness = true, .constants = true}));
      for (Gradient& gradient : gradients)
        for (Vec2& position : gradient.state.positions) position.x = 1.0;
      for (auto tape = tapes.rbegin(); tape != tapes.rend(); ++tape) tape->pull_back(gradients);
      seen.push_back(gradients[0].stiffness);
      seen.back().insert(seen.back().end(), gradients[0].constants.begin(),
                         gradients[0].constants.end());
      for (const double* value : values_of(gradients[0].state)) seen.back().push_back(*value);
      CHECK(seen.back() == seen.front());
    }
  });
}

TEST_CASE("nothing is pulled back through a step that folds") {
  const Model model(flat({"HHH", "H.H", "H.H"}), Physics{});
  Batch batch(1);
  batch.place(0, model);
  State state = batch.state(0);
  for (Vec2& position : state.positions) position.y = 0.1 + 0.01 * position.y;
  state.previous = state.positions;
  batch.set_state(0, state);
  Tape tape;
  batch.step({}, nullptr, {}, &tape);
  REQUIRE(batch.status(0) != LaneStatus::done);
  std::vector<Gradient> gradients{zero_gradient(model)};
  for (Vec2& position : gradients[0].state.positions) position.x = 1.0;
  tape.pull_back(gradients);
  CHECK(gradients[0].state == zero_gradient(model).state);
}

TEST_CASE("onsets too wide are refused") {
  CHECK_THROWS_AS(Tape(0.2), Error);
  CHECK_THROWS_AS(Tape(-0.1), Error);
}

}  // namespace evo
