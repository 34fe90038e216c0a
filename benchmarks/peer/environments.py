"""The 32 environments of evogym beside evo_robots.evogym's of the same names, as
tab-separated values: environments.py [STEPS]
Both take the same random actions; compared are observations, rewards and ends of each
step, until an episode ends. Needs evogym and evo_robots, as benchmarks/peer/run installs
them."""
import os
import random
import sys

import numpy as np

import evogym.envs
from evo_robots.evogym.envs import tasks

# evogym greets on standard output: that goes to standard error, the table here.
TABLE = os.fdopen(os.dup(1), "w", buffering=1)
os.dup2(2, 1)
WALKER = np.array([[1, 3, 3, 3, 1], [4, 2, 2, 2, 4], [4, 3, 1, 3, 4], [4, 0, 0, 0, 4], [4, 0, 0, 0, 4]])


def begun(environment):
    """What an environment observes first, where Python's random draws the same for both."""
    random.seed(5)
    return environment.reset()[0]


def compare(name, steps):
    """The task, steps taken, and the largest difference of an observation and of a reward."""
    ours = getattr(tasks, name)(WALKER)
    theirs = getattr(evogym.envs, name)(WALKER)
    seen = np.abs(begun(ours) - begun(theirs)).max()
    earned = 0.0
    rng = np.random.default_rng(1)
    for step in range(1, steps + 1):
        action = rng.uniform(0.6, 1.6, ours.action_space.shape)
        here, there = ours.step(action), theirs.step(action)
        seen = max(seen, np.abs(here[0] - there[0]).max())
        earned = max(earned, abs(here[1] - there[1]))
        if bool(here[2]) != bool(there[2]):
            return ours.TASK, step, np.inf, np.inf
        if here[2]:
            break
    return ours.TASK, step, seen, earned


def main():
    steps = int((sys.argv[1:] + ["100"])[0])
    print("task", "steps", "observations", "rewards", sep="\t", file=TABLE)
    for name, kind in vars(tasks).items():
        if getattr(kind, "TASK", ""):
            print(*compare(name, steps), sep="\t", file=TABLE)


main()
