#!/usr/bin/env python3
"""Steps of many simulations as a function that PyTorch differentiates: by targets, and by the
stiffness of voxels. Adam finds targets that carry a robot to the right."""
import numpy as np
import torch

from evo_robots import Simulations, World


class Steps(torch.autograd.Function):
    """Targets [T, count, A], from rest: positions [count, P, 2] after the last step."""

    @staticmethod
    def forward(ctx, targets, sims):
        sims.reset()
        sims.record()
        for step in targets.detach().numpy():
            sims.step(step)
        ctx.sims, ctx.steps = sims, len(targets)
        return torch.tensor(sims.positions)

    @staticmethod
    def backward(ctx, by_positions):
        by = ctx.sims.gradients()
        by.positions[:] = by_positions.numpy()
        by_targets = np.empty((ctx.steps, ctx.sims.num_sims, ctx.sims.num_actuators))
        for t in reversed(range(ctx.steps)):
            ctx.sims.pull_back(by)
            by_targets[t] = by.targets
        return torch.from_numpy(by_targets), None


def main(steps=24, rounds=12):
    torch.manual_seed(1)
    world = World()
    world.add("ground", np.full((1, 30), 5), 0, 0)
    world.add("robot", [[3, 3, 3], [4, 0, 4]], 3, 1)
    sims = Simulations(world, 8)
    points = sims.objects["robot"].points
    start = sims.positions[:, points, 0].mean()
    raw = torch.randn(steps, 8, sims.num_actuators, dtype=torch.float64).requires_grad_()
    adam = torch.optim.Adam([raw], lr=0.2)
    walked = []
    for _ in range(rounds):
        ends = Steps.apply(1.1 + 0.5 * torch.tanh(raw), sims)[:, points, 0].mean(1)
        walked.append((ends.max().item() - start) / 0.1)
        adam.zero_grad()
        (-ends.sum()).backward()
        adam.step()
    return walked


if __name__ == "__main__":
    print("voxels walked, round by round:", " ".join(f"{x:.2f}" for x in main()))
