"""Every record in the benchmark's own package, as tab-separated values:
records.py [NAME...]     tasks [all]

evo-eval replays a record's controller; the package then takes the
same actions in its own environment of the task. Compared are the returns and all
positions. A network also acts in the package itself, on what the package observes. Needs
evogym, evo_robots and h5py, as benchmarks/peer/run installs them, and the tools in PATH.
Tasks that draw their start or goal are left out: the package's draws cannot be given."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import gymnasium
import numpy as np

import evogym.envs  # noqa: F401  (registers the tasks)
from evogym.simulator_cpp import Sim
from evo_robots import get_full_connectivity
from evo_robots.files import read_policy, read_rollout

# evogym greets on standard output: that goes to standard error, the table here.
TABLE = os.fdopen(os.dup(1), "w", buffering=1)
os.dup2(2, 1)
RECORDS = pathlib.Path(__file__).resolve().parents[2] / "records"
RANDOM_TASKS = ("BidirectionalWalker-v0", "Catcher-v0")
LETTERS = ".RSHV#"


def environment(record):
    body = np.array([[LETTERS.index(letter) for letter in row] for row in record["body"]])
    return gymnasium.make(record["task"], body=body, connections=get_full_connectivity(body))


def replayed(record, policy, folder):
    """The episode as evo-eval plays it."""
    robot = folder / "robot.json"
    rollout = folder / "rollout.h5"
    robot.write_text(json.dumps({"format": "evo/robot", "version": 1, "body": record["body"]}))
    subprocess.run(["evo-eval", "--task", record["task"], "--policy", policy,
                    "--seed", str(record["seed"]), "--rollout", rollout, robot],
                   check=True, stdout=subprocess.DEVNULL)
    return read_rollout(rollout)[0]


def same_actions(record, episode):
    """Return of the package, and the largest difference of a position."""
    env = environment(record)
    env.reset()
    earned = apart = 0.0
    for step, action in enumerate(episode.actions, 1):
        _, reward, terminated, truncated, _ = env.step(action)
        earned += reward
        here = Sim.pos_at_time(env.unwrapped.sim, step).T
        apart = max(apart, np.abs(here - episode.positions[step]).max())
        if (terminated or truncated) and step < len(episode.actions):
            return earned, np.inf
    return earned, apart


def acting(record, policy):
    """Return of a network that acts on the package's observations."""
    network = read_policy(policy)
    env = environment(record)
    observation, _ = env.reset()
    earned, over = 0.0, False
    while not over:
        observation, reward, terminated, truncated, _ = env.step(network.predict(observation))
        earned += reward
        over = terminated or truncated
    return earned


def main():
    print("record", "controller", "evo-eval", "the package", "largest difference",
          "acting in the package", sep="\t", file=TABLE)
    for name in sys.argv[1:] or sorted(path.parent.name for path in RECORDS.glob("*/record.json")):
        record = json.loads((RECORDS / name / "record.json").read_text())
        if record["task"] in RANDOM_TASKS:
            continue
        policy = RECORDS / name / "policy.h5"
        with tempfile.TemporaryDirectory() as folder:
            episode = replayed(record, policy, pathlib.Path(folder))
        earned, apart = same_actions(record, episode)
        own = acting(record, policy) if record["controller"] == "network" else ""
        print(name, record["controller"], episode.rewards.sum(), earned, apart, own,
              sep="\t", file=TABLE)


main()
