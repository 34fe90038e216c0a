"""Evolution Gym's own names over this simulator: ``EvoWorld``, ``WorldObject``, ``EvoSim``,
the helpers for robots, and in ``evo_robots.evogym.envs`` the base classes for tasks of
one's own. They mean what they mean there, to the last bits of the physics.

Not here: ``EvoViewer`` and render modes (evo-render draws), the 32 environments (they
are ``evo/NAME`` in Gymnasium). Targets of actuators outside of 0.6 to 1.6 are clipped,
which there the base classes do."""

from .sim import EvoSim
from .utils import (BASELINE_ENV_NAMES, VOXEL_TYPES, Pair, draw, get_full_connectivity,
                    get_uniform, has_actuator, hashable, is_connected, sample_robot)
from .world import EvoWorld, WorldObject

__all__ = ["BASELINE_ENV_NAMES", "VOXEL_TYPES", "EvoSim", "EvoWorld", "Pair", "WorldObject", "draw",
           "get_full_connectivity", "get_uniform", "has_actuator", "hashable", "is_connected",
           "sample_robot"]
