"""Stands for the benchmark's package in a program that python -m evo_robots.evogym runs, and in the
processes it starts."""

import sys

import evo_robots.evogym
from evo_robots.evogym import sim, utils, viewer, world

for _name, _module in (("", evo_robots.evogym), (".sim", sim), (".utils", utils), (".viewer", viewer),
                       (".world", world)):
    sys.modules["evogym" + _name] = _module
try:
    from evo_robots.evogym import envs
except ModuleNotFoundError:  # no Gymnasium: the simulator does without
    pass
else:
    for _name, _module in list(sys.modules.items()):
        if _name == envs.__name__ or _name.startswith(envs.__name__ + "."):
            sys.modules[_name.replace("evo_robots.", "", 1)] = _module
