#!/usr/bin/python3
"""policy_run.py POLICY.onnx ROLLOUT.h5: onnxruntime gives the recorded actions to 1e-6, all
observations at once and one by one. POLICY.onnx POLICY.h5 ROBOT: as for policy_onnx.py."""
import sys

import numpy as np
import onnxruntime

from policy_onnx import recorded_episode

inputs, recorded = recorded_episode(sys.argv)
session = onnxruntime.InferenceSession(sys.argv[1], providers=["CPUExecutionProvider"])
inputs = {value.name: inputs[value.name] for value in session.get_inputs()}


def run(first, last):
    return session.run(["target"], {name: value[first:last] for name, value in inputs.items()})[0]


single = np.concatenate([run(k, k + 1) for k in range(20)])
worst = max(np.abs(run(0, None) - recorded).max(), np.abs(single - recorded[:20]).max())
print(f"onnxruntime {onnxruntime.__version__}: {recorded.size} actions, largest difference {worst:.2g}")
sys.exit(0 if recorded.size and worst < 1e-6 else 1)
