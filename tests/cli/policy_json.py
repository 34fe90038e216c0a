#!/usr/bin/python3
"""policy_json.py POLICY.json ROLLOUT.h5: the policy's actions on the rollout's observations
are the recorded ones to 1e-6."""
import json
import sys

import h5py
import numpy as np

policy = json.load(open(sys.argv[1]))
with h5py.File(sys.argv[2]) as rollout:
    observations = rollout["episode_0/observations"][:-1]
    recorded = rollout["episode_0/actions"][:]

scale, action = policy["normalizer"], policy["action"]
z = observations
if scale["count"]:
    z = (z - scale["mean"]) / np.sqrt(np.array(scale["var"]) + scale["epsilon"])
z = np.clip(z, -scale["clip"], scale["clip"]).astype(np.float32)
for layer in policy["actor"]:
    a = z @ np.array(layer["weight"], np.float32).T + np.array(layer["bias"], np.float32)
    z = np.tanh(a)
low, high = action["bounds"]
if action["map"] == "offset":
    targets = np.clip(action["offset"] + a.astype(float), low, high)
else:
    targets = (high + low) / 2 + (high - low) / 2 * np.tanh(a.astype(float))

worst = np.abs(targets - recorded).max()
print(f"{recorded.size} actions, largest difference {worst:.2g}")
sys.exit(0 if recorded.size and worst < 1e-6 else 1)
