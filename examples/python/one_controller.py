#!/usr/bin/env python3
"""One controller for eight bodies: a linear one that belongs to a voxel, found by an evolution strategy
in numpy. What voxels see, and which of them act, comes from the library (docs/modular.md); a network of
PyTorch or JAX would stand where `targets` is.
"""
import sys

import numpy as np

import evo_robots

bodies, pairs, generations = 8, 8, int(sys.argv[1]) if len(sys.argv) > 1 else 20
rng = np.random.default_rng(1)
robots = [evo_robots.sample_robot((5, 5), rng=rng) for _ in range(bodies)]
sims = evo_robots.Simulator("Walker-v0", robots, envs=2 * pairs)  # of each body one for each candidate
views = [sims.voxels(e) for e in range(0, sims.num_envs, 2 * pairs)]
fixed = [view.fixed[view.actuators] for view in views]  # of each body [A, F]
length = views[0].local_length + views[0].task_length + 2 + views[0].fixed.shape[1]


def targets(weights, local, task, unchanging):
    """[C, A] for candidates with weights [C, D], whose actuators see local [C, A, L] and task [C, T]."""
    candidates, actuators = local.shape[:2]
    seen = np.concatenate([local, np.broadcast_to(task[:, None], (candidates, actuators, task.shape[1])),
                           np.broadcast_to(unchanging, (candidates, *unchanging.shape))], axis=2)
    return 1.1 + 0.5 * np.tanh(np.einsum("cad,cd->ca", seen.clip(-5, 5), weights))


def returns(weights, steps=150):
    """[C], the mean over bodies of what candidates earn in the beginning of an episode."""
    sims.reset(seed=1, episode=0)
    earned = np.zeros((bodies, len(weights)))
    for _ in range(steps):
        local, task = sims.look()
        turn = 2 * np.pi * sims.steps[:, None] / 15  # a clock, to swing by
        task = np.concatenate([task, np.sin(turn), np.cos(turn)], axis=1).reshape(bodies, len(weights), -1)
        sims.advance(np.concatenate([
            targets(weights, local[b][:, view.actuators], task[b], fixed[b]).ravel()
            for b, view in enumerate(views)]))
        earned += sims.rewards.reshape(bodies, -1)
    return earned.mean(axis=0)


centre = np.zeros(length)
for generation in range(generations):
    noise = rng.normal(size=(pairs, length))
    scores = returns(centre + 0.3 * np.concatenate([noise, -noise]))
    ranks = scores.argsort().argsort() / (2 * pairs - 1) - 0.5
    centre += 0.5 / pairs * (ranks[:pairs] - ranks[pairs:]) @ noise
    print(f"generation {generation}: {np.median(scores):.3f} in the median, best {scores.max():.3f}")
