#!/usr/bin/python3
"""policy_run.py POLICY.onnx ROLLOUT.h5: onnxruntime gives the recorded actions to 1e-6, all
observations at once and one by one."""
import sys

import h5py
import numpy as np
import onnxruntime

with h5py.File(sys.argv[2]) as rollout:
    observations = rollout["episode_0/observations"][:-1]
    recorded = rollout["episode_0/actions"][:]
session = onnxruntime.InferenceSession(sys.argv[1], providers=["CPUExecutionProvider"])


def run(observation):
    return session.run(["target"], {"observation": observation})[0]


single = np.concatenate([run(row[None]) for row in observations[:20]])
worst = max(np.abs(run(observations) - recorded).max(), np.abs(single - recorded[:20]).max())
print(f"onnxruntime {onnxruntime.__version__}: {recorded.size} actions, largest difference {worst:.2g}")
sys.exit(0 if recorded.size and worst < 1e-6 else 1)
