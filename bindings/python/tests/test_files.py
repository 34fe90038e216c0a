"""Files of the tools as arrays; needs h5py."""
import json
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

from evo_robots import Simulator, Trained, files, find_tool, robot_document

SMALL = np.array([[3, 4], [4, 3]])


def tool(name, *arguments):
    return subprocess.run([find_tool(name), *map(str, arguments)], capture_output=True, text=True,
                          check=True).stdout


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.robot = self.folder / "robot.json"
        self.robot.write_text(json.dumps(robot_document(SMALL)))

    def test_rollouts_and_actions(self):
        rng = np.random.default_rng(0)
        actions = rng.uniform(0.6, 1.6, (25, 4))
        files.write_actions(self.folder / "actions.h5", actions)
        said = json.loads(tool("evo-eval", "--task", "Walker-v0", "--actions",
                               self.folder / "actions.h5", "--rollout", self.folder / "walk.h5",
                               self.robot))
        with self.assertRaisesRegex(ValueError, "steps, actuators"):
            files.write_actions(self.folder / "flat.h5", actions.ravel())
        [episode] = files.read_rollout(self.folder / "walk.h5")
        np.testing.assert_array_equal(episode.actions, actions)
        self.assertAlmostEqual(episode.rewards.sum(), said["fitness"], places=12)
        self.assertEqual(episode.observations.shape[0], 26)
        self.assertEqual(episode.positions.shape[::2], (26, 2))

    def test_a_trained_policy_acts_as_in_evo_eval(self):
        tool("evo-train", self.robot, "--task", "Walker-v0", "--steps", 4096, "--out-dir",
             self.folder, "-o", self.folder / "trained.json", "-q")
        [trained] = files.read_robots(self.folder / "trained.json")
        policy = Trained.read(self.folder / trained["policy"])
        tool("evo-eval", self.folder / "trained.json", "--rollout", self.folder / "walk.h5")
        [episode] = files.read_rollout(self.folder / "walk.h5")
        np.testing.assert_allclose(policy.act(episode.observations[:-1]), episode.actions,
                                   atol=1e-5)

    def test_a_network_of_ones_own_goes_back_to_the_tools(self):
        rng = np.random.default_rng(1)
        with Simulator("Walker-v0", SMALL) as simulator:
            length = int(simulator.observation_lengths[0])
            layers = [(rng.normal(size=(8, length)), rng.normal(size=8)),
                      (rng.normal(size=(4, 8)), rng.normal(size=4))]
            files.write_policy(self.folder / "own.policy.h5", simulator, robot_document(SMALL),
                               layers, offset=1.1)
            policy = Trained.read(self.folder / "own.policy.h5")
            state = simulator.reset(seed=0, episode=0)
            total = 0.0
            for _ in range(100):
                state = simulator.step(policy.act(state.observations))
                total += state.rewards[0]
        said = json.loads(tool("evo-eval", self.robot, "--policy", self.folder / "own.policy.h5",
                               "--max-steps", 100))
        self.assertAlmostEqual(said["fitness"], total, delta=1e-2 * max(1, abs(total)))
        tool("evo-inspect", self.folder / "own.policy.h5")


if __name__ == "__main__":
    unittest.main()
