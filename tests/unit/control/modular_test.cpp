#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <deque>
#include <numbers>

#include "libevo/base/digest.h"
#include "libevo/base/error.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/modular_passes.h"
#include "libevo/control/trainer.h"
#include "tests/unit/control/arena.h"
#include "tests/unit/control/loss.h"

using namespace evo;
using namespace evo::test;

namespace {

std::vector<Body> three_bodies() {
  return {small_body(), body_a(), Body::from_rows({"VH", "SR", "H."})};
}

// Arenas that stay where they are.
struct Robots {
  std::deque<Arena> arenas;
  explicit Robots(const std::vector<Body>& bodies, int steps = 40) {
    for (const Body& body : bodies) arenas.emplace_back(walker(steps), body);
  }
  std::vector<const Arena*> all() const {
    std::vector<const Arena*> pointers;
    for (const Arena& arena : arenas) pointers.push_back(&arena);
    return pointers;
  }
};

TrainingSettings small_settings() {
  TrainingSettings settings;
  settings.algorithm = Algorithm::modular;
  settings.environments = 1;
  settings.rollout = 16;
  settings.minibatches = 3;
  settings.epochs = 2;
  settings.hidden = {12, 10, 8};
  settings.steps = 4 * 3 * 16;
  settings.time_limit = TimeLimit::bootstrap;
  settings.evaluation_interval = 2;
  settings.final_episodes = 0;
  return settings;
}

// A policy with moments and biases that are not those of the start.
ModularPolicy example_policy(Stream& stream) {
  TrainingSettings settings = small_settings();
  settings.clock = {20};
  settings.head_gain = 1.0;
  ModularPolicy policy = initial_modular_policy(settings, 2, 0.6, 1.6, Stream(3, "example"));
  for (Vector* bias : {&policy.actor.bias, &policy.critic.bias})
    for (float& b : *bias) b = static_cast<float>(0.1 * stream.gaussian());
  for (ModularNetwork* network : {&policy.actor, &policy.critic})
    for (Gate& gate : network->gates)
      for (Matrix* part : {&gate.scale, &gate.shift})
        for (Eigen::Index i = 0; i < part->size(); ++i)
          part->data()[i] = static_cast<float>(0.2 * stream.gaussian());
  policy.log_std[0] = -0.4F;
  policy.local.count = policy.task.count = 100.0;
  for (double& m : policy.local.mean) m = 0.1 * stream.gaussian();
  return policy;
}

std::vector<float> means_of(const ModularPolicy& policy, const Bodies& bodies,
                            const VoxelBatch& batch) {
  PreparedNetwork prepared;
  ModularPass pass;
  std::vector<float> means;
  prepare(policy.actor, bodies, prepared);
  forward_actor(policy, bodies, prepared, batch, pass, means);
  return means;
}

struct ModularSamples : Samples {
  VoxelBatch states;
};

ModularSamples plausible_batch(const ModularPolicy& policy, const Bodies& bodies, int samples,
                               Stream& stream) {
  ModularSamples batch;
  Eigen::Index rows = 0;
  for (int m = 0; m < samples; ++m) {
    batch.states.bodies.push_back(m % bodies.size());
    rows += bodies[m % bodies.size()].voxels();
  }
  const auto noise = [&](Matrix& matrix, Eigen::Index r, Eigen::Index c) {
    matrix.resize(r, c);
    for (Eigen::Index i = 0; i < matrix.size(); ++i)
      matrix.data()[i] = static_cast<float>(stream.gaussian());
  };
  noise(batch.states.local, rows, VoxelViews::local_length);
  noise(batch.states.task, samples, policy.actor.task.cols());
  const std::vector<float> means = means_of(policy, bodies, batch.states);
  PreparedNetwork prepared;
  ModularPass pass;
  Vector values;
  prepare(policy.critic, bodies, prepared);
  forward_critic(policy, bodies, prepared, batch.states, pass, values);
  const double deviation = std::exp(static_cast<double>(policy.log_std[0]));
  batch.resize(samples);
  std::size_t next = 0;
  for (Eigen::Index m = 0; m < samples; ++m) {
    double log_prob = 0.0;
    const int body = batch.states.bodies[static_cast<std::size_t>(m)];
    for (std::size_t j = 0; j < bodies[body].actuators().size(); ++j) {
      const double z = stream.gaussian();
      batch.actions.push_back(means[next++] + static_cast<float>(z * deviation));
      log_prob -= 0.5 * z * z + std::log(deviation * std::sqrt(2.0 * std::numbers::pi));
    }
    batch.log_probs[m] = static_cast<float>(log_prob + 0.1 * stream.gaussian());
    batch.values[m] = values[m] + static_cast<float>(0.15 * stream.gaussian());
    batch.advantages[m] = static_cast<float>(stream.gaussian());
    batch.returns[m] = batch.values[m] + static_cast<float>(0.3 * stream.gaussian());
  }
  return batch;
}

// ---- the network again, in double precision, one voxel at a time ----------------------

using Doubles = Eigen::VectorXd;

struct Plain {  // a network in double
  Eigen::MatrixXd local, task, fixed;
  Doubles bias;
  std::vector<std::pair<Eigen::MatrixXd, Doubles>> rest;
  std::vector<std::pair<Eigen::MatrixXd, Eigen::MatrixXd>> gates;
};

// Reads the parameters from p[at..) in the shape of `like`.
Plain plain(const ModularNetwork& like, const std::vector<double>& p, std::size_t& at) {
  const auto matrix = [&](Eigen::Index rows, Eigen::Index cols) {
    Eigen::MatrixXd m(rows, cols);
    for (Eigen::Index r = 0; r < rows; ++r)
      for (Eigen::Index c = 0; c < cols; ++c) m(r, c) = p[at++];
    return m;
  };
  Plain net;
  net.local = matrix(like.local.rows(), like.local.cols());
  net.task = matrix(like.task.rows(), like.task.cols());
  net.fixed = matrix(like.fixed.rows(), like.fixed.cols());
  net.bias = matrix(like.bias.size(), 1);
  for (const Layer& layer : like.rest.layers) {
    Eigen::MatrixXd weight = matrix(layer.weight.rows(), layer.weight.cols());
    net.rest.emplace_back(std::move(weight), matrix(layer.bias.size(), 1));
  }
  for (const Gate& gate : like.gates) {
    Eigen::MatrixXd scale = matrix(gate.scale.rows(), gate.scale.cols());
    net.gates.emplace_back(std::move(scale), matrix(gate.shift.rows(), gate.shift.cols()));
  }
  return net;
}

std::vector<Doubles> first_layer(const Plain& net, const VoxelViews& views, const Matrix& local,
                                 Eigen::Index from, const Doubles& task) {
  std::vector<Doubles> y;
  for (int v = 0; v < views.voxels(); ++v) {
    const Doubles l = local.row(from + v).transpose().cast<double>();
    const Doubles f = views.fixed().row(v).transpose().cast<double>();
    Doubles sum = net.local * l + net.task * task + net.bias;
    sum.array() *= 1.0 + (net.gates[0].first * f).array();
    y.emplace_back((sum + net.fixed * f).array().tanh());
  }
  return y;
}

double loss(const ModularPolicy& shape, const Bodies& bodies, const std::vector<double>& p,
            const ModularSamples& batch, const TrainingSettings& o) {
  std::size_t at = 0;
  const Plain actor = plain(shape.actor, p, at);
  const Plain critic = plain(shape.critic, p, at);
  const double log_std = p[at];
  const double deviation = std::exp(log_std);
  const auto n = static_cast<double>(batch.states.bodies.size());
  double total = 0.0;
  Eigen::Index from = 0;
  std::size_t action = 0;
  for (std::size_t m = 0; m < batch.states.bodies.size(); ++m) {
    const auto i = static_cast<Eigen::Index>(m);
    const VoxelViews& views = bodies[batch.states.bodies[m]];
    const Doubles task = batch.states.task.row(i).transpose().cast<double>();
    std::vector<Doubles> y = first_layer(actor, views, batch.states.local, from, task);
    for (std::size_t l = 0; l < actor.rest.size(); ++l) {
      std::vector<Doubles> next;
      for (int v = 0; v < views.voxels(); ++v) {
        const Doubles& own = y[static_cast<std::size_t>(v)];
        Doubles x = own;
        if (l + 1 < actor.rest.size()) {
          Doubles mean = Doubles::Zero(own.size());
          for (const Doubles& other : y) mean += other / static_cast<double>(y.size());
          x.resize(2 * own.size());
          x << own, mean;
        }
        Doubles z = actor.rest[l].first * x + actor.rest[l].second;
        if (l + 1 < actor.rest.size()) {
          const auto& [scale, shift] = actor.gates[l + 1];
          const Doubles f = views.fixed().row(v).transpose().cast<double>();
          z = z.array() * (1.0 + (scale * f).array()) + (shift * f).array();
        }
        next.push_back(l + 1 < actor.rest.size() ? Doubles(z.array().tanh()) : z);
      }
      y = next;
    }
    double log_prob = 0.0;
    double entropy = 0.0;
    for (const int v : views.actuators()) {
      const double z =
          (static_cast<double>(batch.actions[action++]) - y[static_cast<std::size_t>(v)][0]) /
          deviation;
      log_prob -= 0.5 * z * z + log_std + 0.5 * std::log(2.0 * std::numbers::pi);
      entropy += log_std + 0.5 * std::log(2.0 * std::numbers::pi * std::numbers::e);
    }
    Doubles pooled = Doubles::Zero(critic.bias.size());
    for (const Doubles& h : first_layer(critic, views, batch.states.local, from, task))
      pooled += h / static_cast<double>(views.voxels());
    for (std::size_t l = 0; l < critic.rest.size(); ++l) {
      const Doubles z = critic.rest[l].first * pooled + critic.rest[l].second;
      pooled = l + 1 < critic.rest.size() ? Doubles(z.array().tanh()) : z;
    }
    total += loss_of_sample(batch, i, log_prob, pooled[0], entropy, o) / n;
    from += views.voxels();
  }
  return total;
}

// What decides a training, as text.
std::string digest(const TrainResult& result) {
  std::string bytes;
  const auto& policy = std::get<ModularPolicy>(result.controller.value());
  for (const auto& block : parameter_blocks(policy))
    bytes.append(reinterpret_cast<const char*>(block.data()), block.size_bytes());
  bytes.append(reinterpret_cast<const char*>(policy.local.mean.data()),
               static_cast<std::size_t>(policy.local.mean.size()) * sizeof(double));
  return sha256_hex(bytes);
}

}  // namespace

TEST_CASE("a modular policy's gradients agree with finite differences in double precision") {
  Stream stream(7, "gradient");
  const Robots robots(three_bodies());
  const Bodies bodies(robots.all());
  const ModularPolicy policy = example_policy(stream);
  REQUIRE_FALSE(defect(policy));
  const ModularSamples batch = plausible_batch(policy, bodies, 20, stream);
  const TrainingSettings objective;
  ModularPasses passes(policy, robots.all(), 1, 1);
  passes.begin_turn(0, 1);
  passes.minibatch() = batch.states;
  Gaussians pi;
  const Losses losses = differentiate(passes, batch, objective, pi);

  std::vector<double> p;
  for (const auto& block : parameter_blocks(policy)) p.insert(p.end(), block.begin(), block.end());
  CHECK(losses.policy + 0.5 * losses.value - 0.01 * losses.entropy ==
        Approx(loss(policy, bodies, p, batch, objective)).epsilon(1e-5));
  CHECK(losses.clipfrac > 0.05);
  CHECK(losses.clipfrac < 0.95);

  std::vector<float> slopes;
  for (const auto& block : passes.slopes()) slopes.insert(slopes.end(), block.begin(), block.end());
  REQUIRE(slopes.size() == p.size());
  double largest = 0.0;
  for (const float slope : slopes)
    largest = std::max(largest, std::abs(static_cast<double>(slope)));
  constexpr double h = 1e-5;
  for (std::size_t i = 0; i < p.size(); i += i + 1 < p.size() && i + 7 >= p.size() ? 1 : 7) {
    const double value = p[i];
    p[i] = value + h;
    const double above = loss(policy, bodies, p, batch, objective);
    p[i] = value - h;
    const double below = loss(policy, bodies, p, batch, objective);
    p[i] = value;
    INFO("parameter " << i);
    CHECK(static_cast<double>(slopes[i]) ==
          Approx((above - below) / (2.0 * h)).epsilon(1e-3).margin(1e-4 * largest));
  }
}

TEST_CASE("a voxel's view says what the header says") {
  const Arena arena(walker(10), small_body());  // HHH over V.V
  const VoxelViews views(arena);
  REQUIRE(views.voxels() == 5);
  CHECK(views.actuators() == std::vector<int>{0, 1, 2, 3, 4});
  CHECK(views.task_length() == 2);  // velocity; the positions of points are the voxels' own

  const auto material = [](int cell, int kind) { return cell * 5 + kind; };
  const auto fixed = [&](int v, int i) { return views.fixed()(v, i); };
  CHECK(fixed(0, material(4, 2)) == 1.0F);  // itself: horizontal
  CHECK(fixed(0, material(7, 3)) == 1.0F);  // below: vertical
  CHECK(fixed(1, material(7, 3)) == 0.0F);  // below the middle: empty
  CHECK(fixed(0, 45) == -1.0F);             // a voxel left of the middle
  CHECK(fixed(0, 46) == 0.5F);              // half a voxel above it
  CHECK(fixed(0, 47 + 2) == Approx(0.6));   // 3 of 5 horizontal
  CHECK(fixed(0, 52) == Approx(0.2));       // 5 of 25 voxels

  VecEnv env(arena, 1);
  env.reset(0, {arena.draw(1, 0)});
  std::vector<double> local(5 * VoxelViews::local_length);
  std::vector<double> task(2);
  views.look(env, 0, local, task);
  CHECK(local[2] - local[0] == Approx(1.0));  // the top edge is a voxel long
  CHECK(local[1] - local[5] == Approx(1.0));
  for (int i = 8; i < 8 + 8 + 6; ++i)
    CHECK(local[static_cast<std::size_t>(i)] == Approx(0.0).margin(1e-9));  // at rest, unstretched
  const auto height = [&](int v, int k) {
    return local[static_cast<std::size_t>(v * VoxelViews::local_length + 22 + k)];
  };
  CHECK(height(0, 0) == Approx(1.0));               // nothing is that near
  CHECK(height(3, 0) == Approx(1.0));               // a voxel's height above the ground
  CHECK(height(3, 2) == Approx(0.0).margin(1e-9));  // it stands there
  double x = 0.0;
  const std::vector<double> targets(5, 1.4);
  for (int t = 0; t < 5; ++t) env.step(targets);
  views.look(env, 0, local, task);
  CHECK(height(3, 2) == Approx(0.0).margin(0.2));
  CHECK(height(3, 0) == Approx(1.0));  // it grew
  for (int i = 16; i < 20; ++i) x = std::max(x, local[static_cast<std::size_t>(i)]);
  CHECK(x > 0.05);  // it grew
  CHECK(task[0] == env.observations()[0]);
  CHECK(task[1] == env.observations()[1]);
}

TEST_CASE("a modular policy does the same wherever a body stands, empty cells around it or not") {
  Stream stream(8, "padded");
  const ModularPolicy policy = example_policy(stream);
  const auto targets_of = [&](const Body& body, int place) {
    TaskSpec task = walker(30);
    task.robot_x = place;
    const Arena arena(task, body);
    std::vector<double> targets;
    evaluate(arena, policy, {}, [&](const EpisodeMoment& moment) {
      targets.insert(targets.end(), moment.targets.begin(), moment.targets.end());
    });
    return targets;
  };
  const std::vector<double> targets = targets_of(small_body(), 1);
  REQUIRE(targets.size() == 30 * 5);
  CHECK(*std::min_element(targets.begin(), targets.end()) <
        *std::max_element(targets.begin(), targets.end()));
  CHECK(targets_of(Body::from_rows({"HHH..", "V.V.."}), 1) == targets);
  // Rows above and another place change the simulation's own rounding: only the first actions are
  // comparable.
  const auto raised = targets_of(Body::from_rows({".....", ".....", "..HHH", "..V.V"}), 1);
  for (const auto& [here, there] :
       {std::pair{targets, raised}, {targets_of(body_a(), 1), targets_of(body_a(), 6)}})
    for (std::size_t i = 0; i < here.size() / 30; ++i)
      CHECK(there[i] == Approx(here[i]).margin(1e-5));
}

TEST_CASE("a gate acts by what the voxel is and what is beside it") {
  Stream stream(11, "gates");
  const Robots robots(three_bodies());
  const Bodies bodies(robots.all());
  const auto actions = [&](const ModularPolicy& policy) {
    Stream samples(12, "samples");
    return means_of(policy, bodies, plausible_batch(policy, bodies, 6, samples).states);
  };
  ModularPolicy policy = example_policy(stream);
  const std::vector<float> untrained = actions(policy);
  // A voxel with a horizontal actuator left of it has other units; others act as they did.
  policy.actor.gates[2].scale.col(3 * 5 + 2).array() -= 1.0F;
  const std::vector<float> gated = actions(policy);
  std::size_t i = 0;
  for (int m = 0; m < 6; ++m) {
    const VoxelViews& views = bodies[m % bodies.size()];
    for (const int v : views.actuators()) {
      const bool beside = views.fixed()(v, 3 * 5 + 2) == 1.0F;
      CHECK((gated[i] != untrained[i]) == beside);
      ++i;
    }
  }
}

TEST_CASE("what a body does and learns does not depend on what is beside it") {
  Stream stream(10, "beside");
  const ModularPolicy policy = example_policy(stream);
  const Robots robots(three_bodies());
  EvaluationSettings settings{.episodes = 5, .jitter = 0.01, .lanes = 1};
  const Evaluation alone = evaluate(robots.arenas[1], policy, settings);
  settings.lanes = 5;
  CHECK(evaluate(robots.arenas[1], policy, settings).returns == alone.returns);
}

TEST_CASE("one modular policy for several robots learns, and to the same bytes") {
  const Robots robots(three_bodies());
  const auto run = [&] { return trained(robots.all(), small_settings(), 5, "shared"); };
  const TrainResult result = run();
  REQUIRE_FALSE(result.failure);
  CHECK(result.steps == 4 * 3 * 16);
  CHECK(result.curve.size() == 2);
  CHECK(digest(result) == digest(run()));
  // Pinned: the same on every processor.
  CHECK(digest(result) == "8ceb3e1fbb6a43c0914cf2abd03a50b492b7dfdd7b0b71f1e808e36a7ab63929");
  const auto& policy = std::get<ModularPolicy>(*result.controller);
  CHECK(policy.actor.gates[1].scale.norm() > 0.0F);
  // Of 17 states in each update of 16 steps up to the evaluation kept.
  const double voxels = 5 + count_voxels(body_a()) + 5;
  CHECK(policy.local.count == Approx(voxels * static_cast<double>(result.best_step) / 3 * 17 / 16));

  double mean = 0.0;
  for (const Arena& arena : robots.arenas)
    mean += evaluate(arena, policy, {.seed = 5}).mean() / 3.0;
  CHECK(mean == Approx(*result.fitness));
}

TEST_CASE("every robot has the settings' environments, alone or beside others") {
  TrainingSettings settings = small_settings();
  settings.environments = 4;
  settings.steps = 3 * 4 * 16;
  const Robots robots(three_bodies());
  Trainer alone(robots.arenas[0], settings, 1, "a");
  CHECK(alone.advance().step == 4 * 16);
  Trainer three(robots.all(), settings, 1, "shared");
  CHECK(three.advance().step == 3 * 4 * 16);
}

TEST_CASE("robots take turns where an update learns from some of them") {
  TrainingSettings settings = small_settings();
  settings.robots_per_update = 2;
  settings.steps = 3 * 16 * 6;
  const Robots robots(three_bodies());
  const auto run = [&](int interrupted) {
    Trainer first(robots.all(), settings, 1, "shared");
    std::vector<std::int64_t> steps;
    for (int i = 0; i < interrupted; ++i) steps.push_back(first.advance().step);
    Trainer second(robots.all(), settings, 1, "shared");
    second.restore(first.checkpoint());
    while (!second.done()) steps.push_back(second.advance().step);
    return std::pair{digest(second.result()), steps};
  };
  const auto [bytes, steps] = run(3);
  // One robot, then two, and so on: 16 steps of each.
  REQUIRE(steps.size() == 12);
  for (std::size_t u = 0; u < steps.size(); ++u)
    CHECK(steps[u] == static_cast<std::int64_t>(u / 2 * 48 + (u % 2 == 0 ? 16 : 48)));
  CHECK(run(4).first == bytes);

  // The robot that is alone in its turn has 16 samples.
  settings.minibatches = 17;
  CHECK_THROWS_AS(Trainer(robots.all(), settings, 1, "shared"), Error);
  settings.minibatches = 16;
  CHECK_NOTHROW(Trainer(robots.all(), settings, 1, "shared"));
}

TEST_CASE("a child of another body starts with its parent's controller as it is") {
  const Robots robots(three_bodies());
  const TrainResult learned = trained(robots.arenas[0], small_settings(), 5, "parent");
  Trainer child(robots.arenas[1], small_settings(), 5, "child",
                heritage(robots.arenas[0], learned));
  child.advance();
  // Its deviation differs, which the deterministic controller does not see.
  CHECK(child.result().curve.front().evaluation ==
        evaluate(robots.arenas[1], *learned.controller, {.seed = 5}).mean());
}

TEST_CASE("what a modular policy cannot do is said in one line") {
  const Robots robots(three_bodies());
  const TrainingSettings settings = small_settings();
  TrainingSettings ppo;
  ppo.steps = 4096;
  const TrainResult learned = trained(robots.arenas[0], settings, 5, "parent");
  const Inheritance modular{*learned.controller, {}};
  CHECK_THROWS_WITH(Trainer({robots.all()[0], robots.all()[1]}, ppo, 1, "x"),
                    "training: ppo makes a controller for each robot; modular makes one "
                    "for all");
  CHECK_THROWS_WITH(Trainer(robots.arenas[0], ppo, 1, "x", modular),
                    "training: ppo cannot start from a modular policy; modular can");
  CHECK_THROWS_WITH(Trainer(robots.arenas[0], settings, 1, "x",
                            Inheritance{travelling_wave(5, 0.5, 20, 0.5), {}}),
                    "training: modular can start from a modular policy only");
  TrainingSettings wider = settings;
  wider.hidden = {16, 16};
  CHECK_THROWS_WITH(Trainer(robots.arenas[0], wider, 1, "x", modular),
                    "the controller to start from has other hidden layers than the settings ask "
                    "for");
  TaskSpec other = walker(20);
  other.observation.push_back(observation::Orientation{robot_name});
  const Arena turned(other, small_body());
  CHECK_THROWS_WITH(evaluate(turned, *learned.controller, {}),
                    "the controller sees 2 numbers of its task, Walker-test shows 3: it was "
                    "trained on another task");
  TrainingSettings moments = settings;
  moments.moment_share = 0.5;
  CHECK_THROWS_WITH(check(moments),
                    "training: moment_share is 0.5; modular has no moments to start from");
}

TEST_CASE("a modular policy learns to walk on several bodies at once", "[.slow]") {
  const Robots robots(three_bodies(), 200);
  TrainingSettings settings = small_settings();
  settings.environments = 4;
  settings.rollout = 64;
  settings.minibatches = 24;
  settings.epochs = 4;
  settings.hidden = {32, 32};
  settings.lambda = 0.9;
  settings.clip = 0.2;
  settings.clip_value_loss = false;
  settings.entropy_coefficient = 0.0;
  settings.learning_rate = 1e-3;
  settings.learning_rate_horizon = 0;
  settings.head_gain = 0.01;
  settings.initial_log_std = -0.5;
  settings.steps = 150'000;
  settings.evaluation_interval = 20;
  const TrainResult result = trained(robots.all(), settings, 1, "shared");
  CHECK(*result.fitness > 0.5);  // voxels in 200 steps, in the mean; at rest 0
}
