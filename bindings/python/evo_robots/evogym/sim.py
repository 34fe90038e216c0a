"""A simulation of an EvoWorld, with its history."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..library import library, targets
from ..simulator import Simulator
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
        self._objects = {name: found.points for name, found in self._sims.objects.items()}
        self._actions = {name: found.actuators for name, found in self._sims.objects.items()}
        self._targets = np.ones((1, self._sims.num_actuators))
        self._history: list[tuple[np.ndarray, np.ndarray]] = []
        self.reset()

    def reset(self) -> None:
        """Back to time 0. Targets stay, as there."""
        self._sims.reset()
        self._begin()

    def _begin(self) -> None:
        self._history = [self._now()]
        self._taken: list[np.ndarray] = []  # targets of the steps
        self._moved: list[tuple[int, str, tuple[float, float]]] = []  # when, what, by how much

    def step(self) -> bool:
        """One control step. True where a robot folded onto itself: the simulation stopped there,
        time stood still, and nothing can be done but a reset."""
        self._sims.step(self._targets)
        if self._sims.status[0] != 0:
            return True
        self._note()
        return False

    def _note(self) -> None:
        self._history.append(self._now())
        self._taken.append(self._targets.copy())

    def get_time(self) -> int:
        return len(self._history) - 1

    def set_action(self, robot_name: str, action: Any) -> None:
        """Targets of the next steps: an actuator's length as a share of its rest length."""
        values = targets(action, 0.6, 1.6).ravel()
        wanted = len(self._robot(robot_name))
        if values.size != wanted:
            raise ValueError(f"{robot_name} takes {wanted} values, not {values.size}")
        self._targets[0, self._actions[robot_name]] = values

    def get_actuator_indices(self, robot_name: str) -> np.ndarray:
        """[A], row-major cells of the robot's structure."""
        return self._robot(robot_name).copy()

    def get_dim_action_space(self, robot_name: str) -> int:
        return len(self._robot(robot_name))

    def get_indices_of_actuators(self, robot_name: str) -> np.ndarray:
        """[1, A] int32, the same as get_actuator_indices."""
        return self._robot(robot_name)[None].astype(np.int32)

    def translate_object(self, x: float, y: float, object_name: str) -> None:
        """Moves an object that is no terrain, raw units (a voxel is 0.1), without changing its shape or
        velocity; it is there at the present time, too."""
        self._points(object_name)
        self._sims.translate(object_name, (float(x), float(y)))
        self._moved.append((len(self._taken), object_name, (float(x), float(y))))
        self._history[-1] = self._now()

    def revert(self, time: int) -> None:
        """Back to a time reached: what was done until then is done again, to the same bits."""
        self._at(time)
        taken, moved, targets = self._taken[:time], self._moved, self._targets.copy()
        self._again()
        for now in range(time + 1):
            for at, name, by in moved:
                if at == now:
                    self.translate_object(*by, name)
            if now < time:
                self._targets[:] = taken[now]
                self.step()
        self._targets[:] = targets

    def get_version(self) -> None:
        """Prints it."""
        print(f"evo {library().evo_version().decode()}")

    def init(self, *_: Any) -> None:
        raise NotImplementedError("an EvoSim has what its EvoWorld had: add objects there, and make another")

    read_object_from_array = read_object_from_file = read_robot_from_array = read_robot_from_file = init

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
        return self._orientation(object_name, self._at(time)[0])

    def _again(self) -> None:
        self.reset()

    def _orientation(self, name: str, positions: np.ndarray) -> float:
        return float(self._sims.orientation(name, positions[None])[0])

    def _picture(self, width: int, height: int, **view: Any) -> np.ndarray:
        return self._sims.picture(0, width, height, **view)

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
        if name not in self._objects:
            raise ValueError(f"there is no object {name}; there are: " + ", ".join(self._objects))
        return self._objects[name]


class TaskSim(EvoSim):
    """The same of a robot in one of the tasks, with what the task observes and rewards."""

    def __init__(self, task: str, body: Any, connections: Any) -> None:
        structure = np.asarray(body).astype(int)
        self._sims = self.simulator = Simulator(task, (structure, connections))
        self._actuators = {"robot": np.flatnonzero(np.isin(structure, ACTUATORS))}
        self._actions = {"robot": slice(None)}
        self._targets = np.ones((1, len(self._actuators["robot"])))
        self._history = []

    def begin(self, seed: int | None, draws: Any) -> None:
        """An episode; its draws follow from the seed where none are given."""
        self.simulator.reset(seed=seed, draws=draws)
        self._objects = self.simulator.objects()
        self._begin()
        self._start = self.simulator.save()

    def reset(self) -> None:
        self.begin(None, None)

    def _again(self) -> None:
        self.simulator.restore(self._start)
        self._begin()

    def step(self) -> bool:
        self.simulator.advance(self._targets)
        if self.simulator.status[0] != 0:
            return True
        now = self._now()
        # A robot that folds onto itself ends there: everything is where it was.
        if self.simulator.terminated[0] and np.array_equal(now[0], self._history[-1][0]):
            return True
        self._note()
        return False

    def _orientation(self, name: str, positions: np.ndarray) -> float:
        return self.simulator.orientation(name, positions)
