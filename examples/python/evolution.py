#!/usr/bin/env python3
"""An evolution of bodies in twenty lines: each is scored by a wave that travels over it."""
import numpy as np

import evo_robots

rng = np.random.default_rng(1)


def fitness(body):
    with evo_robots.Simulator("Walker-v0", body) as simulator:
        simulator.reset(seed=1)
        phase = np.arange(simulator.action_lengths[0])
        return sum(simulator.step(1.1 + 0.5 * np.sin(0.3 * t - 0.7 * phase)).rewards[0] for t in range(100))


def mutated(body):
    while True:
        child = np.where(rng.random(body.shape) < 0.1, rng.integers(0, 5, body.shape), body)
        if evo_robots.is_connected(child) and evo_robots.has_actuator(child):
            return child


population = [evo_robots.sample_robot((5, 5), rng=rng)[0] for _ in range(8)]
for generation in range(4):
    population.sort(key=fitness, reverse=True)
    print(f"generation {generation}: best {fitness(population[0]):.3f}")
    population = population[:4] + [mutated(body) for body in population[:4]]
print(evo_robots.Robot(population[0]))
