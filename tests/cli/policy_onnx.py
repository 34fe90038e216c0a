#!/usr/bin/python3
"""policy_onnx.py POLICY.onnx ROLLOUT.h5: the graph is valid ONNX, and evaluated operator by
operator it gives the recorded actions to 1e-6; so it does by onnxruntime, where Python has it,
all observations at once and one by one.

policy_onnx.py POLICY.onnx POLICY.h5 ROBOT: the same of a modular policy for one robot, which
acts in a few environments of its task; EVO_SOURCE is the checkout."""
import os
import sys

import h5py
import numpy as np
import onnx
from onnx import numpy_helper

TYPES = {onnx.TensorProto.FLOAT: np.float32, onnx.TensorProto.DOUBLE: np.float64}
OPERATORS = {
    "Sub": lambda a, b: a - b,
    "Div": lambda a, b: a / b,
    "Add": lambda a, b: a + b,
    "Mul": lambda a, b: a * b,
    "Clip": np.clip,
    "Tanh": np.tanh,
    "Sin": np.sin,
    "Identity": lambda a: a,
    "Cast": lambda a, to: a.astype(TYPES[to]),
    "Gemm": lambda a, b, c, transB: a @ (b.T if transB else b) + c,
    "MatMul": lambda a, b: a @ b,
    "Concat": lambda *a, axis: np.concatenate(a, axis),
    "Gather": lambda a, b, axis: np.take(a, b, axis),
    "Unsqueeze": lambda a, axes: np.expand_dims(a, tuple(axes)),
    "Squeeze": lambda a, axes: np.squeeze(a, tuple(axes)),
}


def evaluated(model, values):
    """The target of these inputs, by numpy."""
    onnx.checker.check_model(model, full_check=True)
    values = dict(values)
    values.update((t.name, numpy_helper.to_array(t)) for t in model.graph.initializer)
    for node in model.graph.node:
        attributes = {a.name: onnx.helper.get_attribute_value(a) for a in node.attribute}
        inputs = [values[name] for name in node.input]
        values[node.output[0]] = OPERATORS[node.op_type](*inputs, **attributes)
    return values["target"]


def run(path, inputs):
    """The same by onnxruntime, or nothing where it is missing."""
    try:
        import onnxruntime
    except ImportError:
        return []
    session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
    count = len(next(iter(inputs.values())))
    parts = [(0, count), *((k, k + 1) for k in range(20))]
    whole, *single = (session.run(["target"], {name: value[a:b] for name, value in inputs.items()})[0] for a, b in parts)
    print(f"onnxruntime {onnxruntime.__version__}")
    return [whole, np.concatenate(single + [whole[20:]])]


def episode(rollout):
    with h5py.File(rollout) as file:
        return {"observation": file["episode_0/observations"][:-1]}, file["episode_0/actions"][:]


def modular_episode(policy, robot):
    sys.path.insert(0, os.environ["EVO_SOURCE"] + "/bindings/python")
    import evo_robots

    controller = evo_robots.Trained.read(policy)
    simulator = evo_robots.Simulator("Walker-v0", robot, envs=3)
    simulator.reset(seed=1, jitter=0.01)
    rng = np.random.default_rng(1)
    seen, recorded = {"local": [], "task": [], "step": []}, []
    for _ in range(40):
        (local,), task = simulator.look()
        for name, value in (("local", local), ("task", task), ("step", simulator.steps[:, None].astype(float))):
            seen[name].append(value)
        recorded.append(simulator.act(controller))
        simulator.step(recorded[-1] + rng.uniform(-0.2, 0.2, recorded[-1].shape))
    return {name: np.concatenate(values) for name, values in seen.items()}, np.concatenate(recorded)


if __name__ == "__main__":
    model = onnx.load(sys.argv[1])
    # What a controller saw, and what it did.
    inputs, recorded = (episode if len(sys.argv) == 3 else modular_episode)(*sys.argv[2:])
    wanted = {value.name for value in model.graph.input}
    inputs = {name: value for name, value in inputs.items() if name in wanted}
    worst = 0.0
    for found in (evaluated(model, inputs), *run(sys.argv[1], inputs)):
        assert found.shape == recorded.shape, (found.shape, recorded.shape)
        worst = max(worst, np.abs(found - recorded).max())
    print(f"{recorded.size} actions, largest difference {worst:.2g}")
    sys.exit(0 if recorded.size and worst < 1e-6 else 1)
