#include "libevo/control/ppo.h"

#include "libevo/control/policy_passes.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "tests/unit/control/loss.h"

// Blocks asked of the allocator so far, by whatever way: Eigen does not ask operator new.
// Sanitizers have an allocator of their own; there it stays 0.
static std::atomic<long> allocations{0};
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool counts_allocations = false;
#else
constexpr bool counts_allocations = true;
extern "C" void* __libc_malloc(std::size_t size);  // NOLINT(bugprone-reserved-identifier)
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
#endif

using namespace evo;
using namespace evo::test;

namespace {

Policy small_policy(int inputs, int actions, Stream& stream) {
  Policy policy;
  policy.actor = orthogonal_network(inputs, {16, 12}, actions, std::sqrt(2.0), 1.0, stream);
  policy.critic = orthogonal_network(inputs, {16, 12}, 1, std::sqrt(2.0), 1.0, stream);
  policy.log_std = Vector::Zero(actions);
  for (float& l : policy.log_std) l = static_cast<float>(0.3 * stream.gaussian());
  for (Network* network : {&policy.actor, &policy.critic})
    for (Layer& layer : network->layers)
      for (float& b : layer.bias) b = static_cast<float>(0.1 * stream.gaussian());
  return policy;
}

// ---- the loss again, in double precision, straight from the formulas ---------------

using Parameters = std::vector<double>;  // in the order of ParameterBlocks

Parameters to_double(const Policy& policy) {
  Parameters all;
  const ParameterBlocks blocks(policy);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    all.insert(all.end(), blocks[b].begin(), blocks[b].end());
  return all;
}

// Network of the shape of `like`, its parameters read from p[at..).
Eigen::VectorXd network_output(const Network& like, const Parameters& p, std::size_t& at,
                               Eigen::VectorXd x) {
  for (std::size_t l = 0; l < like.layers.size(); ++l) {
    const Eigen::Index out = like.layers[l].weight.rows();
    Eigen::VectorXd y(out);
    const std::size_t bias = at + static_cast<std::size_t>(like.layers[l].weight.size());
    for (Eigen::Index o = 0; o < out; ++o) {
      y[o] = p[bias + static_cast<std::size_t>(o)];
      for (Eigen::Index i = 0; i < x.size(); ++i)
        y[o] += p[at + static_cast<std::size_t>(o * x.size() + i)] * x[i];
    }
    at = bias + static_cast<std::size_t>(out);
    x = l + 1 < like.layers.size() ? Eigen::VectorXd(y.array().tanh()) : y;
  }
  return x;
}

struct StatedSamples : Samples {
  Matrix states;
};

double loss(const Policy& shape, const Parameters& p, const StatedSamples& batch,
            const TrainingSettings& o) {
  double total = 0.0;
  const auto m = static_cast<double>(batch.states.rows());
  for (Eigen::Index i = 0; i < batch.states.rows(); ++i) {
    const Eigen::VectorXd s = batch.states.row(i).transpose().cast<double>();
    std::size_t at = 0;
    const Eigen::VectorXd mu = network_output(shape.actor, p, at, s);
    const double v = network_output(shape.critic, p, at, s)[0];
    double log_prob = 0.0;
    double entropy = 0.0;
    for (Eigen::Index j = 0; j < mu.size(); ++j) {
      const double log_std = p[at + static_cast<std::size_t>(j)];
      const double z =
          (static_cast<double>(batch.actions[static_cast<std::size_t>(i * mu.size() + j)]) -
           mu[j]) /
          std::exp(log_std);
      log_prob -= 0.5 * z * z + log_std + 0.5 * std::log(2.0 * std::numbers::pi);
      entropy += log_std + 0.5 * std::log(2.0 * std::numbers::pi * std::numbers::e);
    }
    total += loss_of_sample(batch, i, log_prob, v, entropy, o) / m;
  }
  return total;
}

// A batch as a slightly older policy would have left it: some ratios and values
// inside the clipping range, some out of it.
StatedSamples plausible_batch(const Policy& policy, int samples, Stream& stream) {
  StatedSamples batch;
  const Eigen::Index inputs = policy.observation_length();
  const Eigen::Index actions = policy.action_length();
  batch.states.resize(samples, inputs);
  for (Eigen::Index i = 0; i < batch.states.size(); ++i)
    batch.states.data()[i] = static_cast<float>(stream.gaussian());
  Activations mean;
  Activations value;
  forward(policy.actor, batch.states, mean);
  forward(policy.critic, batch.states, value);
  batch.resize(samples);
  for (Eigen::Index i = 0; i < samples; ++i) {
    double log_prob = 0.0;
    for (Eigen::Index j = 0; j < actions; ++j) {
      const double z = stream.gaussian();
      const double log_std = static_cast<double>(policy.log_std[j]);
      batch.actions.push_back(
          static_cast<float>(static_cast<double>(mean.back()(i, j)) + z * std::exp(log_std)));
      log_prob -= 0.5 * z * z + log_std + 0.5 * std::log(2.0 * std::numbers::pi);
    }
    batch.log_probs[i] = static_cast<float>(log_prob + 0.1 * stream.gaussian());
    batch.values[i] = value.back()(i, 0) + static_cast<float>(0.15 * stream.gaussian());
    batch.advantages[i] = static_cast<float>(stream.gaussian());
    batch.returns[i] = batch.values[i] + static_cast<float>(0.3 * stream.gaussian());
  }
  return batch;
}

}  // namespace

TEST_CASE("gradients agree with finite differences of the loss in double precision") {
  Stream stream(7, "gradient");
  const Policy policy = small_policy(9, 4, stream);
  const StatedSamples batch = plausible_batch(policy, 40, stream);
  TrainingSettings objective;
  objective.clip_value_loss = GENERATE(true, false);
  PolicyPasses passes(policy, 1);
  passes.minibatch() = batch.states;
  Gaussians pi;
  const Losses losses = differentiate(passes, batch, objective, pi);

  Parameters p = to_double(policy);
  CHECK(losses.policy + 0.5 * losses.value - 0.01 * losses.entropy ==
        Approx(loss(policy, p, batch, objective)).epsilon(1e-5));
  CHECK(losses.clipfrac > 0.1);
  CHECK(losses.clipfrac < 0.9);

  std::vector<float> analytic;
  const auto blocks = passes.slopes();
  for (std::size_t b = 0; b < blocks.size(); ++b)
    analytic.insert(analytic.end(), blocks[b].begin(), blocks[b].end());
  REQUIRE(analytic.size() == p.size());
  constexpr double h = 1e-5;
  double worst = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double here = p[i];
    p[i] = here + h;
    const double up = loss(policy, p, batch, objective);
    p[i] = here - h;
    const double down = loss(policy, p, batch, objective);
    p[i] = here;
    const double numeric = (up - down) / (2.0 * h);
    worst = std::max(worst, std::abs(numeric - static_cast<double>(analytic[i])));
    largest = std::max(largest, std::abs(numeric));
  }
  CHECK(largest > 0.05);
  CHECK(worst < 1e-5 * std::max(1.0, largest));
}

TEST_CASE("advantages are the discounted sums of the temporal differences") {
  // Two environments, four steps; the second one's episode ends after step 1.
  const std::vector<double> rewards{1, 2, 3, 4, 5, 6, 7, 8};
  const std::vector<std::uint8_t> ended{0, 0, 0, 1, 0, 0, 0, 0};
  const std::vector<float> values{0.5F, 1, 1.5F, 2, 2.5F, 3, 3.5F, 4};
  const std::vector<float> last{10, 20};
  std::vector<float> advantages(8);
  estimate_advantages(rewards, ended, values, last, 0.9, 0.8, advantages);
  const double gamma = 0.9;
  const double decay = 0.9 * 0.8;
  const auto delta = [&](std::size_t i, double next) {
    return rewards[i] + gamma * next - static_cast<double>(values[i]);
  };
  const double d0 = delta(0, 1.5);
  const double d2 = delta(2, 2.5);
  const double d4 = delta(4, 3.5);
  const double d6 = delta(6, 10);
  CHECK(advantages[0] == Approx(d0 + decay * (d2 + decay * (d4 + decay * d6))));
  CHECK(advantages[4] == Approx(d4 + decay * d6));
  CHECK(advantages[1] == Approx(delta(1, 2) + decay * delta(3, 0)));
  CHECK(advantages[3] == Approx(delta(3, 0)));
  CHECK(advantages[7] == Approx(delta(7, 20)));
}

TEST_CASE("Adam takes the first step by the learning rate against the gradient's sign") {
  Stream stream(8, "adam");
  Policy policy = small_policy(3, 2, stream);
  const Policy before = policy;
  Gradients gradients = zero_gradients(policy);
  gradients.actor.layers[0].weight(0, 0) = 4.0F;
  gradients.log_std[1] = -0.001F;
  Adam adam(parameter_count(policy));
  adam.step(ParameterBlocks(policy), ParameterBlocks(gradients), 0.01, 1e-8);
  CHECK(policy.actor.layers[0].weight(0, 0) == Approx(before.actor.layers[0].weight(0, 0) - 0.01F));
  CHECK(policy.log_std[1] == Approx(before.log_std[1] + 0.01F).epsilon(1e-4));
  CHECK(policy.critic == before.critic);
  CHECK(policy.log_std[0] == before.log_std[0]);
}

TEST_CASE("gradients are scaled down to the largest norm allowed, never up") {
  Stream stream(9, "norm");
  const Policy policy = small_policy(3, 2, stream);
  Gradients gradients = zero_gradients(policy);
  gradients.actor.layers[0].weight(1, 2) = 3.0F;
  gradients.critic.layers[1].bias[4] = -4.0F;
  CHECK(clip_norm(ParameterBlocks(gradients), 10.0) == Approx(5.0));
  CHECK(gradients.critic.layers[1].bias[4] == -4.0F);
  CHECK(clip_norm(ParameterBlocks(gradients), 0.5) == Approx(5.0));
  CHECK(gradients.actor.layers[0].weight(1, 2) == Approx(0.3F));
  CHECK(clip_norm(ParameterBlocks(gradients), 0.0) == Approx(0.5));
}

// ---- the learner on a problem with a known answer ------------------------------------

namespace {

// Points on a line, one a environment, pushed by an action in [0.6, 1.6] about
// 1.1, rewarded for being near the origin; episodes last 20 steps.
struct PointMasses {
  explicit PointMasses(int n, std::uint64_t seed)
      : x(static_cast<std::size_t>(n)),
        age(x.size()),
        rewards(x.size()),
        truncated(x.size()),
        terminated(x.size()),
        stream(seed, "points") {
    for (std::size_t e = 0; e < x.size(); ++e) reset(e);
  }
  void reset(std::size_t e) {
    x[e] = 4.0 * stream.uniform() - 2.0;
    age[e] = 0;
  }
  void step(std::span<const double> targets) {
    for (std::size_t e = 0; e < x.size(); ++e) {
      x[e] += targets[e] - 1.1;
      rewards[e] = -std::abs(x[e]);
      truncated[e] = ++age[e] >= 20 ? 1 : 0;
    }
  }
  std::vector<double> x;
  std::vector<int> age;
  std::vector<double> rewards;
  std::vector<std::uint8_t> truncated, terminated;
  Stream stream;
};

TrainingSettings point_settings() {
  TrainingSettings s;
  s.environments = 8;
  s.rollout = 64;
  s.steps = 512 * 60;
  s.learning_rate = 1e-3;
  s.clip = 0.2;
  s.hidden = {16, 16};
  s.initial_log_std = -1.0;
  s.head_gain = 0.01;
  return s;
}

using Learner = Ppo<PolicyPasses>;

Learner fresh_learner(const TrainingSettings& settings, int observation_length, std::uint64_t seed,
                      const char* robot) {
  return {settings,
          {initial_policy(settings, observation_length, 1, 0.6, 1.6, {},
                          Stream(seed, "train/initial", robot)),
           settings.environments},
          seed,
          robot};
}

// Mean reward a step of each update.
std::vector<double> learn_points(const TrainingSettings& settings, Learner& ppo,
                                 PointMasses& points, int updates) {
  std::vector<double> history;
  for (int u = 0; u < updates; ++u) {
    double sum = 0.0;
    for (int t = 0; t < settings.rollout; ++t) {
      points.step(ppo.act());
      ppo.reward(points.rewards, points.terminated, points.truncated, points.x, points.age);
      for (std::size_t e = 0; e < points.x.size(); ++e) {
        sum += points.rewards[e];
        if (points.truncated[e] != 0) points.reset(e);
      }
      ppo.observe(points.x, points.age);
    }
    ppo.learn();
    history.push_back(sum / static_cast<double>(settings.batch()));
  }
  return history;
}

}  // namespace

TEST_CASE("the learner solves a point mass") {
  TrainingSettings settings = point_settings();
  settings.time_limit = GENERATE(TimeLimit::end, TimeLimit::bootstrap);
  settings.action_map = GENERATE(ActionMap::offset, ActionMap::squash);
  Learner ppo = fresh_learner(settings, 1, 11, "robot");
  PointMasses points(settings.environments, 11);
  ppo.observe(points.x, points.age);
  const std::vector<double> history = learn_points(settings, ppo, points, 60);
  REQUIRE(history.size() == 60);
  CHECK(history.front() < -0.8);  // wandering
  CHECK(history.back() > -0.35);  // straight to the origin: about -0.2
}

TEST_CASE("once everything has its size, learning allocates nothing") {
  TrainingSettings settings = point_settings();
  settings.time_limit = TimeLimit::bootstrap;
  settings.clock = {20, 7};
  Learner ppo = fresh_learner(settings, 1, 12, "robot");
  PointMasses points(settings.environments, 12);
  ppo.observe(points.x, points.age);
  learn_points(settings, ppo, points, 2);
  long during = 0;
  const auto counted = [&](const auto& call) {
    const long before = allocations;
    call();
    during += allocations - before;
  };
  std::span<const double> targets;
  for (int t = 0; t < settings.rollout; ++t) {
    counted([&] { targets = ppo.act(); });
    points.step(targets);
    counted([&] {
      ppo.reward(points.rewards, points.terminated, points.truncated, points.x, points.age);
    });
    for (std::size_t e = 0; e < points.x.size(); ++e)
      if (points.truncated[e] != 0) points.reset(e);
    counted([&] { ppo.observe(points.x, points.age); });
  }
  counted([&] { ppo.learn(); });
  CHECK(during == 0);
  CHECK((allocations > 0) == counts_allocations);
}
