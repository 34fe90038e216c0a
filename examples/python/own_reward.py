#!/usr/bin/env python3
"""A reward of one's own: stand tall. The suite's learner trains a robot for it."""
import sys

import numpy as np

import evo_robots


class Tall(evo_robots.Task):
    steps = 200

    def observe(self, now):
        return np.concatenate([now.mean_velocity("robot"), now.shape("robot")], axis=1)

    def reward(self, before, now, actions):
        height = np.ptp(now.points("robot")[:, :, 1], axis=1)  # [E], raw units
        return 10 * (height - 0.5)


body, connections = evo_robots.sample_robot((5, 5), rng=np.random.default_rng(1))
trained = evo_robots.train(Tall, (body, connections), steps=int(sys.argv[1]) if len(sys.argv) > 1 else 100_000)
print(f"return {trained.curve[0, 1]:.3f} at first, {trained.fitness:.3f} at best")
