#!/usr/bin/env python3
"""An evolution of bodies in twenty lines."""
import numpy as np
from walking import SHAPE, score

import evo_robots

rng = np.random.default_rng(1)


def mutated(body):
    while True:
        child = np.where(rng.random(body.shape) < 0.1, rng.integers(0, 5, body.shape), body)
        if evo_robots.is_connected(child) and evo_robots.has_actuator(child):
            return child


population = [evo_robots.sample_robot(SHAPE, rng=rng)[0] for _ in range(8)]
for generation in range(4):
    population.sort(key=score, reverse=True)
    print(f"generation {generation}: best {score(population[0]):.3f}")
    population = population[:4] + [mutated(body) for body in population[:4]]
print(evo_robots.Robot(population[0]))
