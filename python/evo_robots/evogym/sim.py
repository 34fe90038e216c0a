"""A simulation of an EvoWorld, with its history."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..worlds import Simulations, World
from .utils import VOXEL_TYPES
from .world import EvoWorld

__all__ = ["EvoSim"]

ACTUATORS = (VOXEL_TYPES["H_ACT"], VOXEL_TYPES["V_ACT"])


class EvoSim:
    """Steps a world, and keeps what was at every time since the reset. Positions are in
    voxels, [2, n]; time counts control steps."""

    VOXEL_SIZE = 0.1

    def __init__(self, world: EvoWorld) -> None:
        built = World()
        self._actuators: dict[str, np.ndarray] = {}  # of robots: cells of their structure
        for name, obj in world.objects.items():
            structure = obj.get_structure().astype(int)
            built.add(name, structure, *obj.get_pos(), obj.get_connections())
            if np.isin(structure, ACTUATORS).any():
                self._actuators[name] = np.flatnonzero(np.isin(structure, ACTUATORS))
        self._sims = Simulations(built)
        self._targets = np.ones((1, self._sims.num_actuators))
        self._history: list[tuple[np.ndarray, np.ndarray]] = []
        self.reset()

    def reset(self) -> None:
        """Back to time 0. Targets stay, as there."""
        self._sims.reset()
        self._history = [self._now()]

    def step(self) -> bool:
        """One control step. True where a robot folded onto itself: the simulation stopped there,
        time did not go on, and nothing can be done but a reset."""
        self._sims.step(self._targets)
        if self._sims.status[0] != 0:
            return True
        self._history.append(self._now())
        return False

    def get_time(self) -> int:
        return len(self._history) - 1

    def set_action(self, robot_name: str, action: Any) -> None:
        """Targets of the next steps: an actuator's length as a share of its rest length."""
        values = np.asarray(action, float).ravel()
        wanted = len(self._robot(robot_name))
        if values.size != wanted:
            raise ValueError(f"{robot_name} takes {wanted} values, not {values.size}")
        self._targets[0, self._sims.objects[robot_name].actuators] = values

    def get_actuator_indices(self, robot_name: str) -> np.ndarray:
        """[A], row-major cells of the robot's structure."""
        return self._robot(robot_name).copy()

    def get_dim_action_space(self, robot_name: str) -> int:
        return len(self._robot(robot_name))

    def pos_at_time(self, time: int) -> np.ndarray:
        return self._at(time)[0].T / self.VOXEL_SIZE

    def vel_at_time(self, time: int) -> np.ndarray:
        return self._at(time)[1].T / self.VOXEL_SIZE

    def object_pos_at_time(self, time: int, object_name: str) -> np.ndarray:
        return self._at(time)[0][self._points(object_name)].T / self.VOXEL_SIZE

    def object_vel_at_time(self, time: int, object_name: str) -> np.ndarray:
        return self._at(time)[1][self._points(object_name)].T / self.VOXEL_SIZE

    def object_orientation_at_time(self, time: int, object_name: str) -> float:
        """Radians, counter-clockwise from the initial shape."""
        self._points(object_name)
        return float(self._sims.orientation(object_name, self._at(time)[0][None])[0])

    def _now(self) -> tuple[np.ndarray, np.ndarray]:
        return self._sims.positions[0].copy(), self._sims.velocities[0].copy()

    def _at(self, time: int) -> tuple[np.ndarray, np.ndarray]:
        if not isinstance(time, int):
            raise TypeError(f"time {time!r} is not an int")
        if not 0 <= time <= self.get_time():
            raise ValueError(f"time {time} is not from 0 to {self.get_time()}")
        return self._history[time]

    def _robot(self, name: str) -> np.ndarray:
        if name not in self._actuators:
            raise ValueError(f"there is no robot {name}; there are: " + ", ".join(self._actuators))
        return self._actuators[name]

    def _points(self, name: str) -> slice:
        if name not in self._sims.objects:
            raise ValueError(f"there is no object {name}; there are: " + ", ".join(self._sims.objects))
        return self._sims.objects[name].points
