#!/usr/bin/env python3
"""Steps of many simulations as a function that JAX differentiates, through custom_vjp: gradient
ascent finds targets that carry a robot to the right."""
import jax
import jax.numpy as jnp
import numpy as np

from evo_robots import Simulations, World

jax.config.update("jax_enable_x64", True)


def differentiable(sims):
    """A function of targets [T, count, A]: positions [count, P, 2] after these steps from rest."""

    @jax.custom_vjp
    def steps(targets):
        return forward(targets)[0]

    def forward(targets):
        sims.reset()
        sims.record()
        for step in np.asarray(targets):
            sims.step(step)
        return jnp.array(sims.positions), targets

    def backward(targets, by_positions):
        by = sims.gradients()
        by.positions[:] = by_positions
        by_targets = np.empty(targets.shape)
        for t in reversed(range(len(targets))):
            sims.pull_back(by)
            by_targets[t] = by.targets
        return (jnp.array(by_targets),)

    steps.defvjp(forward, backward)
    return steps


def main(steps=24, rounds=12):
    world = World()
    world.add("ground", np.full((1, 30), 5), 0, 0)
    world.add("robot", [[3, 3, 3], [4, 0, 4]], 3, 1)
    sims = Simulations(world, 8)
    points = sims.objects["robot"].points
    start = sims.positions[:, points, 0].mean()
    run = differentiable(sims)
    ends = lambda raw: run(1.1 + 0.5 * jnp.tanh(raw))[:, points, 0].mean(1)  # noqa: E731
    raw = jax.random.normal(jax.random.key(1), (steps, 8, sims.num_actuators))
    walked = []
    for _ in range(rounds):
        far, by = jax.value_and_grad(lambda raw: ends(raw).sum())(raw)
        walked.append(float(far / 8 - start) / 0.1)
        raw += 0.2 * by / jnp.sqrt((by**2).mean(axis=(0, 2), keepdims=True))
    return walked


if __name__ == "__main__":
    print("voxels walked, round by round:", " ".join(f"{x:.2f}" for x in main()))
