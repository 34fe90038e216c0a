"""Published tables, rebuilt with the same columns and the structure of the same classes: the
originals were not at hand. Needs pyarrow, PyTorch, h5py."""
import io
import json
import os
import subprocess
import sys
import tempfile
import types
import unittest
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.parquet
import torch
from torch import nn

import evo_robots
from evo_robots.datasets import read_evogym

BODY = np.array([[1, 3, 3, 3, 1], [4, 2, 2, 2, 4], [4, 3, 1, 3, 4], [4, 0, 0, 0, 4],
                 [4, 0, 0, 0, 4]])


def archive(observations, actions):
    """A policy as the training code of that time kept it, its classes in modules of their names."""
    names = ("Policy", "MLPBase", "DiagGaussian", "AddBias")
    module = types.ModuleType("a2c_ppo_acktr_model")
    made = {name: type(name, (nn.Module,), {"__module__": module.__name__}) for name in names}
    made["RunningMeanStd"] = type("RunningMeanStd", (), {"__module__": module.__name__})
    vars(module).update(made)
    sys.modules[module.__name__] = module
    policy, base, dist, bias = (made[name]() for name in names)
    base.actor = nn.Sequential(nn.Linear(observations, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh())
    base.critic = nn.Sequential(nn.Linear(observations, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh())
    base.critic_linear = nn.Linear(64, 1)
    bias._bias = nn.Parameter(torch.zeros(actions, 1))
    dist.fc_mean, dist.logstd = nn.Linear(64, actions), bias
    policy.base, policy.dist = base, dist
    rms = made["RunningMeanStd"]()
    rng = np.random.default_rng(0)
    rms.mean, rms.var, rms.count = rng.normal(size=observations), rng.uniform(0.5, 2, observations), 1e4
    file = io.BytesIO()
    torch.save((policy, rms), file)
    del sys.modules[module.__name__]

    def act(seen):
        normalised = np.clip((seen - rms.mean) / np.sqrt(rms.var + 1e-8), -10, 10)
        with torch.no_grad():
            return np.clip(1 + dist.fc_mean(base.actor(torch.tensor(normalised, dtype=torch.float32))).numpy(),
                           0.6, 1.6)

    return file.getvalue(), act


class Table(unittest.TestCase):
    def test_robots_and_policies(self):
        links = evo_robots.get_full_connectivity(BODY)
        with evo_robots.Simulator("Walker-v0", BODY) as simulator:
            blob, act = archive(int(simulator.observation_lengths[0]), int(simulator.action_lengths[0]))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "policies.parquet")

            def table(**changed):
                row = {"uid": "a1", "body": BODY.tolist(), "connections": links.tolist(), "reward": 4.5,
                       "env_name": "Walker-v0", "generated_by": "Genetic Algorithm", "policy_blob": blob, **changed}
                pyarrow.parquet.write_table(pyarrow.Table.from_pylist([row, {**row, "uid": "a2"}]), path)

            table()
            robots = list(read_evogym(path, policies=folder))
            self.assertEqual([r["origin"]["uid"] for r in robots], ["a1", "a2"])
            self.assertEqual((robots[0]["fitness"], robots[0]["task"]), (4.5, "Walker-v0"))
            lines = "\n".join(map(json.dumps, robots))
            best = subprocess.run([evo_robots.find_tool("evo-select"), "--keep", "1"], input=lines,
                                  capture_output=True, text=True, check=True).stdout
            self.assertEqual(json.loads(best)["id"], evo_robots.Robot(BODY).id)
            seen = np.random.default_rng(1).normal(0, 2, (20, blob and simulator.info["robots"][0]["observation_length"]))
            np.testing.assert_allclose(evo_robots.Trained.read(robots[0]["policy"]).act(seen), act(seen), atol=1e-5)
            subprocess.run([evo_robots.find_tool("evo-eval"), robots[0]["policy"]], check=True,
                           capture_output=True)

            table(policy_blob=b"PK nothing")
            with self.assertRaisesRegex(ValueError, "row 0 .uid a1.*no archive of PyTorch"):
                list(read_evogym(path, policies=folder))
            self.assertEqual(len(list(read_evogym(path))), 2)
            table(env_name="Walker-v0", body=[[0, 9]])
            with self.assertRaisesRegex(ValueError, "row 0"):
                list(read_evogym(path))
            pyarrow.parquet.write_table(pyarrow.table({"uid": ["a"]}), path)
            with self.assertRaisesRegex(ValueError, "no column body"):
                list(read_evogym(path))

    def test_code_in_a_policy_is_not_run(self):
        class Evil:
            def __reduce__(self):
                return os.system, ("touch ran",)

        file = io.BytesIO()
        torch.save((Evil(), Evil()), file)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "policies.parquet")
            pyarrow.parquet.write_table(pyarrow.Table.from_pylist([{
                "uid": "a", "body": BODY.tolist(), "connections": evo_robots.get_full_connectivity(BODY).tolist(),
                "reward": 1.0, "env_name": "Walker-v0", "policy_blob": file.getvalue()}]), path)
            with self.assertRaisesRegex(ValueError, "no Linear layer"):
                list(read_evogym(path, policies=folder))
            self.assertFalse(os.path.exists("ran"))
            self.assertEqual(os.listdir(folder), ["policies.parquet"])

    def test_a_policy_names_no_address_and_no_place(self):
        """Arrays of objects hold addresses of memory; a uid becomes the name of a file."""
        def array(kind, shape, data):
            class Array:
                def __reduce__(self):
                    made = np.empty(0).__reduce__()
                    return made[0], made[1], (1, shape, np.dtype(kind), False, data)
            return Array()

        with evo_robots.Simulator("Walker-v0", BODY) as simulator:
            lengths = int(simulator.observation_lengths[0]), int(simulator.action_lengths[0])
        rms = types.SimpleNamespace()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "policies.parquet")

            def refused(text, uid="a", mean=None, blob=None):
                if blob is None:
                    file = io.BytesIO()
                    rms.mean = mean
                    torch.save((None, rms), file)
                    blob = file.getvalue()
                pyarrow.parquet.write_table(pyarrow.Table.from_pylist([{
                    "uid": uid, "body": BODY.tolist(), "reward": 1.0, "env_name": "Walker-v0",
                    "connections": evo_robots.get_full_connectivity(BODY).tolist(),
                    "policy_blob": blob}]), path)
                with self.assertRaisesRegex(ValueError, text):
                    list(read_evogym(path, policies=Path(folder, "in")))

            refused("numbers of the type 'O8'", mean=array("O", (1,), b"A" * 8))
            refused("another shape", mean=array("f8", (1 << 40,), b"A" * 8))
            refused("another shape", mean=array("f8", (-1,), b"A" * 8))
            refused("tuple is expected", mean=array("f8", [1], b"A" * 8))
            good, _ = archive(*lengths)
            for uid in ("../out", "/tmp/out", "..", "a/b", ""):
                refused("name of a file", uid=uid, blob=good)
            self.assertFalse(list(Path(folder).glob("*out*")))


if __name__ == "__main__":
    unittest.main()
