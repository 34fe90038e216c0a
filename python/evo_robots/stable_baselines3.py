"""Environments for Stable-Baselines3, and its policies back to the tools."""

from __future__ import annotations

import os
from typing import Any, Sequence

import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env.base_vec_env import VecEnv

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
        self.inner.step_async(actions)

    def step_wait(self):
        observations, rewards, terminated, truncated, found = self.inner.step_wait()
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
                     **arguments: Any) -> None:
    """The deterministic policy of an on-policy model with an MLP of tanh layers."""
    from torch import nn

    from .files import write_policy

    layers = []
    for module in [*model.policy.mlp_extractor.policy_net, model.policy.action_net]:
        if isinstance(module, nn.Linear):
            layers.append((module.weight.detach().cpu().numpy(), module.bias.detach().cpu().numpy()))
        elif not isinstance(module, nn.Tanh):
            raise ValueError(f"a policy may have Linear and Tanh layers, not {module}")
    write_policy(path, simulator, robot, layers, steps=model.num_timesteps,
                 created_by="stable-baselines3", **arguments)
