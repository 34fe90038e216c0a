"""A PPO of Stable-Baselines3 trains on the environments, and its policy goes back
to the tools."""
import json
import subprocess
import tempfile
import unittest
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.env_checker import check_env

import evo_robots
from evo_robots.stable_baselines3 import Sb3Environments, write_sb3_policy

torch.set_num_threads(1)
BODY = np.array([[1, 3, 3, 3, 1], [4, 2, 2, 2, 4], [4, 3, 1, 3, 4], [4, 0, 0, 0, 4],
                 [4, 0, 0, 0, 4]])


class Training(unittest.TestCase):
    def test_the_checker_finds_nothing_wrong(self):
        env = gymnasium.make("evo/Walker-v0", body=BODY)
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=".*normalize")
            check_env(env.unwrapped)
        env.close()

    def test_ppo_learns_and_its_policy_goes_back_to_the_tools(self):
        envs = Sb3Environments("Walker-v0", BODY, num_envs=16)
        model = PPO("MlpPolicy", envs, n_steps=128, batch_size=256, n_epochs=4, gamma=0.99,
                    learning_rate=2.5e-4, seed=1, device="cpu")
        # Networks put out about 0 at first: around the rest length of the actuators.
        model.policy.action_net.bias.data.fill_(1.1)
        before = self.mean_return(model, envs)
        model.learn(32_768)
        after = self.mean_return(model, envs)
        self.assertGreater(after, before + 0.1)
        with tempfile.TemporaryDirectory() as folder:
            policy, robot = Path(folder, "sb3.policy.h5"), Path(folder, "robot.json")
            document = evo_robots.robot_document(BODY)
            robot.write_text(json.dumps(document))
            write_sb3_policy(policy, model, envs.inner.simulator, document)
            said = json.loads(subprocess.run(
                [evo_robots.find_tool("evo-eval"), policy, "--policy", policy,
                 "--rollout", Path(folder, "walk.h5")],
                capture_output=True, text=True, check=True).stdout)
            # Single precision sums differently in torch: the episodes drift apart slowly.
            self.assertAlmostEqual(said["fitness"], after, delta=0.1 * abs(after))
            subprocess.run([evo_robots.find_tool("evo-render"), Path(folder, "walk.h5"), "--sheet",
                            "4", "-o", Path(folder, "walk.png")], check=True)
        envs.close()

    @staticmethod
    def mean_return(model, envs):
        """Of one deterministic episode in every environment."""
        observations = envs.inner.reset(seed=0)[0]
        total = np.zeros(envs.num_envs)
        open_ = np.ones(envs.num_envs, bool)
        while open_.any():
            actions, _ = model.predict(observations, deterministic=True)
            observations, rewards, terminated, truncated, _ = envs.inner.step(actions)
            total += rewards * open_
            open_ &= ~(terminated | truncated)
        return float(total.mean())


if __name__ == "__main__":
    unittest.main()
