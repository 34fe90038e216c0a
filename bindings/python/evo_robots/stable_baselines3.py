"""Environments for Stable-Baselines3, and its policies back to the tools."""

from __future__ import annotations

import os
from typing import Any, Sequence

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.torch_layers import FlattenExtractor
from stable_baselines3.common.vec_env import VecCheckNan, VecMonitor, VecNormalize, VecVideoRecorder
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvWrapper

from .files import write_policy  # needs h5py, which is missed before a training
from .own import Trained
from .vector import VectorEnvironment

__all__ = ["Sb3Environments", "write_sb3_policy"]


class Sb3Environments(VecEnv):
    """A VecEnv over VectorEnvironment; arguments as there."""

    def __init__(self, task: str, body: Any = None, connections: Any = None, **arguments: Any):
        self.inner = VectorEnvironment(task, body, connections,
                                       autoreset_mode=AutoresetMode.SAME_STEP, **arguments)
        self._returns = np.zeros(self.inner.num_envs)
        self._lengths = np.zeros(self.inner.num_envs, int)
        self.render_mode = self.inner.render_mode
        super().__init__(self.inner.num_envs, self.inner.single_observation_space,
                         self.inner.single_action_space)

    def reset(self) -> np.ndarray:
        seed = self._seeds[0]
        self._reset_seeds()
        self._returns[:] = 0
        self._lengths[:] = 0
        return self.inner.reset(seed=seed)[0]

    def step_async(self, actions: np.ndarray) -> None:
        self._actions = actions

    def step_wait(self):
        observations, rewards, terminated, truncated, found = self.inner.step(self._actions)
        self._returns += rewards
        self._lengths += 1
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for e in np.flatnonzero(terminated | truncated):
            infos[e] = {
                "terminal_observation": found["final_obs"][e],
                "TimeLimit.truncated": bool(truncated[e] and not terminated[e]),
                "episode": {"r": float(self._returns[e]), "l": int(self._lengths[e]), "t": 0.0}}
            self._returns[e] = 0
            self._lengths[e] = 0
        return observations, rewards, terminated | truncated, infos

    def close(self) -> None:
        self.inner.close()

    def get_images(self) -> Sequence[np.ndarray | None]:
        return self.inner.render() or [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        return [getattr(self.inner, attr_name)] * len(self._get_indices(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        setattr(self.inner, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any):
        return [getattr(self.inner, method_name)(*args, **kwargs)
                for _ in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        return [False] * len(self._get_indices(indices))


def write_sb3_policy(path: str | os.PathLike, model: Any, simulator: Any, robot: dict[str, Any],
                     vec_normalize: VecNormalize | None | bool = None, **arguments: Any) -> None:
    """The deterministic policy of an on-policy model with an MLP of tanh layers.

    The running normaliser of a VecNormalize is taken from the model's environments;
    for a model without any, ``vec_normalize`` names it, or says False: there was none.
    Refused with a ValueError: what a policy file cannot hold, and whatever makes the
    written policy act otherwise than the model does.
    """
    layers = _layers(model, simulator)
    normalizer = _normalizer(model, vec_normalize)
    if normalizer is not None:
        arguments = {"mean": normalizer.obs_rms.mean, "variance": normalizer.obs_rms.var,
                     "clip": normalizer.clip_obs, "epsilon": normalizer.epsilon, **arguments}
    write_policy(path, simulator, robot, layers, steps=model.num_timesteps,
                 squash=bool(model.policy.squash_output), created_by="stable-baselines3",
                 **arguments)
    _compare(path, model, normalizer)


def _layers(model: Any, simulator: Any) -> list[tuple[np.ndarray, np.ndarray]]:
    from torch import nn

    policy = model.policy
    if not hasattr(policy, "mlp_extractor") or hasattr(policy, "lstm_actor"):
        raise ValueError(f"{type(policy).__name__} is no on-policy MLP, such as PPO's MlpPolicy")
    if not isinstance(policy.features_extractor, FlattenExtractor):
        raise ValueError("a policy sees its observations as they are, not through a "
                         + type(policy.features_extractor).__name__)
    bounds = simulator.info["action_low"], simulator.info["action_high"]
    space = model.action_space
    if space.shape != (simulator.action_lengths[0],) or not (
            np.allclose(space.low, bounds[0]) and np.allclose(space.high, bounds[1])):
        raise ValueError(f"the model acts in {space}; targets of this robot are "
                         f"{simulator.action_lengths[0]} numbers from {bounds[0]} to {bounds[1]}")
    layers = []
    for module in [*policy.mlp_extractor.policy_net, policy.action_net]:
        if isinstance(module, nn.Linear):
            layers.append((module.weight.detach().cpu().numpy(), module.bias.detach().cpu().numpy()))
        elif not isinstance(module, nn.Tanh):
            raise ValueError(f"a policy may have Linear and Tanh layers, not {module}")
    return layers


def _normalizer(model: Any, named: VecNormalize | None | bool) -> VecNormalize | None:
    """Of observations. Other wrappers may change what the model sees."""
    wrapper = model.get_env()
    if named is not None:
        found = named or None
    elif wrapper is None:
        raise ValueError("the model has no environments, whose VecNormalize might belong to it: "
                         "give vec_normalize=, or False if there was none")
    else:
        found = model.get_vec_normalize_env()
    while isinstance(wrapper, VecEnvWrapper):
        if not isinstance(wrapper, (VecNormalize, VecMonitor, VecCheckNan, VecVideoRecorder)):
            raise ValueError(f"what {type(wrapper).__name__} does to observations or actions "
                             "cannot be written")
        wrapper = wrapper.venv
    for env in getattr(wrapper, "envs", [])[:1]:
        while isinstance(env, gymnasium.Wrapper):
            if isinstance(env, (gymnasium.ObservationWrapper, gymnasium.ActionWrapper)):
                raise ValueError(f"what {type(env).__name__} does to observations or actions "
                                 "cannot be written")
            env = env.env
    return found if found is not None and found.norm_obs else None


def _compare(path: str | os.PathLike, model: Any, normalizer: VecNormalize | None) -> None:
    """Whether the file acts as the model does; removes it if not."""
    some = np.random.default_rng(0).normal(0.0, 2.0, (64, *model.observation_space.shape))
    seen = some if normalizer is None else normalizer.normalize_obs(some)
    wanted = model.predict(seen, deterministic=True)[0]
    found = Trained.read(path).act(some)
    if not np.allclose(wanted, found, atol=1e-3):
        os.unlink(path)
        raise ValueError("the policy cannot be written: its actions would differ from the model's "
                         f"by up to {np.abs(wanted - found).max():.3g}")
