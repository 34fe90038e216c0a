"""The base classes for tasks of one's own, and the 32 environments, in Gymnasium's registry by the
benchmark's names. Needs Gymnasium."""

import sys

import gymnasium

from ...tasks import TASKS
from . import base, tasks
from .base import BenchmarkBase, EvoGymBase
from .tasks import *  # noqa: F403
from .. import *  # noqa: F403  as there

__all__ = ["BenchmarkBase", "EvoGymBase", *tasks.__all__]

CLASSES = {found.TASK: found for found in map(vars(tasks).get, tasks.__all__) if getattr(found, "TASK", "")}
for _name, _limit in TASKS.items():
    gymnasium.register(_name, entry_point=f"{__name__}:{CLASSES[_name].__name__}",
                       max_episode_steps=_limit)

# The benchmark has them in files of their own.
for _name in ("balance", "change_shape", "climb", "flip", "jump", "manipulate", "multi_goal", "traverse",
              "walk"):
    sys.modules[f"{__name__}.{_name}"] = tasks
