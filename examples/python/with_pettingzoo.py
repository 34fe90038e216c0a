#!/usr/bin/env python3
"""Two robots in one world for PettingZoo: each is rewarded where the box moves away from it."""
import numpy as np
from gymnasium.spaces import Box
from pettingzoo import ParallelEnv
from pettingzoo.test import parallel_api_test

from evo_robots import Simulations, World


class Push(ParallelEnv):
    metadata, possible_agents = {"name": "push"}, ["left", "right"]

    def __init__(self):
        world, robot = World(), [[3, 3, 3], [4, 1, 4]]
        world.add("ground", np.full((1, 40), 5), 0, 0)
        for name, body, x in ("left", robot, 8), ("box", np.ones((2, 3)), 14), ("right", robot, 20):
            world.add(name, body, x, 1)
        self.sims = Simulations(world)
        seen, acts = Box(-10, 10, self.sims.positions[0].shape, float), Box(0.6, 1.6, (5,), float)
        self.observation_space, self.action_space = lambda agent: seen, lambda agent: acts

    def seen(self):
        return {agent: self.sims.positions[0].copy() for agent in self.agents}

    def reset(self, seed=None, options=None):
        self.agents, self.steps = self.possible_agents[:], 0
        self.sims.reset()
        return self.seen(), {"left": {}, "right": {}}

    def step(self, actions):
        box = self.sims.positions[0, self.sims.objects["box"].points, 0]  # as it is at any time
        before, self.steps = box.mean(), self.steps + 1
        self.sims.step(np.concatenate([actions["left"], actions["right"]])[None])
        gained, seen, over = box.mean() - before, self.seen(), self.steps == 100
        self.agents = [] if over else self.agents
        rewards, infos = {"left": gained, "right": -gained}, {"left": {}, "right": {}}
        return seen, rewards, dict.fromkeys(seen, False), dict.fromkeys(seen, over), infos


parallel_api_test(Push(), num_cycles=300)
