"""The benchmark's base classes of families of tasks, for tasks of one's own that are derived from them."""

from __future__ import annotations

from typing import Any, Mapping, Sequence

import numpy as np

from .base import BenchmarkBase

__all__ = ["ClimbBase", "Goal", "GoalBase", "PackageBase", "ShapeBase", "StairsBase", "WalkToX"]


def centre(points: np.ndarray) -> np.ndarray:
    """[2] of [2, n]."""
    return np.mean(points, axis=1)


def nearer(goal: float, before: np.ndarray, now: np.ndarray, axis: int = 0) -> float:
    """By how much the points came nearer to a goal."""
    return abs(goal - centre(before)[axis]) - abs(goal - centre(now)[axis])


def moved(before: np.ndarray, now: np.ndarray, axis: int = 0) -> float:
    return centre(now)[axis] - centre(before)[axis]


def approached(before: np.ndarray, now: np.ndarray, other_before: np.ndarray, other_now: np.ndarray) -> float:
    """By how much two things came nearer to each other along the ground."""
    return (abs(centre(before)[0] - centre(other_before)[0])
            - abs(centre(now)[0] - centre(other_now)[0]))


def span(points: np.ndarray, axis: int) -> float:
    return float(np.ptp(points[axis]))


class StairsBase(BenchmarkBase):
    """Over terrain; a subclass sets ``sight_dist``."""

    def get_reward(self, robot_pos_init, robot_pos_final):
        return moved(robot_pos_init, robot_pos_final)

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None):
        super().reset(seed=seed, options=options)
        return np.concatenate([
            self.get_vel_com_obs("robot"), self.get_ort_obs("robot"), self.get_relative_pos_obs("robot"),
            self.get_floor_obs("robot", ["ground"], self.sight_dist)]), {}


class ClimbBase(BenchmarkBase):
    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None):
        super().reset(seed=seed, options=options)
        return np.concatenate([self.get_vel_com_obs("robot"), self.get_relative_pos_obs("robot")]), {}


class ShapeBase(BenchmarkBase):
    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None):
        super().reset(seed=seed, options=options)
        return self.get_relative_pos_obs("robot"), {}

    def jarvis_march(self, S: np.ndarray) -> np.ndarray:
        """The corners [k, 2] of the convex hull of points [n, 2], counter-clockwise."""
        points = sorted({(float(x), float(y)) for x, y in S})
        if len(points) < 3:
            return np.array(points)

        def side(among):
            found: list[tuple[float, float]] = []
            for p in among:
                while len(found) > 1 and self.CCW(found[-2], p, found[-1]):
                    found.pop()
                found.append(p)
            return found[:-1]

        return np.array(side(points) + side(points[::-1]))

    def CCW(self, p1: Sequence[float], p2: Sequence[float], p3: Sequence[float]) -> bool:
        """Whether the way from p1 over p2 to p3 bends to the left, or not at all."""
        return (p3[1] - p1[1]) * (p2[0] - p1[0]) >= (p2[1] - p1[1]) * (p3[0] - p1[0])

    def convex_poly_area(self, pts_cw: np.ndarray) -> float:
        x, y = np.asarray(pts_cw).T
        return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))

    def _area(self, points: np.ndarray) -> float:
        return self.convex_poly_area(self.jarvis_march(points.T))


class PackageBase(BenchmarkBase):
    """Of a robot and a package; a subclass sets ``thresh_height``, below which the package's fall counts."""

    def __init__(self, world, render_mode: str | None = None,
                 render_options: Mapping[str, Any] | None = None) -> None:
        super().__init__(world, render_mode, render_options)
        self.default_viewer.track_objects("robot", "package")

    def get_obs(self, robot_pos_final, robot_vel_final, package_pos_final, package_vel_final) -> np.ndarray:
        return np.concatenate([centre(robot_vel_final), centre(package_pos_final) - centre(robot_pos_final),
                               centre(package_vel_final)])

    def get_reward(self, package_pos_init, package_pos_final, robot_pos_init, robot_pos_final):
        return (0.75 * moved(package_pos_init, package_pos_final)
                + 0.5 * moved(robot_pos_init, robot_pos_final)
                + approached(robot_pos_init, robot_pos_final, package_pos_init, package_pos_final)
                + self._dropped(package_pos_init, package_pos_final))

    def _dropped(self, before: np.ndarray, now: np.ndarray, height: float | None = None) -> float:
        return 10 * moved(before, now, 1) if centre(now)[1] < (height or self.thresh_height) else 0.0

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None):
        super().reset(seed=seed, options=options)
        now = self.get_time()
        at = [self.object_pos_at_time(now, "robot"), self.object_vel_at_time(now, "robot"),
              self.object_pos_at_time(now, "package"), self.object_vel_at_time(now, "package")]
        return np.concatenate([self.get_obs(*at), self.get_relative_pos_obs("robot")]), {}


class Goal:
    """One of several that are to be reached in turn. requirements: the keys of ``args`` it needs."""

    def __init__(self, name: str, requirements: Sequence[str] | None = None) -> None:
        self.name, self.requirements = name, list(requirements or [])

    def evaluate(self, args: Mapping[str, Any]) -> tuple[float, bool]:
        """A reward, and whether it is reached."""
        raise NotImplementedError(f"{type(self).__name__} has no evaluate()")

    evaluate_reward = evaluate

    def get_obs(self, args: Mapping[str, Any]) -> np.ndarray:
        raise NotImplementedError(f"{type(self).__name__} has no get_obs()")


class WalkToX(Goal):
    """To within two voxels of a place; args are positions [2, n] before and after a step."""

    def __init__(self, x_goal: float) -> None:
        super().__init__(f"Walk to x = {x_goal}", ["robot_com_pos_initial", "robot_com_pos_final"])
        self.x_goal = x_goal

    def evaluate(self, args: Mapping[str, Any]) -> tuple[float, bool]:
        goal = self.x_goal * BenchmarkBase.VOXEL_SIZE
        now = args["robot_com_pos_final"]
        reached = abs(goal - centre(now)[0]) < 2 * BenchmarkBase.VOXEL_SIZE
        return nearer(goal, args["robot_com_pos_initial"], now), bool(reached)

    def get_obs(self, args: Mapping[str, Any]) -> np.ndarray:
        goal = self.x_goal * BenchmarkBase.VOXEL_SIZE
        return np.array([goal, goal - centre(args["robot_com_pos_final"])[0]])


class GoalBase(BenchmarkBase):
    def init_reward_goals(self, goals: Sequence[Goal]) -> None:
        if not goals:
            raise ValueError("an environment of goals has one goal or more")
        self.goals = list(goals)
        self.requirements: dict[str, list[str]] = {}
        self.current_goal = 0
        for goal in self.goals:
            for needed in goal.requirements:
                self.requirements.setdefault(needed, []).append(goal.name)

    def get_reward(self, args: Mapping[str, Any]) -> tuple[float, bool]:
        """Of the present goal, and whether all are reached."""
        for needed, names in self.requirements.items():
            if args[needed] is None:
                raise ValueError(f"args lack '{needed}', which is needed by {names}")
        reward = 0.0
        while self.current_goal < len(self.goals):
            reward, reached = self.goals[self.current_goal].evaluate(args)
            if not reached:
                return reward, False
            self.current_goal += 1
        return reward, True

    def get_obs(self, args: Mapping[str, Any]) -> np.ndarray:
        return self.goals[self.current_goal].get_obs(args)
