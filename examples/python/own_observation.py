#!/usr/bin/env python3
"""An observation of one's own, that of the last three steps, for a task of the suite: Gymnasium's wrappers
do it, and any library trains on it."""
import gymnasium
import numpy as np
from gymnasium.wrappers import FrameStackObservation

import evo_robots

body, connections = evo_robots.sample_robot((5, 5), rng=np.random.default_rng(1))
env = FrameStackObservation(gymnasium.make("evo/Walker-v0", body=body, connections=connections), 3)
observation, _ = env.reset(seed=1)
print(f"observations of shape {observation.shape}")
total, over = 0.0, False
while not over:
    observation, reward, terminated, truncated, _ = env.step(env.action_space.sample())
    total, over = total + reward, terminated or truncated
print(f"return {total:.3f}")
env.close()
