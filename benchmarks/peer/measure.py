"""Control steps per second of evogym and of evo on the same bodies and actions, and
how far their observations are apart, as tab-separated values: measure.py SECONDS
Both as their users step them, through gymnasium.make, evo also sixteen at a time
through gymnasium.make_vec."""
import json
import os
import subprocess
import sys
from time import process_time  # which what others do on a machine does not change

import gymnasium
import numpy as np

import evogym.envs  # noqa: F401  (registers the tasks)
import evo_robots

# evogym greets on standard output: that goes to standard error, the table here.
TABLE = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
SECONDS = float(sys.argv[1])
REPETITIONS = 3  # the median is reported
WALKER = ["RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"]
COMPARED_STEPS = 100
RANDOM_TASKS = ("BidirectionalWalker-v0", "Catcher-v0")  # whose draws the two make differently
LANES = 16


def median_rate(step, per_call):
    rates = []
    for _ in range(REPETITIONS):
        calls, start, used = 0, process_time(), 0.0
        while used < SECONDS / REPETITIONS:
            step()
            calls += 1
            used = process_time() - start
        rates.append(calls * per_call / used)
    return sorted(rates)[REPETITIONS // 2]


def alone(env, actions):
    """Steps per second, and the first observations."""
    first, _ = env.reset(seed=0)
    observations = [first] + [env.step(a)[0] for a in actions[:COMPARED_STEPS]]
    turn = iter(range(10**9))

    def step():
        ended = env.step(actions[next(turn) % len(actions)])[2:4]
        if any(ended):
            env.reset()

    rate = median_rate(step, 1)
    env.close()
    return rate, np.array(observations)


def together(task, body, connections, actuators):
    envs = gymnasium.make_vec("evo/" + task, num_envs=LANES, body=body, connections=connections)
    envs.reset(seed=0)
    rng = np.random.default_rng(1)  # other actions for every environment, as in training
    batches = rng.uniform(0.6, 1.6, (97, LANES, actuators))
    turn = iter(range(10**9))
    rate = median_rate(lambda: envs.step(batches[next(turn) % len(batches)]), LANES)
    envs.close()
    return rate


def compare(task, rows, benched=""):
    body, connections = evo_robots.robot_arrays({"body": rows})
    actuators = sum(row.count("H") + row.count("V") for row in rows)
    actions = np.random.default_rng(0).uniform(0.6, 1.6, (97, actuators))
    theirs, seen = alone(gymnasium.make(task, body=body, connections=connections), actions)
    env = gymnasium.make("evo/" + task, body=body, connections=connections)
    one, own = alone(env, actions)
    many = together(task, body, connections, actuators)
    apart = "" if task in RANDOM_TASKS else f"{np.abs(seen - own).max():.1e}"
    print(task, "x".join(map(str, body.shape)), *(round(r) for r in (theirs, one, many)),
          benched, round(many / theirs, 1), apart, sep="\t", file=TABLE, flush=True)


def bench(size):
    """A body and how fast evo-bench steps sixteen of it, without Python."""
    said = subprocess.run(
        [evo_robots.find_tool("evo-bench"), "--sizes", str(size), "--envs", str(LANES), "--json",
         "--seconds", str(SECONDS / REPETITIONS)],
        capture_output=True, text=True, check=True).stdout
    found = json.loads(said)
    return found["body"], round(found["steps_per_second"])


print("task", "body", "evogym", "evo, one", f"evo, {LANES}", f"evo-bench, {LANES}", "ratio", f"apart after {COMPARED_STEPS} steps", sep="\t", file=TABLE,
      flush=True)
for size in (5, 10, 20, 35):
    compare("Walker-v0", *bench(size))
for name in evo_robots.TASKS:
    compare(name, WALKER)
