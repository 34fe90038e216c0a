"""Evolution Gym's own names over this simulator: ``EvoWorld``, ``WorldObject``, ``EvoSim``,
``EvoViewer``, the helpers for robots, and in ``evo_robots.evogym.envs`` the 32 environments
and the base classes for tasks of one's own. They mean what they mean there, to the last bit of
the physics. Targets of actuators outside of 0.6 to 1.6 are clipped, which there the base classes do.

    python -m evo_robots.evogym script.py    runs a script that says "import evogym"."""

from .sim import EvoSim
from .utils import (BASELINE_ENV_NAMES, VOXEL_TYPES, Pair, Timer, draw, get_full_connectivity,
                    get_uniform, has_actuator, hashable, is_connected, sample_robot)
from .viewer import EvoViewer
from .world import EvoWorld, WorldObject

__all__ = ["BASELINE_ENV_NAMES", "VOXEL_TYPES", "EvoSim", "EvoViewer", "EvoWorld", "Pair", "Timer",
           "WorldObject", "draw", "get_full_connectivity", "get_uniform", "has_actuator", "hashable", "is_connected",
           "sample_robot"]
