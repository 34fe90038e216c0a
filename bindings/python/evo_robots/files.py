"""Files of the tools as arrays: rollouts, policies, runs. Needs h5py."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Sequence

import h5py
import numpy as np

from .library import needs
from .robots import robot_arrays
from .simulator import Simulator

__all__ = ["Episode", "read_log", "read_robots", "read_rollout", "read_run", "to_tensorboard",
           "write_actions", "write_policy"]


# ---- robots and runs ----------------------------------------------------------


def read_robots(path: str | os.PathLike) -> list[dict[str, Any]]:
    """The documents of a JSON Lines file."""
    with open(path) as file:
        return [json.loads(line) for line in file if line.strip()]


MATERIALS = ("empty", "rigid", "soft", "horizontal", "vertical")


def read_run(*folders: str | os.PathLike) -> Any:
    """The robots of any number of runs, finished or not, as one pandas frame; a row for each robot of
    a run, in the order in which they came.

    run, method, task, seed: of the run (method: by its name in a comparison, if it has one; task:
        of runs with an own fitness its program)
    generation, index: where the robot first was
    id, parents, body, voxels, empty, rigid, soft, horizontal, vertical: what it is, and its cells
    steps, fitness, best, perturbed: environment steps of its training, its fitness [none: failed],
        the best so far, the mean from perturbed starts
    seconds, policy: what its training took on all machines, and its policy file
    """
    pandas = needs("pandas", "data")
    rows = [row for folder in folders for row in _rows(Path(folder))]
    return pandas.DataFrame(rows, columns=None if rows else ["run", "id", "fitness"])


def _rows(folder: Path) -> list[dict[str, Any]]:
    settings = _settings(folder / "run.yaml")
    seconds: dict[str, float] = {}
    for journal in folder.glob("journal/*.jsonl"):
        for line in read_robots(journal):
            seconds[line["robot"]] = seconds.get(line["robot"], 0.0) + line["seconds"]
    rows: dict[str, dict[str, Any]] = {}
    for generation in sorted(folder.glob("gen-*"), key=lambda path: int(path.name[4:])):
        whole = generation / "scores.jsonl"
        slots = [whole] if whole.exists() else sorted(generation.glob("[0-9]*.json"))
        robots = [robot for slot in slots for robot in read_robots(slot)]
        for index, robot in enumerate(robots):
            first = rows.get(robot["id"], {"generation": int(generation.name[4:]), "index": index})
            rows[robot["id"]] = {**settings, **first, **_row(generation, robot, seconds)}
    best = float("nan")
    for row in rows.values():
        best = np.fmax(best, row["fitness"])
        row["best"] = best
    return list(rows.values())


def _row(folder: Path, robot: dict[str, Any], seconds: dict[str, float]) -> dict[str, Any]:
    cells = robot_arrays(robot)[0].astype(int)
    policy = robot.get("policy")
    return {
        "id": robot["id"], "parents": robot.get("parents", []), "body": "/".join(robot["body"]),
        "voxels": int(np.count_nonzero(cells)),
        **{name: int(np.count_nonzero(cells == kind)) for kind, name in enumerate(MATERIALS)},
        "steps": robot.get("steps"),
        "fitness": float("nan") if robot.get("fitness") is None else robot["fitness"],
        "best": None, "perturbed": robot.get("final", {}).get("mean", float("nan")),
        "seconds": seconds.get(robot["id"], float("nan")),
        "policy": None if policy is None else os.path.normpath(folder / policy)}


def _settings(file: Path) -> dict[str, Any]:
    """run.yaml is a mapping of names to scalars, a line each."""
    with open(file) as lines:
        known = dict(line.rstrip("\n").split(": ", 1) for line in lines if ": " in line)
    unquoted = {name: json.loads(text) if text.startswith('"') else text for name, text in known.items()}
    return {"run": str(file.parent), "method": unquoted.get("name", unquoted["method"]),
            "task": unquoted.get("task", unquoted.get("evaluate")), "seed": int(unquoted["seed"])}


# ---- trainings ---------------------------------------------------------------


def read_log(path: str | os.PathLike) -> list[dict[str, float]]:
    """What a training said at every evaluation, numbers by name: of the last training in its log."""
    lines: list[dict[str, float]] = []
    with open(path) as file:
        for line in filter(lambda text: text.endswith("\n"), file):  # the last may be half written
            if not line.startswith("#"):
                lines.append({name: float(value) for name, value in (
                    pair.split(" ") for pair in line.rstrip("\n").split("\t"))})
            elif not line.startswith("# trained") and not line.endswith("resumed\n"):
                lines = []
    return lines


def to_tensorboard(run: str | os.PathLike, folder: str | os.PathLike) -> None:
    """Writes a run's fitness, robot by robot, and the logs of its trainings as event files."""
    open_writer = needs("tensorboard.summary", "tensorboard").Writer
    series = {"": [{"charts/global_step": number, **{name: row[name] for name in ("fitness", "best")}}
                   for number, row in enumerate(_rows(Path(run)))]}
    series.update({log.stem: read_log(log) for log in sorted(Path(run).glob("policies/*.log"))})
    for name, lines in series.items():
        writer = open_writer(str(Path(folder, name)))
        for line in lines:
            step = int(line.pop("charts/global_step"))
            for tag, value in line.items():
                writer.add_scalar(tag, value, step)
        writer.close()


# ---- rollouts -----------------------------------------------------------------


@dataclass
class Episode:
    """T steps of a robot with A actuators in a world of N points."""

    observations: np.ndarray  # [T+1, D]
    actions: np.ndarray  # [T, A]
    rewards: np.ndarray  # [T]
    terminations: np.ndarray  # [T] bool
    truncations: np.ndarray  # [T] bool
    positions: np.ndarray | None  # [T+1, N, 2], raw units
    attributes: dict[str, Any] = field(default_factory=dict)


def read_rollout(path: str | os.PathLike) -> list[Episode]:
    with h5py.File(path) as file:
        count = int(file.attrs["total_episodes"])
        return [_episode(file[f"episode_{k}"]) for k in range(count)]


def _episode(group: h5py.Group) -> Episode:
    positions = group.get("infos/positions")
    return Episode(
        group["observations"][:], group["actions"][:], group["rewards"][:],
        group["terminations"][:].astype(bool), group["truncations"][:].astype(bool),
        None if positions is None else positions[:], dict(group.attrs))


def write_actions(path: str | os.PathLike, actions: Any) -> None:
    """Actions [T, A] as ``evo-eval --actions`` replays them."""
    values = np.asarray(actions, np.float64)
    if values.ndim != 2:
        raise ValueError(f"actions of shape {values.shape}; expected (steps, actuators)")
    with h5py.File(path, "w") as file:
        file["actions"] = values


# ---- policies -----------------------------------------------------------------


def write_policy(
    path: str | os.PathLike,
    simulator: Simulator,
    robot: dict[str, Any],
    layers: Sequence[tuple[Any, Any]],
    *,
    offset: float = 0.0,
    squash: bool = False,
    mean: Any = None,
    variance: Any = None,
    clip: float = 10.0,
    epsilon: float = 1e-8,
    fitness: float = float("nan"),
    steps: int = 0,
    created_by: str = "evo_robots",
) -> None:
    """A controller trained elsewhere, for evo-eval and evo-render.

    layers: weight [out, in] and bias [out] of each; tanh between them; the last
    one's outputs, plus ``offset``, are the targets, or with ``squash`` their tanh
    spread over the range of targets. mean, variance: of a running normaliser of
    observations, if there was one; epsilon is added to its variance, and it clips
    to +-clip.
    """
    length = int(simulator.observation_lengths[0])
    actions = int(simulator.action_lengths[0])
    _check_shapes(layers, length, actions)
    for name, values in (("mean", mean), ("variance", variance)):
        if (mean is None) != (variance is None) or (
                values is not None and np.shape(values) != (length,)):
            raise ValueError(f"mean and variance: {length} values of each are expected, or none")
    if squash and offset != 0:
        raise ValueError("offset belongs to targets that are not squashed")
    info = simulator.info
    known = simulator.task()
    with h5py.File(path, "w") as file:
        file.attrs.update({
            "format": "evo/policy", "version": np.int64(1), "robot": json.dumps(robot),
            **known, "training_yaml": "{}", "seed": np.uint64(0), "isa": "any",
            "observation_layout": json.dumps(info["robots"][0]["observation_layout"]),
            "created_by": created_by, "identity": "", "settings_hash": "",
            "fitness": float(fitness),
            "best_step": np.int64(steps), "steps": np.int64(steps), "kind": "network",
            "action_map": "squash" if squash else "offset", "action_offset": float(offset),
            "action_bounds": np.array([info["action_low"], info["action_high"]])})
        for number, (weight, bias) in enumerate(layers):
            file[f"actor/layer_{number}/weight"] = np.asarray(weight, np.float32)
            file[f"actor/layer_{number}/bias"] = np.asarray(bias, np.float32)
        # Nothing but training looks at the critic and the spread of actions.
        file["critic/layer_0/weight"] = np.zeros((1, length), np.float32)
        file["critic/layer_0/bias"] = np.zeros(1, np.float32)
        file["log_std"] = np.zeros(actions, np.float32)
        file["normalizer/mean"] = np.zeros(length) if mean is None else np.asarray(mean, float)
        file["normalizer/var"] = np.ones(length) if variance is None else np.asarray(variance, float)
        file["normalizer"].attrs.update({
            "count": 0.0 if mean is None else 1.0, "clip": 1e30 if mean is None else clip,
            "epsilon": epsilon})
        for name in ("step", "evaluation", "best"):
            file[f"curve/{name}"] = np.zeros(0, np.int64 if name == "step" else np.float64)


def _check_shapes(layers: Sequence[tuple[Any, Any]], observations: int, actions: int) -> None:
    width = observations
    for number, (weight, bias) in enumerate(layers):
        shape = np.shape(weight)
        if len(shape) != 2 or shape[1] != width or np.shape(bias) != shape[:1]:
            raise ValueError(f"layer {number}: weight {shape} and bias {np.shape(bias)}; expected "
                             f"(n, {width}) and (n,)")
        width = shape[0]
    if width != actions or not layers:
        raise ValueError(f"the last layer has {width} outputs for {actions} actuators")
