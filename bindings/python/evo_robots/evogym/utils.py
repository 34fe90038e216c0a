"""Bodies as the benchmark's scripts handle them."""

from __future__ import annotations

import operator
import random
import time
from dataclasses import dataclass
from typing import Any, Callable

import numpy as np

from .. import robots
from ..robots import MOST_CELLS_DRAWN, get_full_connectivity, has_actuator, is_connected
from ..tasks import TASKS

__all__ = ["BASELINE_ENV_NAMES", "VOXEL_TYPES", "Pair", "Timer", "draw", "get_full_connectivity",
           "get_uniform", "has_actuator", "hashable", "is_connected", "sample_robot"]

VOXEL_TYPES = {**robots.VOXEL_TYPES, "FIXED": 5}
BASELINE_ENV_NAMES = list(TASKS)


@dataclass
class Pair:
    """A place or a size in cells; hashed by its values. Operators work on each value, with a Pair or a
    number."""

    x: int
    y: int

    def __hash__(self) -> int:
        return hash((self.x, self.y))

    def __getitem__(self, index: int) -> int:
        if index not in (0, 1):
            raise IndexError(f"a Pair has the values 0 and 1, not {index}")
        return (self.x, self.y)[index]

    def __eq__(self, b: object) -> bool:
        other = _pair(b)
        return other is not None and (self.x, self.y) == (other.x, other.y)

    def __add__(self, b: "Pair | int") -> "Pair":
        return self._each(operator.add, b)

    def __sub__(self, b: "Pair | int") -> "Pair":
        return self._each(operator.sub, b)

    def __mul__(self, b: "Pair | int") -> "Pair":
        return self._each(operator.mul, b)

    def __floordiv__(self, b: "Pair | int") -> "Pair":
        return self._each(operator.floordiv, b)

    __truediv__ = __floordiv__  # cells are whole

    def __mod__(self, b: "Pair | int") -> "Pair":
        return self._each(operator.mod, b)

    def abs(self) -> "Pair":
        return Pair(abs(self.x), abs(self.y))

    def each_max(self, b: "Pair") -> "Pair":
        return self._each(max, b)

    def each_min(self, b: "Pair") -> "Pair":
        return self._each(min, b)

    def __str__(self) -> str:
        return f"({self.x}, {self.y})"

    def copy(self) -> "Pair":
        return Pair(self.x, self.y)

    def _each(self, of: Callable[[int, int], int], b: Any) -> "Pair":
        other = _pair(b)
        if other is None:
            raise TypeError(f"a Pair and {b!r} do not go together")
        return Pair(of(self.x, other.x), of(self.y, other.y))


def _pair(b: Any) -> Pair | None:
    return b if isinstance(b, Pair) else Pair(b, b) if isinstance(b, int) else None


class Timer:
    """Says when it is time for the next step, so many times in a second; None: always."""

    def __init__(self, target_step_frequency: int | None = None) -> None:
        self._target = target_step_frequency
        self._steps = self._all_steps = self.total_count = 0
        self._since = time.monotonic()

    def should_step(self) -> bool:
        if self._target is None:
            return True
        return self._steps < (self._target - 1) * (time.monotonic() - self._since)

    def step(self, verbose: bool = False) -> None:
        """One more. verbose: prints once in a second how many there were."""
        self._steps += 1
        if time.monotonic() - self._since <= 1:
            return
        self._all_steps += self._steps
        self.total_count += 1
        if verbose:
            print(f"rps: {self._steps} | avg rps: {self._all_steps / self.total_count:.2f}")
        self._since += 1
        self._steps = 0


def get_uniform(x: int) -> np.ndarray:
    """``x`` equal shares of 1."""
    assert x > 0, f"a distribution has 1 share or more, not {x}"
    return np.ones(x) / x


def draw(pd: Any) -> int:
    """An index drawn by relative weights, from Python's ``random``."""
    weights = np.array(pd, float)
    assert weights.size > 0 and (weights >= 0).all() and weights.sum() > 0, (
        f"weights from 0 on are expected, one of them above, not {pd}")
    at = random.uniform(0, 1)
    # As the benchmark sums, so that its seeds draw its robots.
    total = 0.0
    for index, share in enumerate(weights / weights.sum()):
        total += share
        if at <= total:
            return index
    return int(np.flatnonzero(weights)[-1])  # the shares' sum is a bit short of 1


def sample_robot(robot_shape: tuple[int, int],
                 pd: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """A random valid body and its connections; the benchmark's for the same ``random.seed``.
    Gives up with a ValueError where by such weights bodies are hardly ever valid."""
    if len(robot_shape) != 2 or min(robot_shape) < 1:
        raise ValueError(f"robot_shape: rows and columns from 1 on are expected, not {robot_shape}")
    weights = np.array([0.6, 0.2, 0.2, 0.2, 0.2]) if pd is None else pd
    assert weights.shape == (5,), f"five weights are expected, not {weights}"
    if weights[3] + weights[4] == 0:
        raise ValueError(f"by the weights {weights} no robot has an actuator")
    cells = robot_shape[0] * robot_shape[1]
    for _ in range(max(1000, MOST_CELLS_DRAWN // (10 * cells))):
        body = np.array([draw(weights) for _ in range(cells)], float).reshape(robot_shape)
        if is_connected(body) and has_actuator(body):
            return body, get_full_connectivity(body)
    raise ValueError(f"bodies of {robot_shape[0]}x{robot_shape[1]} cells by the weights {weights} are "
                     "hardly ever connected")


def hashable(robot: np.ndarray) -> str:
    """The voxels as one row of digits."""
    return "".join(str(int(voxel)) for voxel in np.asarray(robot).flat)
