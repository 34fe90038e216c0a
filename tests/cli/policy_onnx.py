#!/usr/bin/python3
"""policy_onnx.py POLICY.onnx ROLLOUT.h5: the graph is valid ONNX, and evaluated operator by
operator it gives the recorded actions to 1e-6."""
import sys

import h5py
import numpy as np
import onnx
from onnx import numpy_helper

model = onnx.load(sys.argv[1])
onnx.checker.check_model(model, full_check=True)
with h5py.File(sys.argv[2]) as rollout:
    values = {"observation": rollout["episode_0/observations"][:-1]}
    recorded = rollout["episode_0/actions"][:]
values.update((t.name, numpy_helper.to_array(t)) for t in model.graph.initializer)
TYPES = {onnx.TensorProto.FLOAT: np.float32, onnx.TensorProto.DOUBLE: np.float64}
OPERATORS = {
    "Sub": lambda a, b: a - b,
    "Div": lambda a, b: a / b,
    "Add": lambda a, b: a + b,
    "Mul": lambda a, b: a * b,
    "Clip": np.clip,
    "Tanh": np.tanh,
    "Identity": lambda a: a,
    "Cast": lambda a, to: a.astype(TYPES[to]),
    "Gemm": lambda a, b, c, transB: a @ (b.T if transB else b) + c,
}
for node in model.graph.node:
    attributes = {a.name: onnx.helper.get_attribute_value(a) for a in node.attribute}
    inputs = [values[name] for name in node.input]
    values[node.output[0]] = OPERATORS[node.op_type](*inputs, **attributes)

worst = np.abs(values["target"] - recorded).max()
print(f"{recorded.size} actions, largest difference {worst:.2g}")
sys.exit(0 if recorded.size and worst < 1e-6 else 1)
