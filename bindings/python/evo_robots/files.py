"""Files of the tools as arrays: rollouts, policies, runs. Needs h5py."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Sequence

import h5py
import numpy as np

from .simulator import Simulator

__all__ = ["Episode", "read_history", "read_robots", "read_rollout", "read_run", "write_actions",
           "write_policy"]


# ---- robots and runs ----------------------------------------------------------


def read_robots(path: str | os.PathLike) -> list[dict[str, Any]]:
    """The documents of a JSON Lines file."""
    with open(path) as file:
        return [json.loads(line) for line in file if line.strip()]


def read_run(folder: str | os.PathLike) -> list[dict[str, Any]]:
    """All robots that a run has evaluated, in order."""
    return read_robots(Path(folder) / "history.jsonl")


def read_history(folder: str | os.PathLike) -> Any:
    """The robots that a run has evaluated as a pandas frame, a row each in order: id, fitness, best (so
    far), and whatever else of numbers and texts their documents say."""
    import pandas

    frame = pandas.DataFrame([
        {key: value for key, value in robot.items()
         if key not in ("format", "version") and isinstance(value, (str, int, float))}
        for robot in read_run(folder)])
    frame.insert(min(2, frame.shape[1]), "best", frame["fitness"].cummax())
    return frame


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
