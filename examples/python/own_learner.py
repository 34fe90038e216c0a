#!/usr/bin/env python3
"""A learner of one's own: random search over sine waves, sixteen at a time."""
import gymnasium
import numpy as np

import evo_robots

body, connections = evo_robots.sample_robot((5, 5), rng=np.random.default_rng(1))
envs = gymnasium.make_vec("evo/Walker-v0", num_envs=16, body=body, connections=connections)
actuators = envs.single_action_space.shape[0]
rng = np.random.default_rng(0)
best, waves = -np.inf, None
for attempt in range(4):
    amplitude, phase = rng.uniform(0, 0.5, (16, actuators)), rng.uniform(0, 2 * np.pi, (16, actuators))
    envs.reset(seed=1)
    returns = np.zeros(16)
    for t in range(300):
        returns += envs.step(1.1 + amplitude * np.sin(2 * np.pi * t / 20 + phase))[1]
    if returns.max() > best:
        best, waves = returns.max(), (amplitude[returns.argmax()], phase[returns.argmax()])
    print(f"{16 * (attempt + 1)} waves: best return {best:.3f}")
envs.close()
