#!/usr/bin/env python3
"""Design by gradient: how stiff each voxel of a walker should be, for a gait that stays the same.
Episodes that begin at sixteen phases of the gait are climbed together, since the way of one alone
is too rugged; others, between them, say what came of it."""
import numpy as np

from evo_robots import Simulations, World

BODY = np.array([[3, 3, 3, 3], [4, 4, 4, 4], [3, 0, 0, 3]])
EPISODES, STEPS = 16, 60


def walk(stiffness, shift=0.0):
    """Voxels walked, mean of all episodes, and its derivative by each voxel's factor."""
    world = World()
    world.add("robot", BODY, 10, 1, stiffness=stiffness)
    world.add("ground", np.full((1, 40), 5), 0, 0)
    sims = Simulations(world, EPISODES)
    points = sims.objects["robot"].points
    rows, columns = np.nonzero(BODY)
    phase = 2 * np.pi * (np.arange(EPISODES)[:, None] + shift) / EPISODES - columns - 1.5 * rows
    sims.record()
    start = sims.positions[:, points, 0].mean()
    for t in range(STEPS):
        sims.step(1.1 + 0.4 * np.sin(2 * np.pi * t / 20 + phase))
    walked = (sims.positions[:, points, 0].mean() - start) / 0.1
    by = sims.gradients()
    by.positions[:, points, 0] = 1 / 0.1 / sims.positions[0, points, 0].size
    for _ in range(STEPS):
        sims.pull_back(by)
    by_voxel = np.zeros(BODY.shape)
    by_voxel[BODY != 0] = by.stiffness[:, : len(rows)].mean(0)  # the world's first voxels
    return walked, by_voxel


def main(rounds=20):
    factors, seen = np.ones(BODY.shape), []
    for _ in range(rounds):
        walked, by = walk(factors)
        seen.append((walked, factors))
        by *= factors  # by their logarithms
        factors = np.clip(factors * np.exp(0.1 * by / np.sqrt((by**2).mean())), 0.1, 10)
    best = max(seen, key=lambda pair: pair[0])[1]
    return walk(np.ones(BODY.shape), 0.5)[0], walk(best, 0.5)[0], best


if __name__ == "__main__":
    before, after, factors = main()
    print(f"voxels walked from other phases: {before:.2f}, then {after:.2f} with\n{factors.round(2)}")
