"""python -m evo_robots FILE.py:CLASS [OPTION]... < robots: trains each robot of standard input in a
task in Python, and writes it with its fitness to standard output, as evo-train does. In pipelines:
EVALUATE='python3 -m evo_robots my_task.py:Task --steps 65536 --seed 1'."""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import sys
from pathlib import Path

from .library import EvoError
from .own import Task, train
from .robots import Robot


def task_class(named: str) -> type:
    file, _, name = named.rpartition(":")
    if not file:
        raise ValueError(f"{named}: FILE.py:CLASS is expected")
    if not os.path.isfile(file):
        raise ValueError(f"{file}: there is no such file")
    spec = importlib.util.spec_from_file_location(Path(file).stem, file)
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(Path(file).resolve().parent))
    spec.loader.exec_module(module)
    found = getattr(module, name, None)
    if not (isinstance(found, type) and issubclass(found, Task)):
        known = [key for key, value in vars(module).items()
                 if isinstance(value, type) and issubclass(value, Task) and value is not Task]
        raise ValueError(f"{file}: '{name}' is no evo_robots.Task; there are: " + ", ".join(known))
    return found


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m evo_robots",
        description="Trains each robot of standard input (documents, one a line) in a task in Python; "
        "writes it with its fitness to standard output. Stands in a pipeline as EVALUATE.")
    parser.add_argument("task", metavar="FILE.py:CLASS", help="a class derived from evo_robots.Task")
    parser.add_argument("--steps", type=int, metavar="N", help="environment steps [the profile's]")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="[0]")
    parser.add_argument("--train", default="default", metavar="PROFILE",
                        help="training profile by name or file [default]")
    parser.add_argument("--train-set", action="append", default=[], metavar="KEY=VALUE",
                        help="one setting of the profile (repeatable)")
    parser.add_argument("--out-dir", metavar="DIR", help="where <id>.policy.h5 goes [nowhere]")
    given = parser.parse_args()
    try:
        task = task_class(given.task)()
        settings = dict(text.split("=", 1) for text in given.train_set)
        for line in filter(str.strip, sys.stdin):
            document = json.loads(line)
            robot = Robot(document)
            trained = train(task, robot, steps=given.steps, seed=given.seed, profile=given.train,
                            settings=settings)
            document.update(fitness=trained.fitness, steps=int(trained.curve[-1, 0]))
            if given.out_dir is not None:
                os.makedirs(given.out_dir, exist_ok=True)
                document["policy"] = os.path.join(given.out_dir, f"{robot.id}.policy.h5")
                trained.save(document["policy"])
            print(json.dumps(document), flush=True)
    except (EvoError, ValueError) as error:
        print(f"evo_robots: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
