"""A PPO of Stable-Baselines3 trains on the environments, and its policy goes back
to the tools."""
import json
import tempfile
import unittest
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.vec_env import DummyVecEnv, VecFrameStack, VecNormalize

import evo_robots
from common import WALKER as BODY, tool
from evo_robots.stable_baselines3 import Sb3Environments, write_sb3_policy

torch.set_num_threads(1)


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
            said = json.loads(tool("evo-eval", policy, "--policy", policy, "--rollout", Path(folder, "walk.h5")))
            # Single precision sums differently in torch: the episodes drift apart slowly.
            self.assertAlmostEqual(said["fitness"], after, delta=0.1 * abs(after))
            tool("evo-render", Path(folder, "walk.h5"), "--strip", 4, "-o", Path(folder, "walk.png"))
        envs.close()

    def test_what_a_policy_holds_is_taken_over_and_the_rest_refused(self):
        document = evo_robots.robot_document(BODY)
        inner = Sb3Environments("Walker-v0", BODY, num_envs=4)
        simulator = inner.inner.simulator
        rng = np.random.default_rng(0)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "p.policy.h5")

            def written(model, **arguments):
                write_sb3_policy(path, model, simulator, document, **arguments)
                return evo_robots.Trained.read(path)

            # A normaliser with statistics of its own: 0.0313 would become -0.0255 without.
            envs = VecNormalize(inner, clip_obs=3.0, epsilon=1e-4)
            model = PPO("MlpPolicy", envs, n_steps=64, batch_size=64, seed=1, device="cpu")
            model.learn(256)
            seen = rng.normal(0, 2, (20, simulator.observation_lengths[0]))
            wanted = model.predict(envs.normalize_obs(seen), deterministic=True)[0]
            np.testing.assert_allclose(written(model).act(seen), wanted, atol=1e-5)
            model.save(Path(folder, "model"))
            alone = PPO.load(Path(folder, "model"), device="cpu")
            with self.assertRaisesRegex(ValueError, "vec_normalize"):
                written(alone)
            np.testing.assert_allclose(written(alone, vec_normalize=envs).act(seen), wanted,
                                       atol=1e-5)
            wanted = alone.predict(seen, deterministic=True)[0]
            np.testing.assert_allclose(written(alone, vec_normalize=False).act(seen), wanted,
                                       atol=1e-5)
            # Squashed, with noise that depends on the state.
            for squash in (True, False):
                model = PPO("MlpPolicy", inner, n_steps=64, batch_size=64, seed=1, device="cpu",
                            use_sde=True, policy_kwargs={"squash_output": squash})
                wanted = model.predict(seen, deterministic=True)[0]
                np.testing.assert_allclose(written(model).act(seen), wanted, atol=1e-5)
            path.unlink()
            one = lambda wrap: DummyVecEnv([lambda: wrap(
                gymnasium.make("evo/Walker-v0", body=BODY))])
            for model, reason in (
                    (SAC("MlpPolicy", inner, device="cpu"), "SACPolicy"),
                    (PPO("MlpPolicy", VecFrameStack(inner, 2), device="cpu"), "VecFrameStack"),
                    (PPO("MlpPolicy", one(gymnasium.wrappers.NormalizeObservation), device="cpu"),
                     "NormalizeObservation"),
                    (PPO("MlpPolicy", one(lambda env: gymnasium.wrappers.RescaleAction(env, -1, 1)),
                         device="cpu"), "acts in"),
                    (PPO("MlpPolicy", inner, policy_kwargs={"activation_fn": torch.nn.ReLU},
                         device="cpu"), "ReLU")):
                with self.assertRaisesRegex(ValueError, reason):
                    written(model)
                self.assertFalse(path.exists())
        inner.close()

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
