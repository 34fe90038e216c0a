"""Tasks of one's own with Gymnasium's interface."""

from __future__ import annotations

from collections import deque
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from .environment import RENDERING, known_render_mode
from .own import Task, TaskEnvironments
from .video import MOST_STEPS, Video

__all__ = ["ManyEnvironments", "OneEnvironment"]


def _spaces(envs: TaskEnvironments) -> tuple[Box, Box]:
    return (Box(-np.inf, np.inf, (envs.num_observations,), np.float64),
            Box(envs.action_low, envs.action_high, (envs.num_actuators,), np.float64))


class OneEnvironment(gymnasium.Env):
    metadata = RENDERING

    def __init__(self, task: Task, robot: Any, *, render_mode: str | None = None, width: int = 600,
                 height: int = 300) -> None:
        self.render_mode = known_render_mode(render_mode)
        self._envs = TaskEnvironments(task, robot)
        self.observation_space, self.action_space = _spaces(self._envs)
        self._size = (width, height)
        self._film: deque[np.ndarray] = deque(maxlen=MOST_STEPS + 1)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None):
        super().reset(seed=seed)
        observations = self._envs.reset()
        self._film.clear()
        self._film.append(self._envs.sims.positions[0].copy())
        return observations[0], {}

    def step(self, action: Any):
        observations, rewards, terminated, truncated = self._envs.step(np.asarray(action)[None])
        self._film.append(self._envs.sims.positions[0].copy())
        return observations[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), {}

    def render(self) -> np.ndarray | None:
        return None if self.render_mode is None else self._envs.sims.picture(0, *self._size)

    def video(self, width: int = 480, height: int = 240, fps: float = 25.0,
              speed: float = 1.0) -> Video:
        """The episode so far: plays in a notebook, ``save(path)`` writes it."""
        return Video.of(list(self._film), lambda positions: self._envs.sims.picture(
            0, width, height, positions=positions), fps=fps, speed=speed)


class ManyEnvironments(VectorEnv):
    """Those that ended are reset in their next step."""

    def __init__(self, task: Task, robot: Any, num_envs: int, jobs: int = 1) -> None:
        self._envs = TaskEnvironments(task, robot, num_envs, jobs=jobs)
        self.num_envs = num_envs
        self.metadata = {**RENDERING, "autoreset_mode": AutoresetMode.NEXT_STEP}
        self.single_observation_space, self.single_action_space = _spaces(self._envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._ended = np.zeros(num_envs, bool)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None):
        super().reset(seed=seed)
        self._ended[:] = False
        return self._envs.reset(), {}

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
