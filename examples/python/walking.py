#!/usr/bin/env python3
"""How far a body gets in two seconds by a wave that travels over it: what the examples beside this
file optimise. Another question is another score()."""
import numpy as np

import evo_robots

SHAPE = (5, 5)
known = {}  # scores by robots' ids


def score(cells):
    """Of 25 numbers from 0 to 4, row by row; -1 for what is not one piece, or cannot move."""
    body = np.reshape(cells, SHAPE).astype(int)
    if not (evo_robots.is_connected(body) and evo_robots.has_actuator(body)):
        return -1.0
    robot = evo_robots.Robot(body)
    if robot.id not in known:
        with evo_robots.Simulator("Walker-v0", robot) as simulator:
            simulator.reset(seed=1)
            phase = 0.7 * np.arange(simulator.action_lengths[0])
            known[robot.id] = float(sum(
                simulator.step(1.1 + 0.5 * np.sin(0.3 * t - phase)).rewards[0] for t in range(100)))
    return known[robot.id]


if __name__ == "__main__":
    body, _ = evo_robots.sample_robot(SHAPE, rng=np.random.default_rng(1))
    print(f"{evo_robots.Robot(body)}\ngets {score(body) / 0.1:.2f} voxels far")
