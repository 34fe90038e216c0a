"""The base classes for tasks of one's own. Needs Gymnasium."""

from __future__ import annotations

import atexit
import functools
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Mapping, Sequence

import gymnasium
import numpy as np

from ...library import find_tool
from ...tasks import TASKS
from ...video import STEPS_PER_SECOND, Video
from ...worlds import World
from ..sim import EvoSim
from ..viewer import MODES, EvoViewer
from ..world import EvoWorld

__all__ = ["BenchmarkBase", "EvoGymBase"]


class EvoGymBase(gymnasium.Env):
    """A world to be stepped, and helpers for observations, in voxels. ``render_mode``: ``img`` or
    ``rgb_array``, which render() returns, or ``screen`` or ``human``, which every step shows in a
    window. render_options: as of EvoViewer.render."""

    metadata = {"render_modes": list(MODES), "render_fps": STEPS_PER_SECOND}
    _unit = 1.0  # the length of a voxel in what these methods say

    def __init__(self, world: EvoWorld, render_mode: str | None = None,
                 render_options: Mapping[str, Any] | None = None) -> None:
        self._begin(EvoSim(world), render_mode, render_options)

    def _begin(self, sim: EvoSim, render_mode: str | None,
               render_options: Mapping[str, Any] | None) -> None:
        if render_mode is not None and render_mode not in MODES:
            raise ValueError(f"render_mode: {render_mode!r} is none of {', '.join(MODES)}")
        self._sim = sim
        self._default_viewer = EvoViewer(sim)
        self.render_mode = render_mode
        self._render_options = dict(render_options or {})

    @property
    def sim(self) -> EvoSim:
        return self._sim

    @property
    def default_viewer(self) -> EvoViewer:
        return self._default_viewer

    def step(self, action: Mapping[str, np.ndarray]) -> bool:
        """By names of robots, their actions, clipped to 0.6 to 1.6. True where a robot folded
        onto itself, and the episode cannot continue."""
        for name, values in action.items():
            self._sim.set_action(name, np.clip(values, 0.6, 1.6))
        done = self._sim.step()
        self._show()
        return done

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> None:
        self._sim.reset()

    def render(self) -> np.ndarray | None:
        """[height, width, 3] uint8 of ``img`` and ``rgb_array``."""
        if self.render_mode is None:
            return None
        return self._default_viewer.render(self.render_mode, **self._render_options)

    def _show(self) -> None:
        if self.render_mode in ("screen", "human"):
            self.render()

    def video(self, width: int = 480, height: int = 240, fps: float = 25.0,
              speed: float = 1.0) -> Video:
        """The episode so far: plays in a notebook, ``save(path)`` writes it."""
        return self._default_viewer.video(width, height, fps, speed)

    def close(self) -> None:
        if "_default_viewer" in self.__dict__:
            self._default_viewer.close()
        for name in ("_default_viewer", "_sim"):
            self.__dict__.pop(name, None)

    def get_actuator_indices(self, robot_name: str) -> np.ndarray:
        return self._sim.get_actuator_indices(robot_name)

    def get_dim_action_space(self, robot_name: str) -> int:
        return self._sim.get_dim_action_space(robot_name)

    def get_time(self) -> int:
        return self._sim.get_time()

    def pos_at_time(self, time: int) -> np.ndarray:
        return self._sim.pos_at_time(time) * self._unit

    def vel_at_time(self, time: int) -> np.ndarray:
        return self._sim.vel_at_time(time) * self._unit

    def object_pos_at_time(self, time: int, object_name: str) -> np.ndarray:
        return self._sim.object_pos_at_time(time, object_name) * self._unit

    def object_vel_at_time(self, time: int, object_name: str) -> np.ndarray:
        return self._sim.object_vel_at_time(time, object_name) * self._unit

    def object_orientation_at_time(self, time: int, object_name: str) -> float:
        return self._sim.object_orientation_at_time(time, object_name)

    # ---- observations, now ---------------------------------------------------------

    def get_pos_com_obs(self, object_name: str) -> np.ndarray:
        """[2], the mean of the object's points."""
        return self._positions(object_name).mean(axis=1) * self._unit

    def get_vel_com_obs(self, object_name: str) -> np.ndarray:
        """[2]"""
        return self._sim.object_vel_at_time(self.get_time(), object_name).mean(axis=1) * self._unit

    def get_relative_pos_obs(self, object_name: str) -> np.ndarray:
        """[2 n], all x, then all y, from the mean."""
        positions = self._positions(object_name)
        return (positions - positions.mean(axis=1)[:, None]).ravel() * self._unit

    def get_ort_obs(self, object_name: str) -> np.ndarray:
        """[1]"""
        return np.array([self._sim.object_orientation_at_time(self.get_time(), object_name)])

    def get_floor_obs(self, object_name: str, terrain_list: Sequence[str], sight_dist: int,
                      sight_range: float = 5) -> np.ndarray | None:
        """[2 sight_dist + 1]: how far below the object's centre the highest point of the terrain is, in
        columns a voxel wide to its left and right; sight_range where there is none."""
        return self._clearance(object_name, terrain_list, sight_dist, sight_range, -1)

    def get_ceil_obs(self, object_name: str, terrain_list: Sequence[str], sight_dist: int,
                     sight_range: float = 5) -> np.ndarray | None:
        """The same above it."""
        return self._clearance(object_name, terrain_list, sight_dist, sight_range, 1)

    def _positions(self, name: str) -> np.ndarray:
        return self._sim.object_pos_at_time(self.get_time(), name)

    def _clearance(self, name: str, terrain: Sequence[str], distance: int, reach: float,
                   side: int) -> np.ndarray | None:
        centre = self._positions(name).mean(axis=1)
        if len(terrain) == 0:
            return None
        points = np.concatenate([self._positions(one) for one in terrain], axis=1)
        points = points[:, side * points[1] > side * centre[1]]
        found = np.full(2 * distance + 1, centre[1] + side * reach)
        for k, offset in enumerate(range(-distance, distance + 1)):
            column = points[1, (points[0] > centre[0] + (offset - 0.5)) &
                            (points[0] < centre[0] + (offset + 0.5))]
            if column.size:
                found[k] = column.min() if side > 0 else column.max()
        return np.clip(side * (found - centre[1]), 0, reach) * self._unit


class _DataPath:
    """A folder with the worlds of the tasks, for the design tool and EvoWorld.from_json: made when it
    is first asked for, and gone with the process."""

    def __get__(self, owner: Any, kind: Any = None) -> str:
        return _worlds(os.getpid())


@functools.lru_cache(maxsize=1)
def _worlds(process: int) -> str:
    folder = tempfile.mkdtemp(prefix="evogym-")
    atexit.register(lambda: os.getpid() == process and shutil.rmtree(folder, ignore_errors=True))
    for name in TASKS:
        if name in ("AreaMinimizer-v0", "Catcher-v0", "HeightMaximizer-v0", "WingspanMazimizer-v0"):
            continue  # built of others
        file = Path(folder, "ShapeChange.json" if name == "AreaMaximizer-v0" else f"{name}.json")
        subprocess.run([find_tool("evo-convert"), "--task", name, "--to", "evogym", "-o", file], check=True)
        if name == "Traverser-v0":  # its blocks are not in the file
            world = json.loads(file.read_text())
            world["objects"] = {"ground": world["objects"]["ground"]}
            file.write_text(json.dumps(world))
    parts = {"package": np.full((2, 3), 2), "peg": np.full((1, 5), 5),
             **{f"rigid_{size}x{size}": np.full((size, size), 1) for size in (1, 2, 3)}}
    for name, body in parts.items():
        part = World()
        part.add(name, body, 0, 0)
        Path(folder, f"{name}.json").write_text(part.json())
    return folder


class BenchmarkBase(EvoGymBase):
    """The same in raw units, as the benchmark's own tasks observe and reward: a voxel
    is 0.1."""

    VOXEL_SIZE = 0.1
    DATA_PATH = _DataPath()
    _unit = property(lambda self: self.VOXEL_SIZE)
