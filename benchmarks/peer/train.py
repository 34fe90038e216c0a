"""Processor seconds of a training of one robot on Walker-v0, as tab-separated
values: train.py STEPS
Stable-Baselines3's PPO with the settings of the benchmark's examples, on evogym and
on the environments of evo; and evo-train with the same sizes (release.yaml
beside this) and with its own. One thread each."""
import os
import resource
import subprocess
import sys
import tempfile
from time import process_time

import gymnasium
import torch
from stable_baselines3 import PPO

import evogym.envs  # noqa: F401  (registers the tasks)
import evo_robots

TABLE = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
STEPS = int(sys.argv[1])
TASK = "Walker-v0"
ROWS = ["RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"]
# examples/ppo of evogym 2.x; what is not named there is the library's default.
SETTINGS = dict(learning_rate=2.5e-4, n_steps=128, batch_size=4, n_epochs=4, gamma=0.99,
                gae_lambda=0.95, vf_coef=0.5, max_grad_norm=0.5, ent_coef=0.01, clip_range=0.1)
torch.set_num_threads(1)


def with_library(name):
    body, connections = evo_robots.robot_arrays({"body": ROWS})
    env = gymnasium.make(name, body=body, connections=connections)
    start = process_time()
    PPO("MlpPolicy", env, seed=1, device="cpu", **SETTINGS).learn(STEPS)
    used = process_time() - start
    env.close()
    return used


def with_evo_train(profile):
    with tempfile.TemporaryDirectory() as folder:
        robot = os.path.join(folder, "robot.txt")
        with open(robot, "w") as file:
            file.writelines(row + "\n" for row in ROWS)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [evo_robots.find_tool("evo-train"), robot, "--task", TASK, "--train", profile,
             "--steps", str(STEPS), "--seed", "1", "-j", "1", "-q", "--out-dir", folder],
            check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


print("training", "steps", "seconds", "ratio", sep="\t", file=TABLE, flush=True)
base = None
for label, measure in (
        ("Stable-Baselines3 on evogym", lambda: with_library(TASK)),
        ("Stable-Baselines3 on evo", lambda: with_library("evo/" + TASK)),
        ("evo-train, the same sizes", lambda: with_evo_train(os.path.join(os.path.dirname(os.path.abspath(__file__)), "release.yaml"))),
        ("evo-train, its own settings", lambda: with_evo_train("default"))):
    used = measure()
    base = base or used
    print(label, STEPS, round(used, 1), round(base / used, 1), sep="\t", file=TABLE, flush=True)
