// Sixteen starts of one robot, each a little apart, on a wave through its actuators: the
// mean return and its spread. Then a training, the mean that its policy was kept for, and what
// it earns from the official start.
//   walk [TASK [TRAINING_STEPS]]
#include <evo/evo.hpp>

#include <cmath>
#include <cstdio>
#include <string>

int main(int argc, char** argv) try {
  const libevo::Task task(argc > 1 ? argv[1] : "Walker-v0");
  const libevo::Robot robot({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"});
  libevo::VectorEnv envs(task, {robot}, 16);
  std::vector<double> actions(envs.action_values());

  envs.reset({.seed = 1, .jitter = 1e-4});
  std::vector<double> returns(envs.rewards().size());
  for (int t = 0; t < task.episode_steps(); ++t) {
    for (std::size_t i = 0; i < actions.size(); ++i)
      actions[i] = 1.1 + 0.5 * std::sin(0.3 * t + 0.7 * (i % envs.action_length(0)));
    envs.step(actions);
    for (std::size_t e = 0; e < returns.size(); ++e) returns[e] += envs.rewards()[e];
  }
  double mean = 0, variance = 0;
  for (const double r : returns) mean += r / returns.size();
  for (const double r : returns) variance += (r - mean) * (r - mean) / (returns.size() - 1);
  std::printf("robot %s on a wave: %.4f +- %.4f\n", robot.id().c_str(), mean, std::sqrt(variance));

  const auto steps = argc > 2 ? std::stoll(argv[2]) : 51'200;
  const libevo::Policy policy = libevo::train(task, robot, {.steps = steps, .seed = 1});
  policy.save("walk.policy.h5");

  libevo::VectorEnv again(policy.task(), {policy.robot()});
  again.reset();
  double earned = 0;
  actions.resize(again.action_values());
  while (!again.terminated()[0] && !again.truncated()[0]) {
    policy.act(again.observations(), again.steps(), actions);
    again.step(actions);
    earned += again.rewards()[0];
  }
  std::printf("trained: fitness %.4f, from the official start %.4f\n", policy.fitness(), earned);
} catch (const libevo::Error& failure) {
  std::fprintf(stderr, "walk: %s\n", failure.what());
  return static_cast<int>(failure.kind());
}
