"""Robots as numpy arrays, as the benchmark's users have them: a body is a matrix
of voxel kinds, connections are pairs of row-major cell indices, [2, n]."""

from __future__ import annotations

from typing import Any, Mapping, Sequence

import numpy as np

__all__ = ["VOXEL_TYPES", "get_full_connectivity", "has_actuator", "is_connected",
           "robot_document", "robot_arrays", "sample_robot"]

VOXEL_TYPES = {"EMPTY": 0, "RIGID": 1, "SOFT": 2, "H_ACT": 3, "V_ACT": 4}
LETTERS = ".RSHV"


def get_full_connectivity(body: np.ndarray) -> np.ndarray:
    """Every pair of neighbouring voxels, [2, n]: for each cell in row-major order
    the neighbour to its right, then the one below."""
    body = np.asarray(body)
    rows, cols = body.shape
    pairs = []
    for cell in range(rows * cols):
        r, c = divmod(cell, cols)
        if body[r, c] == 0:
            continue
        if c + 1 < cols and body[r, c + 1] != 0:
            pairs.append((cell, cell + 1))
        if r + 1 < rows and body[r + 1, c] != 0:
            pairs.append((cell, cell + cols))
    return np.array(pairs, int).reshape(-1, 2).T


def is_connected(body: np.ndarray) -> bool:
    """All voxels hang together by their edges; a body without any does not."""
    filled = {(int(r), int(c)) for r, c in np.argwhere(np.asarray(body) != 0)}
    if not filled:
        return False
    front = [filled.pop()]
    while front:
        r, c = front.pop()
        near = {(r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)} & filled
        filled -= near
        front += near
    return not filled


def has_actuator(body: np.ndarray) -> bool:
    return bool(np.isin(body, (VOXEL_TYPES["H_ACT"], VOXEL_TYPES["V_ACT"])).any())


def sample_robot(
    robot_shape: tuple[int, int],
    pd: Sequence[float] | None = None,
    rng: np.random.Generator | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """A random valid body and its full connectivity. ``pd``: weights of the five
    kinds [0.6 for empty, 0.2 for each other]."""
    weights = np.array([0.6, 0.2, 0.2, 0.2, 0.2] if pd is None else pd, float)
    if weights.shape != (5,) or (weights < 0).any() or weights[3:].sum() == 0:
        raise ValueError("pd: five weights are expected, one of an actuator above 0")
    rng = np.random.default_rng() if rng is None else rng
    while True:
        body = rng.choice(5, size=robot_shape, p=weights / weights.sum()).astype(float)
        if is_connected(body) and has_actuator(body):
            return body, get_full_connectivity(body)


def robot_document(robot: Any) -> dict[str, Any]:
    """A robot as the tools read it, from a body, ``(body, connections)``, or a
    document."""
    if isinstance(robot, Mapping):
        return dict(robot)
    body, connections = robot if isinstance(robot, tuple) else (robot, None)
    cells = np.asarray(body)
    if cells.ndim != 2 or not np.isin(cells, range(5)).all():
        raise ValueError("a body is a matrix of the numbers 0 to 4")
    document: dict[str, Any] = {
        "format": "evo/robot", "version": 1,
        "body": ["".join(LETTERS[int(kind)] for kind in row) for row in cells]}
    if connections is not None:
        links = np.asarray(connections, int).reshape(2, -1).T
        document["connections"] = [sorted(link) for link in links.tolist()]
    return document


def robot_arrays(document: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Body and connections of a robot document."""
    body = np.array([[LETTERS.index(v) if isinstance(v, str) else v for v in row]
                     for row in document["body"]], float)
    if "connections" in document:
        return body, np.array(document["connections"], int).reshape(-1, 2).T
    return body, get_full_connectivity(body)
