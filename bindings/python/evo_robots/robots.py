"""Robots as numpy arrays, as the benchmark's users have them: a body is a matrix
of voxel kinds, connections are pairs of row-major cell indices, [2, n]."""

from __future__ import annotations

import json
import os
from typing import Any, Iterable, Iterator, Mapping, Sequence

import numpy as np

from .library import Handle, RobotFacts, call, count_of, facts, text_given, text_of

__all__ = ["Robot", "VOXEL_TYPES", "get_full_connectivity", "has_actuator", "is_connected",
           "robot_document", "robot_arrays", "sample_robot"]

VOXEL_TYPES = {"EMPTY": 0, "RIGID": 1, "SOFT": 2, "H_ACT": 3, "V_ACT": 4}
LETTERS = ".RSHV"
MOST_CELLS_DRAWN = 5_000_000  # in vain, before sampling gives up: some seconds of work


def get_full_connectivity(robot: np.ndarray) -> np.ndarray:
    """Every pair of neighbouring voxels, [2, n]: for each cell in row-major order
    the neighbour to its right, then the one below."""
    body = np.asarray(robot)
    rows, cols = body.shape
    cells = np.arange(body.size).reshape(rows, cols)
    pairs = np.hstack([(cells[:, :-1].ravel(), cells[:, 1:].ravel()),
                       (cells[:-1].ravel(), cells[1:].ravel())])
    pairs = pairs[:, (body.ravel()[pairs] != 0).all(axis=0)]
    return pairs[:, np.lexsort(pairs[::-1])]


def is_connected(robot: np.ndarray) -> bool:
    """All voxels hang together by their edges; a body without any does not."""
    filled = {(int(r), int(c)) for r, c in np.argwhere(np.asarray(robot) != 0)}
    if not filled:
        return False
    front = [filled.pop()]
    while front:
        r, c = front.pop()
        near = {(r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)} & filled
        filled -= near
        front += near
    return not filled


def has_actuator(robot: np.ndarray) -> bool:
    return bool(np.isin(robot, (VOXEL_TYPES["H_ACT"], VOXEL_TYPES["V_ACT"])).any())


def sample_robot(
    robot_shape: tuple[int, int],
    pd: Sequence[float] | None = None,
    rng: np.random.Generator | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """A random valid body and its full connectivity. ``pd``: weights of the five
    kinds [0.6 for empty, 0.2 for each other]. Gives up with a ValueError after some
    seconds, for shapes that by such weights are hardly ever connected."""
    if len(robot_shape) != 2 or min(robot_shape) < 1:
        raise ValueError(f"robot_shape: rows and columns from 1 on are expected, not {robot_shape}")
    weights = np.array([0.6, 0.2, 0.2, 0.2, 0.2] if pd is None else pd, float)
    if (weights.shape != (5,) or not np.isfinite(weights).all() or (weights < 0).any()
            or weights[3:].sum() == 0):
        raise ValueError("pd: five weights are expected, one of an actuator above 0")
    rng = np.random.default_rng() if rng is None else rng
    share = weights / weights.sum()
    tries = max(1000, MOST_CELLS_DRAWN // int(np.prod(robot_shape)))
    for _ in range(tries):
        body = rng.choice(5, size=robot_shape, p=share).astype(float)
        if is_connected(body) and has_actuator(body):
            return body, get_full_connectivity(body)
    raise ValueError(
        f"no valid robot among {tries} random matrices of {robot_shape[0]}x{robot_shape[1]} cells; "
        f"with {100 * share[0]:.0f}% empty cells they are hardly ever connected: give empty (the "
        "first of pd) less, or choose a smaller shape")


def is_matrix(rows: Any) -> bool:
    """Whether a list or tuple is a body's rows, each a list of numbers."""
    return len(rows) > 0 and all(
        isinstance(row, (list, tuple, np.ndarray)) and len(row) > 0 and
        all(isinstance(cell, (int, float, np.number)) for cell in row) for row in rows)


def cell_pairs(connections: Any, cells: np.ndarray) -> list[list[int]]:
    """Of [2, n]; another shape would put together what does not belong together."""
    links = np.asarray(connections)
    if links.size == 0:
        return []
    if links.ndim != 2 or len(links) != 2:
        raise ValueError(f"connections of shape {links.shape}; expected (2, n): a row of cells and "
                         "one of their neighbours")
    if not np.array_equal(links, links.astype(int)):
        raise ValueError("connections: numbers of cells are whole")
    pairs = [sorted(int(cell) for cell in link) for link in links.T]
    known = {tuple(link) for link in get_full_connectivity(cells).T.tolist()}
    for (a, b) in pairs:
        if (a, b) not in known:
            raise ValueError(f"connections: {a} and {b} are no neighbouring voxels of the body")
    return pairs


def robot_document(robot: Any) -> dict[str, Any]:
    """A robot as the tools read it, from a body, a tuple ``(body, connections)``, a
    document, or a file of one robot."""
    if isinstance(robot, (str, os.PathLike)):
        robot = Robot(robot)
    if isinstance(robot, Robot):
        robot = robot.document
    if isinstance(robot, Mapping):
        return json.loads(json.dumps(dict(robot), default=without_numpy))
    is_pair = isinstance(robot, tuple) and len(robot) == 2 and not is_matrix(robot)
    return document_of(*robot) if is_pair else document_of(robot)


def without_numpy(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise ValueError(f"a robot's document holds numbers, texts, and lists of them, not {type(value).__name__}")


def document_of(body: Any, connections: Any = None) -> dict[str, Any]:
    try:
        cells = np.asarray(body, float)
    except (TypeError, ValueError):  # rows of different lengths, words
        cells = np.empty(0)
    if cells.ndim != 2 or not np.isin(cells, range(5)).all():
        raise ValueError("a body is a matrix of the numbers 0 to 4")
    document: dict[str, Any] = {
        "format": "evo/robot", "version": 1,
        "body": ["".join(LETTERS[int(kind)] for kind in row) for row in cells]}
    if connections is not None:
        document["connections"] = cell_pairs(connections, cells)
    return document


def stiffened(robot: Any, factors: Any) -> dict[str, Any]:
    """A robot's document with factors of its voxels' stiffness, a matrix as the body, of 0.1 to 10."""
    document = robot_document(robot)
    document.pop("id", None)  # another robot
    return {**document, "stiffness": np.asarray(factors, float).tolist()}


def robot_arrays(document: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Body and connections of a robot document."""
    body = np.array([[LETTERS.index(v) if isinstance(v, str) else v for v in row]
                     for row in document["body"]], float)
    if "connections" not in document:
        return body, get_full_connectivity(body)
    links = np.array(document["connections"], int)
    # Pairs; a document may also have the two rows of the benchmark.
    return body, links if len(links) == 2 and links.shape != (2, 2) else links.reshape(-1, 2).T


def listed(robots: Any) -> list:
    """One robot or a list of them."""
    if (isinstance(robots, (str, os.PathLike, Mapping, np.ndarray, Robot))
            or not isinstance(robots, Iterable)):
        return [robots]
    robots = robots if isinstance(robots, tuple) else list(robots)
    if is_matrix(robots):
        return [np.asarray(robots)]
    if isinstance(robots, tuple) and len(robots) == 2:
        return [robots]  # (body, connections)
    return list(robots)


def robots_of(robots: Any) -> Handle:
    """A list of robots: see ``listed``."""
    found = Handle("robots", "evo_robots_new")
    for robot in listed(robots):
        if isinstance(robot, (str, os.PathLike)):
            if "\n" in os.fspath(robot):
                raise ValueError("a text is the name of a robot's file; this one has several lines")
            part = Handle("robots", "evo_robots_read", text_of(robot))
        else:
            part = Handle("robots", "evo_robots_parse", json.dumps(robot_document(robot)).encode())
        for index in range(count_of("evo_robots_count", part)):
            call("evo_robots_append", found, part, index)
    return found


class Robot:
    """A robot that shows itself in notebooks. From a body, a tuple ``(body, connections)``, a
    document, or a file of one robot; ``body, connections = robot`` gives them back. stiffness: a
    matrix as the body, factors of each voxel's stiffness, 0.1 to 10 [all 1: None]."""

    def __init__(self, robot: Any, connections: Any = None, stiffness: Any = None) -> None:
        known = robot if connections is None else document_of(robot, connections)
        self._handle = robots_of(known if stiffness is None else stiffened(known, stiffness))
        count = count_of("evo_robots_count", self._handle)
        if count != 1:
            raise ValueError(f"one robot is expected, not {count}; files.read_robots reads several")
        found = facts("evo_robots_describe", RobotFacts, self._handle, 0)
        self.id: str = found.id.decode()
        self.document: dict[str, Any] = json.loads(found.json)
        self.body, self.connections = robot_arrays(self.document)
        factors = self.document.get("stiffness")
        self.stiffness = None if factors is None else np.array(factors, float)

    def svg(self, width: int = 240) -> str:
        """A picture, with the robot's id below."""
        return text_given("evo_robots_svg", self._handle, 0, width)

    def _repr_svg_(self) -> str:
        return self.svg()

    def __repr__(self) -> str:
        rows = "\n".join("".join(LETTERS[int(kind)] for kind in row) for row in self.body)
        return f"Robot {self.id}\n{rows}"

    def __iter__(self) -> Iterator[np.ndarray]:
        return iter((self.body, self.connections))

    def __eq__(self, other: Any) -> bool:
        return isinstance(other, Robot) and self.id == other.id

    def __hash__(self) -> int:
        return hash(self.id)

    def __reduce__(self) -> Any:
        return Robot, (self.document,)
