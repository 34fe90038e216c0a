"""What an empty virtual environment with the wheel can do; run by wheel.sh."""
import json
import os
import subprocess
import sys

import gymnasium
import numpy as np

import evo_robots

assert os.path.dirname(evo_robots.__file__).startswith(os.path.join(os.getcwd(), "venv")), evo_robots

# README's example.
body, connections = evo_robots.sample_robot((5, 5), rng=np.random.default_rng(1))
envs = gymnasium.make_vec("evo/Walker-v0", num_envs=16, body=body, connections=connections)
observations, infos = envs.reset(seed=1)
observations, rewards, terminated, truncated, infos = envs.step(envs.action_space.sample())
assert observations.shape[0] == 16

env = gymnasium.make("evo/Walker-v0", body=body, render_mode="rgb_array")
env.reset(seed=1)
for _ in range(20):
    env.step(env.action_space.sample())
assert env.render().shape == (300, 600, 3)
env.unwrapped.video(120, 60).save("walk.gif")


def said(command):
    return subprocess.run(command, shell=True, check=True, capture_output=True, text=True).stdout


robot = said("evo-sample -n 1 --seed 1")
trained = json.loads(said("evo-sample -n 1 --seed 1 | evo-train --task Walker-v0 --steps 2048 --seed 1 --out-dir ."))
assert trained["id"] == json.loads(robot)["id"] and "fitness" in trained
said("evo-sample -n 1 --seed 1 | evo eval --task Walker-v0 --actions sine:0.5,20,0.7 --rollout walk.h5")
said("evo-render walk.h5 --strip 2 -o sheet.png")
assert open("sheet.png", "rb").read(4) == b"\x89PNG"
assert os.path.join("venv", "share", "man") in said("man -w evo-train evo || ls venv/share/man/man1/evo-train.1")
assert os.path.exists(said("evo-data tasks/recipes/moments.yaml").strip())
print(f"  {sys.version.split()[0]}: tools, environments, pictures")
