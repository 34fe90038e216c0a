"""What tests of the package share."""
import subprocess

import numpy as np

from evo_robots import find_tool

WALKER = np.array([[1, 3, 3, 3, 1], [4, 2, 2, 2, 4], [4, 3, 1, 3, 4], [4, 0, 0, 0, 4], [4, 0, 0, 0, 4]])
SMALL = np.array([[3, 4], [4, 3]])
FEW = {"environments": 4, "rollout": 32, "minibatches": 4, "evaluation_interval": 4}
FEW_OPTIONS = " ".join(f"--train {setting}={value}" for setting, value in FEW.items())


def tool(name, *words, **options):
    """What a tool says on standard output."""
    return subprocess.run([find_tool(name), *map(str, words)], capture_output=True, text=True, check=True,
                          **options).stdout
