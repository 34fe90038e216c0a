"""Robots made of voxels on the tasks of Evolution Gym, simulated in this process.

    import gymnasium, evo_robots
    body, connections = evo_robots.sample_robot((5, 5))
    env = gymnasium.make("evo/Walker-v0", body=body, connections=connections)

Reading files (evo_robots.files) needs h5py; everything else numpy and, for the
environments, Gymnasium.
"""

from .library import EvoError, find_tool
from .own import Task, Trained, train
from .robots import (VOXEL_TYPES, Robot, get_full_connectivity, has_actuator, is_connected, robot_arrays,
                     robot_document, sample_robot)
from .simulator import Simulator, State, Voxels
from .tasks import TASKS, register
from .worlds import Simulations, World

__version__ = "0.1.0"
__all__ = ["TASKS", "VOXEL_TYPES", "EvoError", "Robot", "Simulations", "Simulator", "State", "Task",
           "Trained", "Voxels", "World", "find_tool", "get_full_connectivity", "has_actuator", "is_connected",
           "robot_arrays", "robot_document", "sample_robot", "train"]

try:
    import gymnasium as _gymnasium
except ModuleNotFoundError:  # Simulator does without
    pass
else:
    from . import environment, vector

    register()
