"""The 32 environments by the benchmark's names of classes: its worlds, observations, rewards and
ends, to the last bits."""

from __future__ import annotations

import random
import re
from typing import Any, Mapping, Sequence

import numpy as np
from gymnasium.spaces import Box

from ..sim import TaskSim
from ..world import EvoWorld, WorldObject
from .base import BenchmarkBase
from .bases import (ClimbBase, Goal, GoalBase, PackageBase, ShapeBase, StairsBase, WalkToX, approached, centre,
                    moved, nearer, span)

__all__ = ["TaskBase", "ClimbBase", "Goal", "GoalBase", "PackageBase", "ShapeBase", "StairsBase",
           "WalkToX",
           "Balance", "BalanceJump", "BiWalk", "BlockSoup", "CarrySmallRect", "CarrySmallRectToTable",
           "CatchSmallRect", "Climb0", "Climb1", "Climb2", "Duck", "Flipping",
           "FloatingPlatform", "Gaps", "LiftSmallRect", "MaximizeShape", "MaximizeXShape",
           "MaximizeYShape", "MinimizeShape", "PushSmallRect",
           "PushSmallRectOnOppositeSide", "SlideBeam", "SoftBridge", "StationaryJump",
           "StepsDown", "StepsUp", "ThrowSmallRect", "ToppleBeam", "VerticalBarrier",
           "WalkingBumpy", "WalkingBumpy2", "WalkingFlat"]

V = BenchmarkBase.VOXEL_SIZE


class TaskBase(BenchmarkBase):
    """A robot in the task that a class below names. The simulator observes and rewards; the
    methods get_obs and get_reward.. say the same of positions that they are given. A class of one's own
    that overrides the one that the benchmark's step() asks (REWARD) is rewarded by it. What else it
    overrides of what the benchmark's step() and reset() ask is refused, unless it has both of its own."""

    TASK = ""
    REWARD: tuple[str, ...] = ()  # the method, and the objects whose positions it takes, before and after
    OWN = {"render", "close", "video", "metadata", "step", "reset"}  # that nothing here asks

    def __init_subclass__(cls) -> None:
        if cls.__module__ == __name__ or all(
                getattr(cls, name) is not getattr(TaskBase, name) for name in ("step", "reset")):
            return
        for name in vars(cls):
            if not name.startswith("_") and hasattr(super(cls, cls), name) and name not in cls.OWN | {*cls.REWARD[:1]}:
                raise TypeError(
                    f"{cls.__name__} overrides {name}, which {cls.TASK} does not ask here: its simulator observes "
                    "and rewards. Override step() and reset(), too, or derive from BenchmarkBase")

    def __setattr__(self, name: str, value: Any) -> None:
        if name in ("VOXEL_SIZE", "sight_dist", "terrain_list", "thresh_height"):
            raise AttributeError(f"{name} of {self.TASK} is the simulator's and cannot be set here; derive "
                                 "from BenchmarkBase for a task of one's own")
        super().__setattr__(name, value)

    def __init__(self, body: Any, connections: Any = None, render_mode: str | None = None,
                 render_options: Mapping[str, Any] | None = None) -> None:
        sim = TaskSim(self.TASK, body, connections)
        self._robot = (np.asarray(body), connections)
        self._drawn = self._draws()
        sim.begin(None, self._drawn)
        self._begin(sim, render_mode, render_options)
        self._yaml = sim.simulator.task()["task_yaml"]
        follow = re.search(r"^follow: \[(.*)\]", self._yaml, re.M)
        self.default_viewer.track_objects(*(re.findall(r"\w+", follow[1]) if follow else ["robot"]))
        actuators = self.get_dim_action_space("robot")
        length = int(sim.simulator.observation_lengths[0])
        self.action_space = Box(0.6, 1.6, (actuators,), np.float64)
        self.observation_space = Box(-100.0, 100.0, (length,), np.float64)

    @property
    def world(self) -> EvoWorld:
        """What the episode began with; a copy."""
        file = "ShapeChange" if isinstance(self, ShapeBase) else self.TASK
        world = EvoWorld.from_json(f"{self.DATA_PATH}/{file}.json")
        x, y = re.search(r"^robot: \{at: \[(\d+), (\d+)\]", self._yaml, re.M).groups()
        world.add_from_array("robot", self._robot[0], int(x), int(y), self._robot[1])
        return world

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        own = self._own_reward()
        before = own and [self.object_pos_at_time(self.get_time(), name) for name in self.REWARD[1:]]
        super().step({"robot": action})
        simulator = self._sim.simulator
        reward = float(simulator.rewards[0])
        if own:
            now = [self.object_pos_at_time(self.get_time(), name) for name in self.REWARD[1:]]
            moments = [at for pair in zip(before, now) for at in pair]
            reward += _first(getattr(self, self.REWARD[0])(*moments)) - _first(own(self, *moments))
        return (simulator.observations[0].copy(), reward,
                bool(simulator.terminated[0] or simulator.status[0]), False, {})

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None):
        self._play(self._draws(), seed)
        return self._sim.simulator.observations[0].copy(), {}

    def _play(self, draws: dict[str, Any] | None, seed: int | None = None) -> None:
        self._drawn = draws
        self._sim.begin(seed, draws)

    def _own_reward(self) -> Any:
        """The benchmark's function where a class of one's own has another in its place."""
        if not self.REWARD or type(self).__module__ == __name__:
            return None
        name = self.REWARD[0]
        known = next(kind for kind in type(self).__mro__ if "TASK" in vars(kind) and kind.__module__ == __name__)
        return None if getattr(type(self), name) is getattr(known, name) else getattr(known, name)

    def _draws(self) -> dict[str, Any] | None:
        """Drawn here; None: by the seed."""
        return None


def _first(reward: Any) -> float:
    return float(reward[0] if isinstance(reward, tuple) else reward)


# Those that the simulator observes and rewards alone: task, family, and what the benchmark's class says.
_PLAIN = {
    "WalkingFlat": ("Walker-v0", None, {}),
    "SoftBridge": ("BridgeWalker-v0", None, {}),
    "Duck": ("CaveCrawler-v0", None, {"sight_dist": 5}),
    "StationaryJump": ("Jumper-v0", None, {"sight_dist": 2}),
    "Flipping": ("Flipper-v0", None, {}),
    "StepsUp": ("UpStepper-v0", StairsBase, {}),
    "StepsDown": ("DownStepper-v0", StairsBase, {}),
    "WalkingBumpy": ("ObstacleTraverser-v0", StairsBase, {}),
    "WalkingBumpy2": ("ObstacleTraverser-v1", StairsBase, {}),
    "VerticalBarrier": ("Hurdler-v0", StairsBase, {}),
    "Gaps": ("GapJumper-v0", StairsBase, {"terrain_list": [f"platform_{k}" for k in range(1, 6)]}),
    "FloatingPlatform": ("PlatformJumper-v0", StairsBase, {"terrain_list": [f"platform_{k}" for k in range(1, 8)]}),
    "BlockSoup": ("Traverser-v0", StairsBase, {"terrain_list": ["ground"]}),
    "PushSmallRect": ("Pusher-v0", PackageBase, {"thresh_height": 0.0}),
    "PushSmallRectOnOppositeSide": ("Pusher-v1", PackageBase, {"thresh_height": 0.0}),
    "Climb0": ("Climber-v0", ClimbBase, {}),
    "Climb1": ("Climber-v1", ClimbBase, {}),
    "Climb2": ("Climber-v2", ClimbBase, {"sight_dist": 3}),
}
for _name, (_task, _family, _says) in _PLAIN.items():
    _far = {"sight_dist": 5} if _family is StairsBase else {}
    globals()[_name] = type(_name, (TaskBase, _family) if _family else (TaskBase,),
                            {"__module__": __name__, "TASK": _task, **_far, **_says})


class Balance(TaskBase):
    TASK = "Balancer-v0"
    REWARD = ("get_reward", "robot")
    _OBSERVED, _REWARDED = (17.0, 5.5), (17.0, 5.0)  # places in voxels, which here differ

    def get_obs(self, pos_final):
        return np.array(self._OBSERVED) * V - centre(pos_final)

    def get_reward(self, pos_init, pos_final):
        x, y = self._REWARDED
        return nearer(x * V, pos_init, pos_final) + nearer(y * V, pos_init, pos_final, 1)


class BalanceJump(Balance):
    TASK = "Balancer-v1"
    _OBSERVED = _REWARDED = (17.5, 6.0)


class LiftSmallRect(TaskBase, PackageBase):
    TASK = "Lifter-v0"
    REWARD = ("get_reward_lift", "robot", "package")

    def get_reward_lift(self, robot_pos_init, robot_pos_final, package_pos_init, package_pos_final):
        fell = 20 * moved(robot_pos_init, robot_pos_final, 1) if centre(robot_pos_final)[1] < 3 * V else 0.0
        return (10 * moved(package_pos_init, package_pos_final, 1)
                + 10 * nearer(5.5 * V, package_pos_init, package_pos_final) + fell)


class CarrySmallRect(TaskBase, PackageBase):
    TASK = "Carrier-v0"
    REWARD = ("get_reward_carry", "package", "robot")
    thresh_height = 3 * V

    def get_reward_carry(self, package_pos_init, package_pos_final, robot_pos_init, robot_pos_final):
        return (0.5 * moved(package_pos_init, package_pos_final) + 0.5 * moved(robot_pos_init, robot_pos_final)
                + self._dropped(package_pos_init, package_pos_final))


class CarrySmallRectToTable(TaskBase, PackageBase):
    TASK = "Carrier-v1"
    REWARD = ("get_reward_carry", "package", "robot")
    thresh_height = 6 * V

    def get_reward_carry(self, package_pos_init, package_pos_final, robot_pos_init, robot_pos_final):
        height = (4 if centre(package_pos_final)[0] > 20 * V else 6) * V
        return (nearer(40 * V, robot_pos_init, robot_pos_final)
                + self._dropped(package_pos_init, package_pos_final, height))


class ToppleBeam(TaskBase, PackageBase):
    TASK = "BeamToppler-v0"
    REWARD = ("get_reward_topple", "robot", "beam")
    thresh_height = 0.0

    def get_obs_topple(self, robot_pos_final, beam_pos_final):
        return centre(beam_pos_final) - centre(robot_pos_final)

    def get_reward_topple(self, robot_pos_init, robot_pos_final, beam_pos_init, beam_pos_final):
        """And whether the beam is off to the left."""
        closer = approached(robot_pos_init, robot_pos_final, beam_pos_init, beam_pos_final)
        along, up = (moved(beam_pos_init, beam_pos_final, axis) for axis in (0, 1))
        return closer + abs(along) + 3 * abs(up) - 10 * up, bool(centre(beam_pos_final)[0] < 2 * V)


class SlideBeam(ToppleBeam):
    TASK = "BeamSlider-v0"

    def get_reward_topple(self, robot_pos_init, robot_pos_final, beam_pos_init, beam_pos_final):
        """And whether the beam is off to the left."""
        closer = approached(robot_pos_init, robot_pos_final, beam_pos_init, beam_pos_final)
        return closer + moved(beam_pos_init, beam_pos_final), bool(centre(beam_pos_final)[0] < 2 * V)


class ThrowSmallRect(TaskBase, PackageBase):
    TASK = "Thrower-v0"
    REWARD = ("get_reward_throw", "robot", "package")
    thresh_height = 0.0

    def get_reward_throw(self, robot_pos_init, robot_pos_final, package_pos_init, package_pos_final):
        side = -1 if centre(robot_pos_final)[0] < 0 else 1
        return (moved(package_pos_init, package_pos_final)
                - 0.25 * side * moved(robot_pos_init, robot_pos_final))


class CatchSmallRect(TaskBase, PackageBase):
    TASK = "Catcher-v0"
    REWARD = ("get_reward_catch", "robot", "package")
    thresh_height = 5 * V

    @property
    def world(self) -> EvoWorld:
        world = EvoWorld.from_json(f"{self.DATA_PATH}/Walker-v0.json")
        world.add_from_array("robot", self._robot[0], 22, 1, self._robot[1])
        for name, file, x, y in (("package", "package", 21, 41), ("peg1", "peg", 17, 39), ("peg2", "peg", 19, 25)):
            part = WorldObject.from_json(f"{self.DATA_PATH}/{file}.json")
            part.rename(name)
            part.set_pos(x + self.offsetx, y + self.offsety)
            world.add_object(part)
        return world

    @property
    def offsetx(self) -> int:
        """Of package and pegs in this episode, voxels."""
        return self._offset(0, 17)

    @property
    def offsety(self) -> int:
        return self._offset(1, 39)

    def _offset(self, axis: int, place: int) -> int:
        return round(self._sim.object_pos_at_time(0, "peg1")[axis].min()) - place

    def random_init(self) -> None:
        """Another episode."""
        self._play(self._draws())

    def get_obs_catch(self, robot_pos_final, package_pos_final) -> np.ndarray:
        return centre(package_pos_final) - centre(robot_pos_final)

    def get_reward_catch(self, robot_pos_init, robot_pos_final, package_pos_init, package_pos_final):
        return (approached(robot_pos_init, robot_pos_final, package_pos_init, package_pos_final)
                + self._dropped(package_pos_init, package_pos_final))

    def _draws(self) -> dict[str, Any] | None:
        return {"ox": random.randint(-6, 4), "oy": random.randint(0, 5)}


class MaximizeShape(TaskBase, ShapeBase):
    TASK = "AreaMaximizer-v0"
    REWARD = ("get_reward", "robot")

    def get_reward(self, robot_pos_init, robot_pos_final):
        return 10 * (self._area(robot_pos_final) - self._area(robot_pos_init))


class MinimizeShape(TaskBase, ShapeBase):
    TASK = "AreaMinimizer-v0"
    REWARD = ("get_reward", "robot")

    def get_reward(self, robot_pos_init, robot_pos_final):
        return 10 * (self._area(robot_pos_init) - self._area(robot_pos_final))


class MaximizeXShape(TaskBase, ShapeBase):
    TASK = "WingspanMazimizer-v0"
    REWARD = ("get_reward", "robot")

    def get_reward(self, robot_pos_init, robot_pos_final):
        return span(robot_pos_final, 0) - span(robot_pos_init, 0)


class MaximizeYShape(TaskBase, ShapeBase):
    TASK = "HeightMaximizer-v0"
    REWARD = ("get_reward", "robot")

    def get_reward(self, robot_pos_init, robot_pos_final):
        return span(robot_pos_final, 1) - span(robot_pos_init, 1)


class BiWalk(TaskBase, GoalBase):
    TASK = "BidirectionalWalker-v0"

    def init_reward_goals(self, goals: Sequence[Goal]) -> None:
        """These WalkToX in the place of drawn ones: the episode begins anew."""
        if not all(isinstance(goal, WalkToX) for goal in goals):
            raise ValueError("the goals of BidirectionalWalker-v0 are WalkToX; derive from GoalBase for others")
        self._play({"goals": [goal.x_goal for goal in goals]})

    def set_random_goals(self, lower_bound: int, upper_bound: int, goal_dist: int) -> None:
        self.init_reward_goals([WalkToX(x) for x in _way(lower_bound, upper_bound, goal_dist)])

    @property
    def goals(self) -> list[WalkToX]:
        return [WalkToX(x) for x in self._drawn["goals"]]

    @property
    def current_goal(self) -> int:
        """How many were reached before the last step."""
        return int(self._sim.simulator.observations[0][-3])

    def get_reward(self, args: Mapping[str, Any]) -> tuple[float, bool]:
        own = GoalBase.__new__(GoalBase)  # which may count on
        GoalBase.init_reward_goals(own, self.goals)
        own.current_goal = self.current_goal
        return own.get_reward(args)

    def _draws(self) -> dict[str, Any] | None:
        return {"goals": _way(20, 50, 100)}


def _way(lower: int, upper: int, length: int) -> list[int]:
    """Places that are drawn until the way over all of them is as long."""
    at, goals, way = 35, [], 0
    while way < length:
        goals.append(random.randrange(lower, upper))
        way += abs(goals[-1] - at)
        at = goals[-1]
    return goals
