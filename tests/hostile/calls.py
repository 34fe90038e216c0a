"""Calls the Python package, and through it the C interface, with generated arguments.

    calls.py FILE    FILE: a robot, damaged; its bytes decide what is called

A call returns or raises; a whole number that is accepted was one. Anything else ends the
process: a signal, or status 70 with a line that says what was accepted.
"""
import faulthandler
import operator
import os
import random
import sys

sys.path.insert(0, os.environ["EVO_SOURCE"] + "/bindings/python")
import numpy  # noqa: E402

import evo_robots  # noqa: E402

BODY = [[3, 4], [4, 3]]
CALLS = 12  # in one process, on the same simulations
VALUES = [
    None, True, -1, 0, 1.9, -0.5, float("nan"), float("inf"), 2**31, 2**63, 2**64 + 3, -(2**70), "5", "", "\0x",
    "x" * 3000, b"\xff\xfe", [], [[]], {}, {"body": 3}, [None], numpy.zeros((2, 3), object), numpy.full((1, 2), 9),
    numpy.zeros(0), numpy.full((2, 2), numpy.nan), numpy.array(7), numpy.zeros((3, 2, 4)), object(), "../../x",
]
WHOLE = {"envs", "seed", "episode", "count", "sim", "environment", "width", "height", "x", "y"}


def cases(text):
    """Name, function, arguments that are right."""
    simulator = evo_robots.Simulator("Walker-v0", BODY, envs=2)
    simulator.reset()
    world = evo_robots.World()
    world.add("ground", numpy.full((1, 20), 5), 0, 0)
    world.add("robot", numpy.array(BODY), 1, 1)
    sims = evo_robots.Simulations(world, 2)
    actions = numpy.ones(sims.num_actuators * 2).reshape(2, -1)
    return [
        ("Robot", evo_robots.Robot, {"robot": BODY, "connections": None, "stiffness": [[1, 2], [3, 4]]}),
        ("Robot of the file", evo_robots.Robot, {"robot": text}),
        ("Simulator", evo_robots.Simulator, {"task": "Walker-v0", "robots": BODY, "envs": 1}),
        ("reset", simulator.reset, {"seed": 1, "episode": 0, "draws": {}, "jitter": 0.0}),
        ("step", simulator.step, {"actions": numpy.ones((2, 4)), "mask": None}),
        ("restore", simulator.restore, {"states": simulator.save(), "environments": [0, 1]}),
        ("orientation", simulator.orientation, {"name": "robot", "environment": 0}),
        ("translate", simulator.translate, {"name": "robot", "by": (0.1, 0.0), "environment": 0}),
        ("add", world.add, {"name": "box", "body": numpy.ones((1, 1)), "x": 9, "y": 4}),
        ("stiffen", world.stiffen, {"name": "robot", "factors": [[1, 2], [3, 4]]}),
        ("perturb", sims.perturb, {"jitter": 0.1, "seed": 1, "sim": 0}),
        ("move", world.move, {"name": "robot", "x": 2, "y": 1}),
        ("from_json", evo_robots.World.from_json, {"text": world.json()}),
        ("Simulations", evo_robots.Simulations, {"world": world, "count": 1}),
        ("step of simulations", sims.step, {"targets": actions, "mask": None}),
        ("state of simulations", sims.restore, {"state": sims.save(), "sim": 0}),
        ("picture", sims.picture, {"sim": 0, "width": 32, "height": 16}),
    ]


def main():
    faulthandler.enable()
    with open(sys.argv[1], "rb") as file:
        data = file.read()
    generator = random.Random(data)
    calls = cases(data.decode("utf-8", "replace"))
    for _ in range(CALLS):
        name, function, arguments = generator.choice(calls)
        wrong = generator.choice(sorted(arguments))
        value = generator.choice(VALUES)
        try:
            function(**{**arguments, wrong: value})
        except Exception:  # whichever: that it is raised is the point
            continue
        if wrong in WHOLE and value is not None:
            try:
                operator.index(value)
            except TypeError:
                print(f"{name}: {wrong}={value!r} was accepted", file=sys.stderr)
                return 70
    return 0


if __name__ == "__main__":
    sys.exit(main())
