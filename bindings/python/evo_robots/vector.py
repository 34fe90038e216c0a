"""Many environments of one robot, stepped together, with Gymnasium's interface:
they fill the simulator's vector lanes, which SyncVectorEnv cannot."""

from __future__ import annotations

from typing import Any, Mapping

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from .environment import (RENDERING, action_box, known_render_mode, observation_box, only_robot,
                          the_robot, time_limit)
from .simulator import Simulator, State, env_mask

__all__ = ["VectorEnvironment"]


class VectorEnvironment(VectorEnv):
    """``num_envs`` episodes of a robot; arguments as of Environment, and
    ``jobs``, the threads of the simulator (results do not depend on it).

    Environment i meets episodes i, i + num_envs, .. of the seed, each with draws
    of its own. An environment whose simulation fails is truncated, with
    ``infos["unstable"]``.
    """

    def __init__(
        self,
        task: str,
        body: Any = None,
        connections: Any = None,
        *,
        num_envs: int = 1,
        stiffness: Any = None,
        robot: Any = None,
        render_mode: str | None = None,
        width: int = 600,
        height: int = 300,
        jitter: float = 0.0,
        max_episode_steps: int | None = None,
        seed: int = 0,
        jobs: int = 1,
        physics: str | None = None,
        settings: Mapping[str, Any] | None = None,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
    ) -> None:
        self.render_mode = known_render_mode(render_mode)
        self.simulator = only_robot(
            Simulator(task, the_robot(body, connections, robot), num_envs, seed=seed, jobs=jobs,
                      stiffness=stiffness, physics=physics, settings=settings), num_envs)
        self._limit = time_limit(max_episode_steps, self.simulator)
        self._steps = np.zeros(num_envs, int)
        self.num_envs = num_envs
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {**RENDERING, "autoreset_mode": self.autoreset_mode}
        self.single_observation_space = observation_box(
            int(self.simulator.observation_lengths[0]))
        self.single_action_space = action_box(
            self.simulator, int(self.simulator.action_lengths[0]))
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._size = (width, height)
        self._jitter = jitter
        self._ended = np.zeros(num_envs, bool)

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None):
        """seed: one, or one for each environment, whose first episode it then meets."""
        each = np.ndim(seed) > 0
        super().reset(seed=None if each else seed)
        options = dict(options or {})
        mask = options.pop("reset_mask", None)
        chosen = np.arange(self.num_envs) if mask is None else np.flatnonzero(env_mask(mask, self.num_envs))
        if not each:
            return self._reset(chosen, seed=seed, **options).observations, {}
        if len(seed) != self.num_envs:
            raise ValueError(f"seed: {len(seed)} seeds for {self.num_envs} environments")
        for e in chosen:
            first = {} if seed[e] is None else {"episode": 0}
            self._reset([e], seed=seed[e], **{**first, **options})
        return self.simulator.state().observations, {}

    def step(self, actions: Any):
        moving = None
        if self.autoreset_mode == AutoresetMode.NEXT_STEP and self._ended.any():
            moving = ~self._ended
            self._reset(np.flatnonzero(self._ended))
        state = self.simulator.step(actions, moving)
        unstable = state.status != 0
        rewards, terminated = state.rewards, state.terminated
        self._steps += 1 if moving is None else moving
        truncated = (self._steps >= self._limit) | unstable
        if moving is not None:  # those reset show their start
            rewards = np.where(moving, rewards, 0.0)
            terminated = terminated & moving
            truncated = truncated & moving
        infos: dict[str, Any] = {"unstable": unstable} if unstable.any() else {}
        observations = state.observations
        self._ended = terminated | truncated
        if self.autoreset_mode == AutoresetMode.SAME_STEP and self._ended.any():
            final = np.full(self.num_envs, None, object)
            for e in np.flatnonzero(self._ended):
                final[e] = observations[e]
            infos.update(final_obs=final, _final_obs=self._ended.copy(), final_info={},
                         _final_info=self._ended.copy())
            observations = self._reset(np.flatnonzero(self._ended)).observations
        return observations, rewards, terminated, truncated, infos

    def render(self) -> tuple[np.ndarray, ...] | None:
        if self.render_mode is None:
            gymnasium.logger.warn("render() needs render_mode='rgb_array'")
            return None
        return tuple(self.simulator.picture(e, *self._size) for e in range(self.num_envs))

    def close_extras(self, **_: Any) -> None:
        if "simulator" in self.__dict__:  # __del__ of one that was refused comes here, too
            self.simulator.close()

    def _reset(self, environments, **options: Any) -> State:
        state = self.simulator.reset(environments, **{"jitter": self._jitter, **options})
        self._steps[environments] = 0
        self._ended[environments] = False
        return state
