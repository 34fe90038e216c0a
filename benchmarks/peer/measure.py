"""Control steps a second of evogym and of evo on the same bodies and actions, and
how far their observations are apart. A line of tab-separated values for each."""
import json
import os
import subprocess
import sys
import time

import gymnasium
import numpy as np

import evogym.envs  # noqa: F401  (registers the tasks)
import evo_robots
from evo_robots import Simulator, robot_arrays

# evogym greets on standard output: that goes to standard error, the table here.
TABLE = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
SECONDS = float(sys.argv[1])
REPETITIONS = 3  # of which the median is reported
WALKER = {"body": ["RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"]}
COMPARED_STEPS = 100
RANDOM_TASKS = ("BidirectionalWalker-v0", "Catcher-v0")  # whose draws the two make differently
LANES = 16


def median_rate(step, per_call):
    rates = []
    for _ in range(REPETITIONS):
        calls, start = 0, time.perf_counter()
        while time.perf_counter() - start < SECONDS / REPETITIONS:
            step()
            calls += 1
        rates.append(calls * per_call / (time.perf_counter() - start))
    return sorted(rates)[REPETITIONS // 2]


def peer(task, body, connections, actions):
    env = gymnasium.make(task, body=body, connections=connections)
    first, _ = env.reset()
    observations = [first] + [env.step(a)[0] for a in actions[:COMPARED_STEPS]]
    turn = iter(range(10**9))

    def step():
        ended = env.step(actions[next(turn) % len(actions)])[2:4]
        if any(ended):
            env.reset()

    rate = median_rate(step, 1)
    env.close()
    return rate, np.array(observations)


def ours(task, robot, actions, envs, fast=False):
    with Simulator(task, robot, envs, fast=fast) as simulator:
        state = simulator.reset(seed=0)
        observations = [state.observations[0]]
        batches = [np.broadcast_to(a, (envs, len(a))).copy() for a in actions]
        for a in batches[:COMPARED_STEPS]:
            observations.append(simulator.step(a).observations[0])
        # Other actions for every environment, as in training.
        rng = np.random.default_rng(1)
        batches = [rng.uniform(0.6, 1.6, b.shape) for b in batches]
        turn = iter(range(10**9))

        def step():
            state = simulator.step(batches[next(turn) % len(batches)])
            ended = state.terminated | state.truncated | (state.status != 0)
            if ended.any():
                simulator.reset(np.flatnonzero(ended))

        return median_rate(step, envs), np.array(observations)


def compare(task, robot):
    body, connections = robot_arrays(robot)
    count = sum(row.count("H") + row.count("V") for row in robot["body"])
    actions = np.random.default_rng(0).uniform(0.6, 1.6, (97, count))
    theirs, seen = peer(task, body, connections, actions)
    one, own = ours(task, robot, actions, 1)
    many, _ = ours(task, robot, actions, LANES)
    fast, _ = ours(task, robot, actions, LANES, fast=True)
    apart = "" if task in RANDOM_TASKS else f"{np.abs(seen - own).max():.1e}"
    print(task, "x".join(map(str, body.shape)), *(round(r) for r in (theirs, one, many, fast)),
          round(many / theirs, 1), apart, sep="\t", file=TABLE, flush=True)


def sampled(size):
    line = subprocess.run(
        [os.path.join(os.environ["EVO_BIN"], "evo-sample"), "-n", "1", "--shape", f"{size}x{size}",
         "--weights", "1,1,1,1,1", "--seed", "1"], capture_output=True, text=True, check=True)
    return json.loads(line.stdout)


print("task", "body", "evogym", "evo, one", f"evo, {LANES}", f"evo --fast, {LANES}", "ratio",
      f"apart after {COMPARED_STEPS} steps", sep="\t", file=TABLE, flush=True)
for size in (5, 10, 20, 35):
    compare("Walker-v0", WALKER if size == 5 else sampled(size))
for name in evo_robots.TASKS:
    if name != "Walker-v0":
        compare(name, WALKER)
