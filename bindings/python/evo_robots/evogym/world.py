"""Worlds and their objects, as the benchmark's scripts build them. Rows of ``grid`` count
upwards; those of structures, as everywhere, from the top."""

from __future__ import annotations

import json
import os
from copy import deepcopy
from typing import Any

import numpy as np

from .utils import VOXEL_TYPES, Pair, get_full_connectivity

__all__ = ["EvoWorld", "WorldObject"]


class WorldObject:
    """A named body at a place: voxels, and which of them are joined."""

    def __init__(self) -> None:
        self.name = ""
        self.pos = Pair(0, 0)
        self.grid_size = Pair(0, 0)
        self.grid = np.zeros((0, 0))
        self.voxels: list[Pair] = []
        self.neighbors: dict[Pair, list[Pair]] = {}

    @classmethod
    def from_json(cls, file_path: str | os.PathLike) -> "WorldObject":
        """The object of a design-tool file that holds one."""
        objects = list(EvoWorld.from_json(file_path).objects.values())
        if len(objects) != 1:
            raise ValueError(f"{file_path}: holds {len(objects)} objects; one is expected")
        return objects[0]

    @classmethod
    def from_array(cls, name: str, structure: Any, connections: Any = None) -> "WorldObject":
        made = cls()
        made.load_from_array(name, structure, connections)
        return made

    def load_from_json(self, file_path: str | os.PathLike) -> None:
        self.__dict__.update(WorldObject.from_json(file_path).__dict__)

    def load_from_array(self, name: str, structure: Any, connections: Any = None) -> None:
        """structure: [rows, columns], VOXEL_TYPES. connections: [2, n], pairs of cells that
        are joined, row-major in the structure [all neighbours]."""
        structure = np.asarray(structure)
        if connections is None:
            connections = get_full_connectivity(structure)
        self.name, self.pos = name, Pair(0, 0)
        self._take(np.flipud(structure), [
            (self._cell(a, structure.shape), self._cell(b, structure.shape))
            for a, b in np.asarray(connections, int).reshape(2, -1).T.tolist()])

    def load_from_parsed_json(self, name: str, json_data: Any, grid_size: Pair) -> None:
        """One object of a design-tool document; its place is part of it."""
        places = {i: Pair(i % grid_size.x, i // grid_size.x) for i in json_data["indices"]}
        if not places:
            raise ValueError(f"object {name} has no voxels")
        corner = Pair(min(p.x for p in places.values()), min(p.y for p in places.values()))
        grid = np.zeros((max(p.y for p in places.values()) - corner.y + 1,
                         max(p.x for p in places.values()) - corner.x + 1), int)
        for index, kind in zip(json_data["indices"], json_data["types"]):
            at = places[index] - corner
            grid[at.y, at.x] = kind
        links = []
        for index, place in places.items():
            for other in json_data["neighbors"][str(index)]:
                if other not in places:
                    raise ValueError(f"object {name} has voxels with neighbours that are none")
                links.append((place - corner, places[other] - corner))
        self.name, self.pos = name, corner
        self._take(grid, links)

    def translate(self, dx: int, dy: int) -> None:
        self.set_pos(self.pos.x + dx, self.pos.y + dy)

    def set_pos(self, x: int, y: int) -> None:
        if x < 0 or y < 0:
            raise ValueError(f"object {self.name}: ({x}, {y}) is outside of the world")
        self.pos = Pair(int(x), int(y))

    def get_pos(self) -> tuple[int, int]:
        return self.pos.x, self.pos.y

    def get_structure(self) -> np.ndarray:
        return np.flipud(self.grid)

    def get_connections(self) -> np.ndarray:
        """[2, n]; every connection is listed from both of its ends."""
        found = [(self._index(a), self._index(b)) for a, near in self.neighbors.items() for b in near]
        return np.array(found, int).reshape(-1, 2).T

    def rename(self, name: str) -> None:
        self.name = name

    def get_name(self) -> str:
        return self.name

    def copy(self) -> "WorldObject":
        return deepcopy(self)

    __copy__ = copy

    def __str__(self) -> str:
        return f"Size {self.grid_size} object named {self.name} at {self.pos}."

    def __repr__(self) -> str:
        return f"WorldObject({self})"

    def _take(self, grid: np.ndarray, links: list[tuple[Pair, Pair]]) -> None:
        self.grid, self.grid_size = grid, Pair(grid.shape[1], grid.shape[0])
        self.voxels = [Pair(int(x), int(y)) for y, x in np.argwhere(grid != VOXEL_TYPES["EMPTY"])]
        self.neighbors = {}
        there = set(self.voxels)
        for a, b in links:
            if a not in there or b not in there:
                raise ValueError(f"object {self.name}: a connection of cells that are no voxels")
            for near, other in ((a, b), (b, a)):
                known = self.neighbors.setdefault(near, [])
                if other not in known:
                    known.append(other)

    @staticmethod
    def _cell(index: int, shape: tuple[int, ...]) -> Pair:
        return Pair(index % shape[1], shape[0] - 1 - index // shape[1])

    def _index(self, cell: Pair) -> int:
        return (self.grid_size.y - 1 - cell.y) * self.grid_size.x + cell.x


class EvoWorld:
    """Objects by name, none in the cells of another; the grid grows with them."""

    def __init__(self) -> None:
        self.grid = np.array([[0]])
        self.grid_size = Pair(1, 1)
        self.objects: dict[str, WorldObject] = {}

    @classmethod
    def from_json(cls, file_path: str | os.PathLike) -> "EvoWorld":
        """A world of the design tool."""
        made = cls()
        made.add_from_json(file_path)
        return made

    def add_from_json(self, file_path: str | os.PathLike) -> None:
        with open(file_path) as file:
            document = json.load(file)
        size = Pair(document["grid_width"], document["grid_height"])
        for name, record in document["objects"].items():
            if not len(record["indices"]) == len(record["types"]) == len(record["neighbors"]):
                raise ValueError(f"{file_path}: the lists of object {name} differ in length")
            made = WorldObject()
            made.load_from_parsed_json(name, record, size)
            self.add_object(made)

    def add_from_array(self, name: str, structure: Any, x: int, y: int,
                       connections: Any = None) -> None:
        made = WorldObject.from_array(name, structure, connections)
        made.set_pos(x, y)
        self.add_object(made)

    def add_object(self, obj: WorldObject) -> None:
        if obj.name in self.objects:
            raise ValueError(f"there is an object {obj.name} already")
        self._grow(obj.pos + obj.grid_size)
        if self._cells(obj).any():
            raise ValueError(f"object {obj.name} overlaps with an existing object")
        self._cells(obj)[:] = obj.grid
        self.objects[obj.name] = obj

    def remove_object(self, obj_name: str) -> WorldObject:
        removed = self._known(obj_name)
        self._cells(removed)[:] = 0
        del self.objects[obj_name]
        return removed.copy()

    def translate_object(self, obj_name: str, dx: int, dy: int) -> None:
        at = self._known(obj_name).pos
        self.move_object(obj_name, at.x + dx, at.y + dy)

    def move_object(self, obj_name: str, x: int, y: int) -> None:
        moved = self._known(obj_name).copy()
        moved.set_pos(x, y)
        before = self.remove_object(obj_name)
        try:
            self.add_object(moved)
        except ValueError:
            self.add_object(before)
            raise

    def pretty_print(self, voxels_per_line: int = 50) -> None:
        """The world in letters, a strip of columns below the other."""
        for left in range(0, self.grid_size.x, voxels_per_line):
            columns = range(left, min(self.grid_size.x, left + voxels_per_line))
            for y in reversed(range(self.grid_size.y)):
                print(f"{y % 10} |", " ".join(".RSHVF"[int(self.grid[y, x])] for x in columns))
            print("  +" + "--" * len(columns))
            print("   ", " ".join(str(x % 10) for x in columns))

    def _known(self, name: str) -> WorldObject:
        if name not in self.objects:
            raise ValueError(f"there is no object {name}; there are: " + ", ".join(self.objects))
        return self.objects[name]

    def _cells(self, obj: WorldObject) -> np.ndarray:
        return self.grid[obj.pos.y : obj.pos.y + obj.grid_size.y,
                         obj.pos.x : obj.pos.x + obj.grid_size.x]

    def _grow(self, end: Pair) -> None:
        more = (max(0, end.y - self.grid_size.y), max(0, end.x - self.grid_size.x))
        self.grid = np.pad(self.grid, [(0, more[0]), (0, more[1])])
        self.grid_size = Pair(self.grid.shape[1], self.grid.shape[0])
