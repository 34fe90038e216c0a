"""One environment, with Gymnasium's interface."""

from __future__ import annotations

from collections import deque
from typing import Any, Mapping

import gymnasium
import numpy as np
from gymnasium.spaces import Box

from .library import EvoError
from .robots import document_of
from .simulator import STATUS, Simulator
from .video import MOST_STEPS, STEPS_PER_SECOND, Video

__all__ = ["Environment", "action_box", "observation_box", "unlimited"]


def observation_box(length: int) -> Box:
    """The benchmark's bounds, which nothing enforces."""
    return Box(-100.0, 100.0, (length,), np.float64)


def action_box(simulator: Simulator, length: int) -> Box:
    """Targets of the actuators, as shares of their rest length."""
    return Box(simulator.info["action_low"], simulator.info["action_high"], (length,), np.float64)


RENDERING = {"render_modes": ["rgb_array"], "render_fps": STEPS_PER_SECOND}


def the_robot(body: Any, connections: Any, robot: Any) -> Any:
    """What Simulator takes, of the two ways to name a robot."""
    if (body is None) == (robot is None):
        raise ValueError("give a body (with or without connections), or a robot")
    return robot if body is None else document_of(body, connections)


def known_render_mode(mode: str | None) -> str | None:
    if mode not in (None, *RENDERING["render_modes"]):
        raise ValueError(f"render_mode: {mode!r} is not 'rgb_array' or None")
    return mode


def time_limit(max_episode_steps: int | None, simulator: Simulator) -> float:
    """Steps after which episodes are truncated: the task's for None, none for -1."""
    if max_episode_steps is None:
        return simulator.info["episode_steps"]
    if max_episode_steps != -1 and max_episode_steps < 1:
        raise ValueError(f"max_episode_steps: {max_episode_steps} is neither -1 nor above 0")
    return np.inf if max_episode_steps == -1 else max_episode_steps


def only_robot(simulator: Simulator, envs: int) -> Simulator:
    """Refuses a simulator of more than one robot."""
    robots = simulator.num_envs // envs
    if robots != 1:
        raise ValueError(f"one robot is expected, not {robots}; Simulator takes several")
    return simulator


class Filmed(gymnasium.Env):
    """Draws itself, and keeps what was at every step of the episode."""

    metadata = RENDERING

    def _begin_film(self, shown: Any, hold: int, render_mode: str | None, width: int,
                    height: int) -> None:
        """shown: has ``positions`` and ``picture``. hold: control steps of a step."""
        self.render_mode = known_render_mode(render_mode)
        self._shown, self._hold, self._size = shown, hold, (width, height)
        self._film: deque[np.ndarray] = deque(maxlen=MOST_STEPS + 1)  # positions

    def _note(self, first: bool = False) -> None:
        if first:
            self._film.clear()
        self._film.append(self._shown.positions[0].copy())

    def render(self) -> np.ndarray | None:
        if self.render_mode is None:
            gymnasium.logger.warn("render() needs gymnasium.make(..., render_mode='rgb_array')")
            return None
        return self._shown.picture(0, *self._size)

    def video(self, width: int = 480, height: int = 240, fps: float = 25.0,
              speed: float = 1.0) -> Video:
        """The episode so far (its last 2000 steps): plays in a notebook, ``save(path)`` writes it."""
        return Video.of(list(self._film), lambda positions: self._shown.picture(
            0, width, height, positions=positions), fps=fps, speed=speed / self._hold, says=repr(self))


class Environment(Filmed):
    """A robot in a task.

    task: a benchmark task by name, or a task file of your own. body,
    connections, stiffness: see ``evo_robots.Robot``; ``robot`` takes a file or a document
    instead. physics, settings: as --physics of the tools. jitter: every start coordinate is moved by up to this, voxels.
    max_episode_steps: steps after which an episode is truncated [the task's];
    -1 for none.

    reset(options=...) takes ``draws``, ``episode`` and ``jitter``. Without a
    seed the environment continues in the episodes of the one before (first 0), so
    that two runs of a program are the same.

    A copy (copy.deepcopy, pickle) continues from where the environment is. ``video()`` shows the
    episode so far.
    """

    def __init__(
        self,
        task: str,
        body: Any = None,
        connections: Any = None,
        *,
        stiffness: Any = None,
        robot: Any = None,
        render_mode: str | None = None,
        width: int = 600,
        height: int = 300,
        jitter: float = 0.0,
        max_episode_steps: int | None = None,
        seed: int = 0,
        physics: str | None = None,
        settings: Mapping[str, Any] | None = None,
    ) -> None:
        known_render_mode(render_mode)
        self.simulator = only_robot(
            Simulator(task, the_robot(body, connections, robot), seed=seed,
                      stiffness=stiffness, physics=physics, settings=settings), 1)
        self._begin_film(self.simulator, self.simulator.info["hold"], render_mode, width, height)
        self._limit = time_limit(max_episode_steps, self.simulator)
        self._steps, self._return = 0, 0.0
        self.observation_space = observation_box(int(self.simulator.observation_lengths[0]))
        self.action_space = action_box(self.simulator, int(self.simulator.action_lengths[0]))
        self._jitter = jitter

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None):
        super().reset(seed=seed)
        options = options or {}
        unknown = set(options) - {"draws", "episode", "jitter"}
        if unknown:
            raise ValueError(f"options: {sorted(unknown)} are not known")
        state = self.simulator.reset(seed=seed, **{"jitter": self._jitter, **options})
        self._steps, self._return = 0, 0.0
        self._note(first=True)
        return state.observations[0], {}

    def step(self, action):
        simulator = self.simulator
        simulator.advance(action)
        if simulator.status[0] != 0:
            raise EvoError(f"the environment is {STATUS[simulator.status[0]]}: reset it")
        self._steps += 1
        reward = float(simulator.rewards[0])
        self._return += reward
        self._note()
        return (simulator.observations[0].copy(), reward, bool(simulator.terminated[0]),
                self._steps >= self._limit, {})

    def close(self) -> None:
        self.simulator.close()

    def __repr__(self) -> str:
        info = self.simulator.info
        return (f"<{info['task']}, robot {info['robots'][0]['id']}, step {self._steps}, "
                f"return {self._return:.3f}>")

    __str__ = __repr__

    # ---- what the benchmark's environments are asked beyond Gymnasium ---------

    def object_pos_at_time(self, object_name: str = "robot") -> np.ndarray:
        """[2, n], now, raw units (the benchmark's ``multiply by voxel size`` done)."""
        return self._points_of("positions", object_name)

    def object_vel_at_time(self, object_name: str = "robot") -> np.ndarray:
        return self._points_of("velocities", object_name)

    def _points_of(self, what: str, name: str) -> np.ndarray:
        objects = self.simulator.objects()
        if name not in objects:
            raise ValueError(f"no object {name!r} in this task; there are: " + ", ".join(objects))
        return getattr(self.simulator, what)[0, objects[name]].T.copy()


def unlimited(**arguments: Any) -> Environment:
    """What gymnasium.make makes: its wrapper TimeLimit truncates episodes."""
    return Environment(**{"max_episode_steps": -1, **arguments})
