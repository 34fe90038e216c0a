"""python -m evo_robots tensorboard RUN FOLDER: see files.to_tensorboard.
python -m evo_robots FILE.py:CLASS [OPTION]... < robots: trains each robot of standard input in a
task in Python, and writes it with its fitness to standard output, as evo-train does. Runs with
--task FILE.py:CLASS do this (evo evolve)."""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import sys
import traceback
from pathlib import Path

from .library import PACKAGE, EvoError, needs
from .own import Task, Trained, check_training, train
from .robots import Robot

WRONG, BAD_DATA, INTERRUPTED = 2, 65, 130  # exit statuses, as the tools have them


def task_class(named: str) -> type:
    file, _, name = named.rpartition(":")
    if not file:
        raise ValueError(f"{named}: FILE.py:CLASS is expected")
    if not os.path.isfile(file):
        raise ValueError(f"{file}: there is no such file")
    spec = importlib.util.spec_from_file_location(Path(file).stem, file)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    sys.path.insert(0, str(Path(file).resolve().parent))
    spec.loader.exec_module(module)
    found = getattr(module, name, None)
    if not (isinstance(found, type) and issubclass(found, Task)):
        known = [key for key, value in vars(module).items()
                 if isinstance(value, type) and issubclass(value, Task) and value is not Task]
        raise ValueError(f"{file}: '{name}' is no evo_robots.Task; there are: " + ", ".join(known))
    return found


def options() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="evo_robots", usage="python3 -m evo_robots FILE.py:CLASS [OPTION]... < robots\n"
        "       python3 -m evo_robots tensorboard RUN FOLDER",
        description="Trains each robot of standard input (documents, one a line) in a task in Python; "
        "writes it with its fitness to standard output. Runs do this where --task is FILE.py:CLASS.")
    parser.add_argument("task", metavar="FILE.py:CLASS", help="a class derived from evo_robots.Task")
    parser.add_argument("--steps", type=int, metavar="N", help="environment steps [the profile's]")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="[0]")
    parser.add_argument("--train", action="append", default=[], metavar="PROFILE|KEY=VALUE",
                        help="a training profile by name or file, or one setting (repeatable) [default]")
    parser.add_argument("--out-dir", metavar="DIR", help="where <id>.policy.h5, <id>.log and its "
                        "episode, <id>.rollout.h5, go [nowhere]")
    parser.add_argument("--rollout", nargs=2, metavar=("POLICY", "FILE"),
                        help="instead: a policy's episode as a rollout, for evo-render and others")
    parser.add_argument("--failures", choices=("stop", "skip"), default="stop",
                        help="a training that diverges: stop, or skip (fitness null, continue) [stop]")
    return parser


def main() -> int:
    tracked = sys.argv[2:] if sys.argv[1:2] == ["tensorboard"] and len(sys.argv) == 4 else None
    given = None if tracked else options().parse_args()
    try:
        if tracked:
            needs("evo_robots.files", "data").to_tensorboard(*tracked)
            return 0
        profiles = [text for text in given.train if "=" not in text.split("/")[0]]
        training = {"steps": given.steps, "seed": given.seed, "profile": (["default"] + profiles)[-1],
                    "settings": dict(text.split("=", 1) for text in given.train if text not in profiles)}
        check_training(**training)
        task = task_class(given.task)()
        if given.rollout is not None:
            Trained.read(given.rollout[0]).rollout(given.rollout[1], task)
            return 0
        for line in filter(str.strip, sys.stdin):
            document = json.loads(line)
            robot = Robot(document)
            try:
                trained = train(task, robot, **training)
            except EvoError as error:
                if not error.diverged or given.failures == "stop":
                    raise
                document.update(fitness=None, failure={"why": str(error)})
            else:
                document.update(fitness=trained.fitness, steps=int(trained.curve[-1, 0]))
                if trained.final is not None:
                    document["final"] = trained.final
                if (folder := given.out_dir) is not None:
                    os.makedirs(folder, exist_ok=True)
                    trained.rollout(os.path.join(folder, f"{robot.id}.rollout.h5"))
                    Path(folder, f"{robot.id}.log").write_text("".join(
                        f"charts/global_step {step:.0f}\teval/return {value:.6g}\teval/best {best:.6g}\n"
                        for step, value, best in trained.curve))
                    document["policy"] = os.path.join(folder, f"{robot.id}.policy.h5")
                    trained.save(document["policy"])
            print(json.dumps(document), flush=True)
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        ours = Path(traceback.extract_tb(error.__traceback__)[-1].filename).parent == PACKAGE
        if isinstance(error, (EvoError, OSError, ValueError, NotImplementedError)) and ours:
            print(f"evo_robots: {error}", file=sys.stderr)
            return WRONG
        traceback.print_exc()  # of the task: its author wants to know where
        return BAD_DATA
    return 0


if __name__ == "__main__":
    sys.exit(main())
