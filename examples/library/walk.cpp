// Sixteen starts of one robot, each a little apart, on a wave through its actuators: the
// mean return and its spread. Then a training, the mean that its policy was kept for, and what
// it earns from the official start.
//   walk [TASK [TRAINING_STEPS]]
#include <evo/evo.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

static void need(int result) {
  if (result == EVO_OK) return;
  std::fprintf(stderr, "walk: %s\n", evo_error());
  std::exit(result);
}

int main(int argc, char** argv) {
  evo_task* task;
  evo_robots* robots;
  evo_envs* envs;
  evo_task_facts facts;
  evo_robot_facts robot;
  evo_arrays at;
  need(evo_task_open(argc > 1 ? argv[1] : "Walker-v0", &task));
  need(evo_task_describe(task, &facts, sizeof facts));
  need(evo_robots_parse("RHHHR\nVSSSV\nVHRHV\nV...V\nV...V\n", &robots));
  need(evo_robots_describe(robots, 0, &robot, sizeof robot));
  need(evo_envs_open(task, robots, 16, 1, &envs));
  need(evo_envs_arrays(envs, &at, sizeof at));

  evo_start start{};
  start.has_seed = 1;
  start.seed = 1;
  start.jitter = 1e-4;
  need(evo_envs_reset(envs, nullptr, 0, &start));
  std::vector<double> actions(at.action_values);
  std::vector<double> returns(at.environments);
  for (int t = 0; t < facts.episode_steps; ++t) {
    for (std::size_t i = 0; i < actions.size(); ++i)
      actions[i] = 1.1 + 0.5 * std::sin(0.3 * t + 0.7 * (i % at.action_offsets[1]));
    need(evo_envs_step(envs, actions.data(), actions.size(), nullptr, 0));
    for (std::size_t e = 0; e < returns.size(); ++e) returns[e] += at.rewards[e];
  }
  evo_envs_free(envs);
  double mean = 0, variance = 0;
  for (const double r : returns) mean += r / returns.size();
  for (const double r : returns) variance += (r - mean) * (r - mean) / (returns.size() - 1);
  std::printf("robot %s on a wave: %.4f +- %.4f\n", robot.id, mean, std::sqrt(variance));

  evo_policy* policy;
  evo_policy_facts learned;
  evo_training training{};
  training.steps = argc > 2 ? std::stoll(argv[2]) : 51'200;
  training.seed = 1;
  need(evo_train(task, robots, 0, &training, sizeof training, &policy));
  need(evo_policy_describe(policy, &learned, sizeof learned));
  need(evo_policy_write(policy, "walk.policy.h5"));

  need(evo_envs_open(task, robots, 1, 1, &envs));
  need(evo_envs_arrays(envs, &at, sizeof at));
  need(evo_envs_reset(envs, nullptr, 0, nullptr));
  double earned = 0;
  while (!at.terminated[0] && !at.truncated[0]) {
    need(evo_envs_act(envs, policy, actions.data(), at.action_values));
    need(evo_envs_step(envs, actions.data(), at.action_values, nullptr, 0));
    earned += at.rewards[0];
  }
  std::printf("trained: fitness %.4f, from the official start %.4f\n", learned.fitness, earned);
  evo_policy_free(policy);
  evo_envs_free(envs);
  evo_robots_free(robots);
  evo_task_free(task);
}
