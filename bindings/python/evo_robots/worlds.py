"""Worlds built in Python, with any number of robots, and simulations of them within this
process. They have no task: what is observed and rewarded is computed from positions.

    world = World()
    world.add("ground", np.full((1, 40), 5), 0, 0)
    world.add("left", [[3, 4], [4, 3]], 5, 1)
    world.add("right", [[3, 4], [4, 3]], 20, 1)
    sims = Simulations(world, 16)
    for t in range(100):
        sims.step(np.full((16, 8), 1.0))
    centres = sims.positions[:, sims.objects["left"].points].mean(axis=1)  # [16, 2]
"""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from .library import (Handle, SimArrays, SimGradients, SimObject, address, array_at, bytes_given, call, count_of,
                      facts, failure, library, numbers, picture, targets as as_targets,
                      text_given, text_of, whole, whole64)
from .robots import cell_pairs
from .simulator import env_mask

__all__ = ["SIM_STATUS", "Gradients", "Object", "Simulations", "World"]

SIM_STATUS = ("ok", "folded", "unstable")


class World:
    """Named objects in a grid of cells; x and y count cells from the lower left corner."""

    def __init__(self, handle: Handle | None = None) -> None:
        self._handle = handle or Handle("world", "evo_world_new")

    @classmethod
    def read(cls, file: str | os.PathLike) -> "World":
        """A world of the benchmark's design tool."""
        return cls(Handle("world", "evo_world_read", text_of(file)))

    @classmethod
    def from_json(cls, text: str) -> "World":
        return cls(Handle("world", "evo_world_parse", text.encode()))

    def add(self, name: str, body: Any, x: int, y: int, connections: Any = None,
            stiffness: Any = None) -> None:
        """Puts an object with its lower left corner into cell (x, y). body: a matrix of 0
        (empty), 1 (rigid), 2 (soft), 3 and 4 (horizontal and vertical actuators), 5
        (fixed), [rows, columns]. connections: [2, n] pairs of neighbouring cells that are
        joined, as row-major indices [all neighbours]. stiffness: see stiffen."""
        given = numbers(f"body of {name!r}", body)
        if given.ndim != 2 or given.size == 0 or not np.isin(given, range(6)).all():
            raise ValueError(f"body of {name!r}: a matrix of the numbers 0 to 5 is expected")
        voxels = np.ascontiguousarray(given, np.uint8)
        links = None
        if connections is not None:
            links = np.array(cell_pairs(connections, voxels), np.int32).reshape(-1, 2)
        call("evo_world_add", self._handle, text_of(name), address(voxels), *voxels.shape,
             None if links is None else address(links), 0 if links is None else len(links),
             x, y)
        if stiffness is not None:
            try:
                self.stiffen(name, stiffness)
            except BaseException:
                self.remove(name)
                raise

    def stiffen(self, name: str, factors: Any) -> None:
        """How stiff each voxel of an object is, as a factor of its material's: a matrix as the body,
        of 0.1 to 10."""
        values = numbers(f"stiffness of {name!r}", factors)
        call("evo_world_stiffen", self._handle, text_of(name), address(values), values.size)

    def move(self, name: str, x: int, y: int) -> None:
        call("evo_world_move", self._handle, text_of(name), x, y)

    def remove(self, name: str) -> None:
        call("evo_world_remove", self._handle, text_of(name))

    def json(self) -> str:
        """The world in the form of the benchmark's design tool."""
        return text_given("evo_world_json", self._handle)

    def __getstate__(self) -> str:
        return self.json()

    def __setstate__(self, text: str) -> None:
        self._handle = Handle("world", "evo_world_parse", text.encode())


@dataclass(frozen=True)
class Object:
    """Which points and which actuators of a world are an object's."""

    index: int
    points: slice
    actuators: slice


@dataclass
class Gradients:
    """Derivatives of one number of each simulation's, for Simulations.pull_back()."""

    positions: np.ndarray  # [count, P, 2]
    velocities: np.ndarray  # [count, P, 2]
    previous: np.ndarray  # [count, P, 2], by positions one substep before
    targets: np.ndarray  # [count, A], by those of the step
    stiffness: np.ndarray  # [count, V], by factors of voxels, of all objects
    constants: np.ndarray  # [count, 5], by those of the physics that CONSTANTS names

    CONSTANTS = ("gravity", "drag", "contact_stiffness", "contact_damping", "friction_multiplier")


class Simulations:
    """``count`` simulations of a world, stepped side by side by ``jobs`` threads.
    physics: a profile by name or file [the benchmark's].

    The arrays are the simulator's own: they show what is after every step, and are copied
    by whoever wants to keep them. Raw units: a voxel is 0.1 wide. Copied, pickled, forked and
    used by threads as a Simulator is.
    """

    positions: np.ndarray  # [count, P, 2]
    velocities: np.ndarray  # [count, P, 2]
    status: np.ndarray  # [count] uint8, an index of SIM_STATUS
    objects: dict[str, Object]  # robots first, then by name
    num_actuators: int  # A, of one simulation
    num_voxels: int  # V, of one simulation: of all objects, each from its top left
    action_low: float  # targets are clipped to this range
    action_high: float

    def __init__(self, world: World, count: int = 1, *, physics: Any = None, jobs: int = 1) -> None:
        self._handle = Handle("sims", "evo_sims_open", world._handle,
                              None if physics is None else text_of(physics), count, jobs)
        self._do_step = library().evo_sims_step
        at = facts("evo_sims_arrays", SimArrays, self._handle)
        shape = (at.sims, at.points, 2)
        self.positions = array_at(self._handle, at.positions, shape, ctypes.c_double)
        self.velocities = array_at(self._handle, at.velocities, shape, ctypes.c_double)
        self.status = array_at(self._handle, at.status, (at.sims,), ctypes.c_uint8)
        self.num_sims, self.num_actuators, self.num_voxels = at.sims, at.actuators, at.voxels
        self.action_low, self.action_high = at.action_low, at.action_high
        self.objects = dict(self._object(k) for k in range(
            count_of("evo_sims_object_count", self._handle)))
        self._made = (world.json(), count, physics, jobs)

    def reset(self, sim: int | None = None) -> None:
        """Back to the initial shapes, at rest: one simulation, or all."""
        call("evo_sims_reset", self._handle, -1 if sim is None else self._number(sim))

    def step(self, targets: Any, mask: Any = None) -> None:
        """One control step. targets: [count, A], lengths of the actuators as shares of
        their rest lengths. mask: [count], those that take part [all]."""
        values = as_targets(targets, self.action_low, self.action_high)
        if values.shape != (self.num_sims, self.num_actuators):
            raise ValueError(f"targets of shape {values.shape}; expected "
                             f"{(self.num_sims, self.num_actuators)}")
        active = None if mask is None else env_mask(mask, self.num_sims)
        failed = self._do_step(self._handle, address(values), values.size,
                               None if active is None else address(active), self.num_sims)
        if failed:
            raise failure(failed)

    def record(self, onset: float | None = 0.04) -> None:
        """Keeps every step from now on, for pull_back(), and forgets those kept before. onset:
        half the width that the onset of contact is spread over, voxels, 0 for the exact
        derivative; None keeps no more steps. See docs/gradients.md."""
        call("evo_sims_record", self._handle, -1.0 if onset is None else float(onset))

    def gradients(self) -> Gradients:
        """All 0."""
        return Gradients(*map(np.zeros, self._gradient_shapes()))

    def pull_back(self, by: Gradients) -> None:
        """Back through the last step that is kept and has not been gone back through: derivatives
        by the state after it become those by the state before it, of simulations that it moved.
        Those by targets are set, those by stiffness and constants are added to."""
        arrays = [getattr(by, each.name) for each in fields(by)]
        for array, shape in zip(arrays, self._gradient_shapes()):
            _check(array, shape)
        given = SimGradients(self.num_sims, self.positions.shape[1], self.num_actuators,
                             self.num_voxels, *map(address, arrays))
        call("evo_sims_pull_back", self._handle, ctypes.byref(given), ctypes.sizeof(given))

    def _gradient_shapes(self) -> list[tuple[int, ...]]:
        """In the order of Gradients and of SimGradients."""
        widths = self.num_actuators, self.num_voxels, len(Gradients.CONSTANTS)
        return [self.positions.shape] * 3 + [(self.num_sims, width) for width in widths]

    def save(self, sim: int = 0) -> bytes:
        """The state of a simulation: opaque, for restore() in any of the same world."""
        return bytes_given("evo_sims_save", self._handle, self._number(sim))

    def restore(self, state: bytes, sim: int = 0) -> None:
        """The simulation continues from a state, to the same bits."""
        call("evo_sims_restore", self._handle, self._number(sim), bytes(state), len(state))

    def orientation(self, name: str, positions: Any = None) -> np.ndarray:
        """How far an object is turned from its initial shape, counter-clockwise, radians, as
        the benchmark measures it: [count], now, or in positions [count, P, 2] kept before."""
        given = None
        if positions is not None:
            given = np.ascontiguousarray(positions, np.float64)
            if given.shape[1:] != self.positions.shape[1:]:
                raise ValueError(f"positions of shape {given.shape}; expected "
                                 f"(n, {self.positions.shape[1]}, 2)")
        angles = np.zeros(self.num_sims if given is None else len(given))
        call("evo_sims_orientation", self._handle, self._known(name).index,
             None if given is None else address(given), address(angles), angles.size)
        return angles

    def translate(self, name: str, by: tuple[float, float], sim: int = 0) -> None:
        """Moves an object, as it is, by (x, y), raw units; velocities stay."""
        call("evo_sims_translate", self._handle, self._number(sim), self._known(name).index, *by)

    def perturb(self, jitter: float, seed: int, sim: int = 0) -> None:
        """Moves every point by up to ``jitter`` voxels in each coordinate; velocities stay."""
        call("evo_sims_perturb", self._handle, self._number(sim), jitter, whole64("seed", seed))

    def picture(self, sim: int = 0, width: int = 600, height: int = 300, **view: Any) -> np.ndarray:
        """[height, width, 3] uint8. ``positions``: kept before, [P, 2] [now]; ``window``: centre x
        and y, width and height, voxels [the first object]; ``hide``: of grid, background, edges, voxels."""
        return picture("evo_sims_render", self._handle, self._number(sim), width, height, **view)

    def __reduce__(self) -> Any:
        return _rebuilt, (self._made, [
            self.save(sim) if self.status[sim] != SIM_STATUS.index("unstable") else None
            for sim in range(self.num_sims)])

    def _known(self, name: str) -> Object:
        if name not in self.objects:
            raise ValueError(f"no object {name!r} in this world; there are: "
                             + ", ".join(self.objects))
        return self.objects[name]

    def _number(self, sim: int) -> int:
        return whole("simulation", sim, 0, self.num_sims - 1)

    def _object(self, index: int) -> tuple[str, Object]:
        found = facts("evo_sims_object", SimObject, self._handle, index)
        return found.name.decode(), Object(
            index, slice(found.first_point, found.first_point + found.points),
            slice(found.first_actuator, found.first_actuator + found.actuators))


def _check(array: np.ndarray, shape: tuple[int, ...]) -> None:
    if array.shape != shape or array.dtype != np.float64 or not array.flags.c_contiguous:
        raise ValueError(f"gradients {array.shape} of {array.dtype}; expected {shape} of float64, "
                         "one row after the other")


def _rebuilt(made: tuple, states: list) -> Simulations:
    text, count, physics, jobs = made
    sims = Simulations(World.from_json(text), count, physics=physics, jobs=jobs)
    for sim, state in enumerate(states):
        if state is not None:
            sims.restore(state, sim)
    return sims
