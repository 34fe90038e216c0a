"""Saturated actions of single precision in the 32 environments of the package: a line for each with
a digest of the positions after each of 150 steps, and the sum of the rewards."""
import hashlib
import random

import evogym.envs  # noqa: F401
import gymnasium
import numpy as np
from evogym import BASELINE_ENV_NAMES

BODY = np.array([[1, 3, 3, 3, 1], [4, 2, 2, 2, 4], [4, 3, 1, 3, 4], [4, 0, 0, 0, 4], [4, 0, 0, 0, 4]])

for task in BASELINE_ENV_NAMES:
    random.seed(1)
    rng = np.random.default_rng(1)
    env = gymnasium.make(task, body=BODY).unwrapped
    env.reset()
    digest, total = hashlib.sha256(), 0.0
    for _ in range(150):
        reward, done = env.step(rng.uniform(0, 2.2, env.action_space.shape).astype(np.float32))[1:3]
        total += reward
        digest.update(np.ascontiguousarray(env.object_pos_at_time(env.get_time(), "robot")).tobytes())
        if done:
            break
    print(f"{task}\t{env.get_time()}\t{digest.hexdigest()[:16]}\t{total:.9f}")
