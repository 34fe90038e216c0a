"""Stands for the benchmark's package in a program that python -m evo_robots.evogym runs, and in the
processes it starts."""

import pkgutil
import sys
import types
import typing

import evo_robots.evogym
from evo_robots.evogym import sim, utils, viewer, world

# What the package's modules have of others, and hand on to whoever imports * of them.
_OF_OTHERS = {
    "": "np random time Tuple Optional",
    ".world": "json np random time Any Dict List Optional Tuple",
    ".sim": "np random time Dict Set Tuple Optional",
    ".utils": "np random time Tuple Optional",
    ".viewer": "np time List Optional Tuple",
    ".envs": "gym error spaces utils seeding np random math os pkg_resources time register Any Dict "
             "List Optional Tuple",
}
_PLACES = {  # of those that are no module of that name
    "np": "numpy", "gym": "gymnasium", "error": "gymnasium.error", "spaces": "gymnasium.spaces",
    "utils": "gymnasium.utils", "seeding": "gymnasium.utils.seeding",
    "register": "gymnasium.envs.registration:register",
    **{name: f"typing:{name}" for name in ("Any", "Dict", "List", "Optional", "Set", "Tuple")}}


def _stand_in(name: str, module: types.ModuleType, kind: str, also: tuple = ()) -> None:
    brought = {}
    for other in _OF_OTHERS[kind].split():
        try:
            brought[other] = pkgutil.resolve_name(_PLACES.get(other, other))
        except ModuleNotFoundError:  # pkg_resources, of newer Pythons
            continue
    for given in also:
        brought.update({other: getattr(given, other) for other in given.__all__})
    for other, value in brought.items():
        if not hasattr(module, other):
            setattr(module, other, value)
    module.__all__ = sorted({*module.__all__, *brought})
    sys.modules["evogym" + name] = module


for _name, _module, _also in (("", evo_robots.evogym, ()), (".utils", utils, ()), (".world", world, (utils,)),
                              (".sim", sim, (utils, world)), (".viewer", viewer, (sim,))):
    _stand_in(_name, _module, _name, _also)


class _Camera:
    def __init__(self, *_: typing.Any) -> None:
        raise NotImplementedError("the camera is a part of EvoViewer here")


_compiled = types.ModuleType("evogym.simulator_cpp")
_compiled.Sim, _compiled.Viewer, _compiled.Camera = sim.EvoSim, viewer.EvoViewer, _Camera
sim.Sim, viewer.Viewer, viewer.Camera = _compiled.Sim, _compiled.Viewer, _Camera
sim.__all__ += ["Sim"]
viewer.__all__ += ["Camera", "Timer", "Viewer"]
sys.modules[_compiled.__name__] = evo_robots.evogym.simulator_cpp = _compiled
try:
    from evo_robots.evogym import envs
except ModuleNotFoundError:  # no Gymnasium: the simulator does without
    pass
else:
    for _name, _module in list(sys.modules.items()):
        if _name == envs.__name__ or _name.startswith(envs.__name__ + "."):
            _stand_in(_name.replace("evo_robots.evogym", "", 1), _module, ".envs",
                      (evo_robots.evogym, envs))
