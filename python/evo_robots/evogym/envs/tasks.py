"""The 32 environments by the benchmark's names of classes: its worlds, observations, rewards and
ends, to the last bits."""

from __future__ import annotations

import random
import re
from typing import Any, Mapping

import numpy as np
from gymnasium.spaces import Box

from ..sim import TaskSim
from .base import BenchmarkBase

__all__ = ["DRAWS", "TaskBase",
           "Balance", "BalanceJump", "BiWalk", "BlockSoup", "CarrySmallRect", "CarrySmallRectToTable",
           "CatchSmallRect", "Climb0", "Climb1", "Climb2", "Duck", "Flipping",
           "FloatingPlatform", "Gaps", "LiftSmallRect", "MaximizeShape", "MaximizeXShape",
           "MaximizeYShape", "MinimizeShape", "PushSmallRect",
           "PushSmallRectOnOppositeSide", "SlideBeam", "SoftBridge", "StationaryJump",
           "StepsDown", "StepsUp", "ThrowSmallRect", "ToppleBeam", "VerticalBarrier",
           "WalkingBumpy", "WalkingBumpy2", "WalkingFlat"]

# Where Catcher-v0 and BidirectionalWalker-v0 take what they draw from: "random", as in the
# benchmark, is Python's random, which no reset seeds; "seed" is reset(seed=) and the number of the
# episode, as in the suite.
DRAWS = "random"


class TaskBase(BenchmarkBase):
    """A robot in the task that a class below names."""

    TASK = ""

    def __init__(self, body: Any, connections: Any = None, render_mode: str | None = None,
                 render_options: Mapping[str, Any] | None = None) -> None:
        sim = TaskSim(self.TASK, body, connections)
        sim.begin(None, self._draws())
        self._begin(sim, render_mode, render_options)
        follow = re.search(r"^follow: \[(.*)\]", sim.simulator.task()["task_yaml"], re.M)
        self.default_viewer.track_objects(*(re.findall(r"\w+", follow[1]) if follow else ["robot"]))
        actuators = self.get_dim_action_space("robot")
        length = int(sim.simulator.observation_lengths[0])
        self.action_space = Box(0.6, 1.6, (actuators,), np.float64)
        self.observation_space = Box(-100.0, 100.0, (length,), np.float64)

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        super().step({"robot": action})
        simulator = self._sim.simulator
        return (simulator.observations[0].copy(), float(simulator.rewards[0]),
                bool(simulator.terminated[0] or simulator.status[0]), False, {})

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None):
        self._sim.begin(seed, self._draws())
        return self._sim.simulator.observations[0].copy(), {}

    def _draws(self) -> dict[str, Any] | None:
        """Drawn here; None: by the seed."""
        return None


class WalkingFlat(TaskBase):
    TASK = "Walker-v0"


class SoftBridge(TaskBase):
    TASK = "BridgeWalker-v0"


class Duck(TaskBase):
    TASK = "CaveCrawler-v0"


class StationaryJump(TaskBase):
    TASK = "Jumper-v0"


class Flipping(TaskBase):
    TASK = "Flipper-v0"


class Balance(TaskBase):
    TASK = "Balancer-v0"


class BalanceJump(TaskBase):
    TASK = "Balancer-v1"


class StepsUp(TaskBase):
    TASK = "UpStepper-v0"


class StepsDown(TaskBase):
    TASK = "DownStepper-v0"


class WalkingBumpy(TaskBase):
    TASK = "ObstacleTraverser-v0"


class WalkingBumpy2(TaskBase):
    TASK = "ObstacleTraverser-v1"


class VerticalBarrier(TaskBase):
    TASK = "Hurdler-v0"


class Gaps(TaskBase):
    TASK = "GapJumper-v0"


class FloatingPlatform(TaskBase):
    TASK = "PlatformJumper-v0"


class BlockSoup(TaskBase):
    TASK = "Traverser-v0"


class LiftSmallRect(TaskBase):
    TASK = "Lifter-v0"


class CarrySmallRect(TaskBase):
    TASK = "Carrier-v0"


class CarrySmallRectToTable(TaskBase):
    TASK = "Carrier-v1"


class PushSmallRect(TaskBase):
    TASK = "Pusher-v0"


class PushSmallRectOnOppositeSide(TaskBase):
    TASK = "Pusher-v1"


class ToppleBeam(TaskBase):
    TASK = "BeamToppler-v0"


class SlideBeam(TaskBase):
    TASK = "BeamSlider-v0"


class ThrowSmallRect(TaskBase):
    TASK = "Thrower-v0"


class CatchSmallRect(TaskBase):
    TASK = "Catcher-v0"

    def _draws(self) -> dict[str, Any] | None:
        if DRAWS != "random":
            return None
        return {"ox": random.randint(-6, 4), "oy": random.randint(0, 5)}


class MaximizeShape(TaskBase):
    TASK = "AreaMaximizer-v0"


class MinimizeShape(TaskBase):
    TASK = "AreaMinimizer-v0"


class MaximizeXShape(TaskBase):
    TASK = "WingspanMazimizer-v0"


class MaximizeYShape(TaskBase):
    TASK = "HeightMaximizer-v0"


class Climb0(TaskBase):
    TASK = "Climber-v0"


class Climb1(TaskBase):
    TASK = "Climber-v1"


class Climb2(TaskBase):
    TASK = "Climber-v2"


class BiWalk(TaskBase):
    TASK = "BidirectionalWalker-v0"

    def _draws(self) -> dict[str, Any] | None:
        if DRAWS != "random":
            return None
        at, goals, way = 35, [], 0
        while way < 100:
            goals.append(random.randrange(20, 50))
            way += abs(goals[-1] - at)
            at = goals[-1]
        return {"goals": goals}
