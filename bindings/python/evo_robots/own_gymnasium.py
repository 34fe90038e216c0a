"""Tasks of one's own with Gymnasium's interface."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from .environment import RENDERING, Filmed
from .own import Task, TaskEnvironments

__all__ = ["ManyEnvironments", "OneEnvironment"]


def _spaces(envs: TaskEnvironments) -> tuple[Box, Box]:
    return (Box(-np.inf, np.inf, (envs.num_observations,), np.float64),
            Box(envs.action_low, envs.action_high, (envs.num_actuators,), np.float64))


class OneEnvironment(Filmed):
    """arguments: of TaskEnvironments, such as seed and jitter."""

    def __init__(self, task: Task, robot: Any, *, render_mode: str | None = None, width: int = 600,
                 height: int = 300, **arguments: Any) -> None:
        self._envs = TaskEnvironments(task, robot, **arguments)
        self._begin_film(self._envs.sims, task.hold, render_mode, width, height)
        self.observation_space, self.action_space = _spaces(self._envs)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None):
        super().reset(seed=seed)
        observations = self._envs.reset(seed=seed)
        self._note(first=True)
        return observations[0], {}

    def step(self, action: Any):
        observations, rewards, terminated, truncated = self._envs.step(np.asarray(action)[None])
        self._note()
        return observations[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), {}


class ManyEnvironments(VectorEnv):
    """Those that ended are reset in their next step."""

    def __init__(self, task: Task, robot: Any, num_envs: int, **arguments: Any) -> None:
        self._envs = TaskEnvironments(task, robot, num_envs, **arguments)
        self.num_envs = num_envs
        self.metadata = {**RENDERING, "autoreset_mode": AutoresetMode.NEXT_STEP}
        self.single_observation_space, self.single_action_space = _spaces(self._envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._ended = np.zeros(num_envs, bool)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None):
        super().reset(seed=seed)
        self._ended[:] = False
        return self._envs.reset(seed=seed), {}

    def step(self, actions: Any):
        begun = self._ended
        observations, rewards, terminated, truncated = self._envs.step(actions)
        if begun.any():
            observations = self._envs.reset(begun)
            rewards, terminated, truncated = (
                np.where(begun, 0, values).astype(values.dtype)
                for values in (rewards, terminated, truncated))
        self._ended = terminated | truncated
        return observations, rewards, terminated, truncated, {}
