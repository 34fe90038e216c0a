"""libevo within this process: its C interface (evo/evo.h) by way of ctypes."""

from __future__ import annotations

import ctypes
import ctypes.util
import functools
import importlib
import operator
import os
import shutil
import sys
from ctypes import (POINTER, Structure, byref, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t,
                    c_uint64, c_uint8, c_void_p)
from pathlib import Path
from typing import Any, Mapping, Sequence

import numpy as np

class EvoError(RuntimeError):
    """What the library or a tool could not do: what, where, and what to do about it. diverged: the
    work itself came to numbers that are not finite; nothing was wrong with the call."""

    def __init__(self, text: str, diverged: bool = False) -> None:
        super().__init__(text)
        self.diverged = diverged


def needs(module: str, extra: str) -> Any:
    """A package that only some functions need."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as missing:
        name = missing.name.split(".")[0]
        raise EvoError(f"this needs {name}: pip install {name}, or evo-robots[{extra}]") from None


def whole(name: str, value: Any, low: int, high: int) -> int:
    """A whole number within bounds; nothing is cut off: 1.9, "5" and 2**64 are refused."""
    try:
        number = operator.index(value)
    except TypeError:
        raise ValueError(f"{name}: {value!r} is not a whole number") from None
    if not low <= number <= high:
        raise ValueError(f"{name}: {number} is not from {low} to {high}")
    return number


def whole64(name: str, value: Any, low: int = 0) -> int:
    """What an unsigned number of 64 bits holds."""
    return whole(name, value, low, (1 << 64) - 1)


def numbers(name: str, values: Any) -> np.ndarray:
    """An array of doubles; texts, masked and complex arrays are refused."""
    given = np.asanyarray(values)
    if given.dtype.kind not in "biuf" or isinstance(given, np.ma.MaskedArray):
        raise ValueError(f"{name}: plain numbers are expected, not {type(values).__name__} of {given.dtype}")
    return np.ascontiguousarray(given, np.float64)


def targets(values: Any, low: float, high: float) -> np.ndarray:
    """Targets of actuators as doubles. Those of single precision are clipped in it, as the
    benchmark does: 1.6 is 1.600000023841858 then, which the library takes for the bound."""
    if isinstance(values, np.ndarray) and values.dtype in (np.float32, np.float16):
        values = np.clip(values, low, high)
    return numbers("actions", values)


class Whole32:
    """An argument of 32 bits, which ctypes by itself would cut larger numbers to."""

    @staticmethod
    def from_param(value: Any) -> c_int32:
        return c_int32(whole("an argument", value, -(1 << 31), (1 << 31) - 1))


class TaskFacts(Structure):
    _fields_ = [("name", c_char_p), ("yaml", c_char_p), ("episode_steps", c_int32),
                ("hold", c_int32), ("action_low", c_double), ("action_high", c_double),
                ("physics_yaml", c_char_p)]


class RobotFacts(Structure):
    _fields_ = [("id", c_char_p), ("json", c_char_p), ("rows", c_int32), ("columns", c_int32),
                ("voxels", c_void_p)]


class EnvArrays(Structure):
    _fields_ = [*[(name, c_size_t) for name in (
                    "environments", "observation_values", "action_values", "points")],
                *[(name, c_void_p) for name in (
                    "observation_offsets", "action_offsets", "point_offsets", "observations",
                    "rewards", "terminated", "truncated", "status", "steps", "positions",
                    "velocities")]]


class EnvObject(Structure):
    _fields_ = [("name", c_char_p), ("first_point", c_size_t), ("points", c_size_t)]


class VoxelFacts(Structure):
    _fields_ = [*[(name, c_size_t) for name in (
                    "voxels", "actions", "links", "local_length", "task_length", "fixed_length")],
                *[(name, c_void_p) for name in ("fixed", "actuators", "linked")]]


class Start(Structure):
    _fields_ = [("has_seed", c_int32), ("has_episode", c_int32), ("seed", c_uint64),
                ("episode", c_uint64), ("jitter", c_double), ("draws", c_char_p)]


class View(Structure):
    _fields_ = [("width", c_int32), ("height", c_int32), ("hide", c_int32), ("reserved", c_int32),
                ("window", c_double * 4)]


class SimArrays(Structure):
    _fields_ = [("sims", c_size_t), ("points", c_size_t), ("actuators", c_size_t),
                ("positions", c_void_p), ("velocities", c_void_p), ("status", c_void_p),
                ("action_low", c_double), ("action_high", c_double), ("voxels", c_size_t)]


class SimGradients(Structure):
    _fields_ = [*[(name, c_size_t) for name in ("sims", "points", "actuators", "voxels")],
                *[(name, c_void_p) for name in ("positions", "velocities", "previous", "targets",
                                                "stiffness", "constants")]]


class SimObject(Structure):
    _fields_ = [("name", c_char_p), ("first_point", c_size_t), ("points", c_size_t),
                ("first_actuator", c_size_t), ("actuators", c_size_t)]


class PolicyFacts(Structure):
    _fields_ = [("observation_length", c_size_t), ("action_length", c_size_t),
                ("fitness", c_double), ("curve_points", c_size_t), ("curve", c_void_p),
                ("seed", c_uint64)]


class CurvePoint(Structure):
    _fields_ = [("step", c_int64), ("evaluation", c_double), ("best", c_double)]


class Training(Structure):
    GO_ON = ctypes.CFUNCTYPE(c_int, c_int64, c_void_p)
    _fields_ = [("profile", c_char_p), ("set", POINTER(c_char_p)), ("set_count", c_size_t),
                ("steps", c_int64), ("seed", c_uint64), ("go_on", GO_ON), ("user", c_void_p)]


class LearnerFacts(Structure):
    _fields_ = [("environments", c_int32), ("rollout", c_int32), ("updates", c_int64),
                ("evaluation_interval", c_int32), ("evaluation_episodes", c_int32),
                ("evaluation_jitter", c_double), ("start_jitter", c_double),
                ("final_jitter", c_double), ("final_episodes", c_int32), ("reserved", c_int32)]


class OwnEpisode(Structure):
    _fields_ = [("task_yaml", c_char_p), ("steps", c_size_t), ("observation_values", c_size_t),
                ("action_values", c_size_t), ("observations", c_void_p), ("actions", c_void_p),
                ("rewards", c_void_p), ("positions", c_void_p), ("terminated", c_uint8),
                ("truncated", c_uint8)]


EVO_WORK = 1
_HANDLE, _OPENED = c_void_p, POINTER(c_void_p)
_STATE = [_HANDLE, Whole32, POINTER(c_void_p), POINTER(c_size_t)]
_RENDER = [_HANDLE, Whole32, c_void_p, POINTER(View), c_size_t, c_void_p, c_size_t]
SIGNATURES = {
    "evo_task_open": [c_char_p, _OPENED],
    "evo_task_set_physics": [_HANDLE, POINTER(c_char_p), c_size_t],
    "evo_task_describe": [_HANDLE, POINTER(TaskFacts), c_size_t],
    "evo_robots_new": [_OPENED],
    "evo_robots_read": [c_char_p, _OPENED],
    "evo_robots_parse": [c_char_p, _OPENED],
    "evo_robots_append": [_HANDLE, _HANDLE, c_size_t],
    "evo_robots_count": [_HANDLE, POINTER(c_size_t)],
    "evo_robots_describe": [_HANDLE, c_size_t, POINTER(RobotFacts), c_size_t],
    "evo_robots_svg": [_HANDLE, c_size_t, Whole32, POINTER(c_void_p)],
    "evo_envs_open": [_HANDLE, _HANDLE, Whole32, Whole32, _OPENED],
    "evo_envs_arrays": [_HANDLE, POINTER(EnvArrays), c_size_t],
    "evo_envs_reset": [_HANDLE, c_void_p, c_size_t, POINTER(Start)],
    "evo_envs_step": [_HANDLE, c_void_p, c_size_t, c_void_p, c_size_t],
    "evo_envs_save": _STATE,
    "evo_envs_restore": [_HANDLE, Whole32, c_char_p, c_size_t],
    "evo_envs_translate": [_HANDLE, Whole32, c_size_t, c_double, c_double],
    "evo_envs_object_count": [_HANDLE, Whole32, POINTER(c_size_t)],
    "evo_envs_object": [_HANDLE, Whole32, c_size_t, POINTER(EnvObject), c_size_t],
    "evo_envs_orientation": [_HANDLE, Whole32, c_size_t, c_void_p, POINTER(c_double), c_size_t],
    "evo_envs_observed": [_HANDLE, Whole32, POINTER(c_void_p)],
    "evo_envs_voxels": [_HANDLE, Whole32, POINTER(VoxelFacts), c_size_t],
    "evo_envs_look": [_HANDLE, c_void_p, c_size_t, c_void_p, c_size_t],
    "evo_envs_act": [_HANDLE, _HANDLE, c_void_p, c_size_t],
    "evo_envs_render": _RENDER,
    "evo_world_new": [_OPENED],
    "evo_world_read": [c_char_p, _OPENED],
    "evo_world_parse": [c_char_p, _OPENED],
    "evo_world_add": [_HANDLE, c_char_p, c_void_p, Whole32, Whole32, c_void_p, c_size_t, Whole32,
                      Whole32],
    "evo_world_stiffen": [_HANDLE, c_char_p, c_void_p, c_size_t],
    "evo_world_move": [_HANDLE, c_char_p, Whole32, Whole32],
    "evo_world_remove": [_HANDLE, c_char_p],
    "evo_world_json": [_HANDLE, POINTER(c_void_p)],
    "evo_sims_open": [_HANDLE, c_char_p, Whole32, Whole32, _OPENED],
    "evo_sims_arrays": [_HANDLE, POINTER(SimArrays), c_size_t],
    "evo_sims_reset": [_HANDLE, Whole32],
    "evo_sims_step": [_HANDLE, c_void_p, c_size_t, c_void_p, c_size_t],
    "evo_sims_record": [_HANDLE, c_double],
    "evo_sims_pull_back": [_HANDLE, POINTER(SimGradients), c_size_t],
    "evo_sims_save": _STATE,
    "evo_sims_restore": [_HANDLE, Whole32, c_char_p, c_size_t],
    "evo_sims_translate": [_HANDLE, Whole32, c_size_t, c_double, c_double],
    "evo_sims_perturb": [_HANDLE, Whole32, c_double, c_uint64],
    "evo_sims_object_count": [_HANDLE, POINTER(c_size_t)],
    "evo_sims_object": [_HANDLE, c_size_t, POINTER(SimObject), c_size_t],
    "evo_sims_orientation": [_HANDLE, c_size_t, c_void_p, c_void_p, c_size_t],
    "evo_sims_render": _RENDER,
    "evo_policy_read": [c_char_p, _OPENED],
    "evo_policy_describe": [_HANDLE, POINTER(PolicyFacts), c_size_t],
    "evo_policy_act": [_HANDLE, c_void_p, c_void_p, c_size_t, c_void_p, c_size_t],
    "evo_policy_write": [_HANDLE, c_char_p],
    "evo_policy_set_final": [_HANDLE, Whole32, c_double, c_double],
    "evo_policy_task": [_HANDLE, _OPENED],
    "evo_policy_record": [_HANDLE, _HANDLE, POINTER(OwnEpisode), c_size_t, c_char_p],
    "evo_train": [_HANDLE, _HANDLE, c_size_t, POINTER(Training), c_size_t, _OPENED],
    "evo_learner_open": [POINTER(Training), c_size_t, Whole32, Whole32, c_double, c_double, c_char_p,
                         _OPENED],
    "evo_learner_describe": [_HANDLE, POINTER(LearnerFacts), c_size_t],
    "evo_learner_observe": [_HANDLE, c_void_p, c_size_t, c_void_p, c_size_t],
    "evo_learner_act": [_HANDLE, c_void_p, c_size_t],
    "evo_learner_reward": [_HANDLE, c_void_p, c_void_p, c_void_p, c_void_p, c_size_t, c_void_p,
                           c_size_t],
    "evo_learner_learn": [_HANDLE],
    "evo_learner_policy": [_HANDLE, _HANDLE, c_size_t, c_char_p, POINTER(CurvePoint), c_size_t,
                           _OPENED],
}
FREES = ("evo_task_free", "evo_robots_free", "evo_envs_free", "evo_world_free", "evo_sims_free",
         "evo_policy_free", "evo_learner_free", "evo_free")
PACKAGE = Path(__file__).parent  # a wheel has the tools and the library within


def find_tool(name: str) -> str:
    """The path of one of the tools: in the folder $EVO_BIN, in this package, beside this Python, or
    in PATH."""
    for folder in (os.environ.get("EVO_BIN"), str(PACKAGE / "suite" / "bin"),
                   os.path.dirname(sys.executable)):
        if folder and os.access(os.path.join(folder, name), os.X_OK):
            return os.path.join(folder, name)
    found = shutil.which(name)
    if found is None:
        raise EvoError(f"{name} is not in PATH; install evo, or name its folder in EVO_BIN")
    return found


def _candidates() -> list[str]:
    """In $EVO_LIBRARY, in this package, beside the tools (built or installed)."""
    found = [os.environ.get("EVO_LIBRARY", "")]
    tools = [os.environ.get("EVO_BIN") or str(PACKAGE / "suite" / "bin"),
             os.path.dirname(shutil.which("evo-eval") or "")]
    found += [os.path.join(folder, os.pardir, libraries, "libevo.so.0.1") for folder in tools if folder
              for libraries in ("lib", "lib64", "lib/x86_64-linux-gnu", "lib/aarch64-linux-gnu")]
    return [path for path in found if path and os.path.exists(path)]


@functools.lru_cache(maxsize=None)
def library() -> ctypes.CDLL:
    """The library, loaded once. Throws EvoError where there is none."""
    path = next(iter(_candidates()), None) or ctypes.util.find_library("evo")
    if path is None:
        raise EvoError("libevo.so is not beside the tools; install evo, or name it in EVO_LIBRARY")
    loaded = ctypes.CDLL(path)
    try:
        for name, arguments in SIGNATURES.items():
            getattr(loaded, name).argtypes = arguments
            getattr(loaded, name).restype = c_int
    except AttributeError:
        raise EvoError(f"{path} is of an older version than this package: it has no {name}") from None
    for name in FREES:
        getattr(loaded, name).argtypes = [c_void_p]
        getattr(loaded, name).restype = None
    loaded.evo_error.restype = loaded.evo_version.restype = c_char_p
    return loaded


def call(name: str, *arguments: Any) -> None:
    """A function of the library; its error becomes an EvoError."""
    try:
        status = getattr(library(), name)(*arguments)
    except ctypes.ArgumentError as error:
        raise ValueError(f"{name}: {error}") from None
    if status != 0:
        raise failure(status)


def failure(status: int) -> EvoError:
    """The last one of this thread."""
    return EvoError(library().evo_error().decode(errors="replace"), diverged=status == EVO_WORK)


def text_of(value: Any) -> bytes:
    text = os.fspath(value)
    if "\0" in text:  # where C would end it
        raise ValueError(f"{text!r} has a NUL in it")
    return text.encode()


def texts_of(values: Sequence[Any]) -> Any:
    return (c_char_p * len(values))(*map(text_of, values))


def assignments(settings: Mapping[str, Any] | None) -> list[str]:
    """As the tools take settings: ``gravity=50``."""
    return [f"{name}={value}" for name, value in (settings or {}).items()]


def address(values: np.ndarray) -> int:
    try:  # three times as quick as what follows
        return ctypes.addressof(ctypes.c_char.from_buffer(values))
    except (TypeError, ValueError):  # not to be written to, or empty
        return values.__array_interface__["data"][0]


def text_given(name: str, *arguments: Any) -> str:
    """A text that a function gives away."""
    place = c_void_p()
    call(name, *arguments, byref(place))
    try:
        return ctypes.string_at(place).decode()
    finally:
        library().evo_free(place)


def bytes_given(name: str, *arguments: Any) -> bytes:
    place, count = c_void_p(), c_size_t()
    call(name, *arguments, byref(place), byref(count))
    try:
        return ctypes.string_at(place, count.value)
    finally:
        library().evo_free(place)


def facts(name: str, kind: Any, *arguments: Any) -> Any:
    """A struct that a function fills."""
    found = kind()
    call(name, *arguments, byref(found), ctypes.sizeof(found))
    return found


HIDDEN = ("grid", "background", "edges", "voxels")  # evo_hide, 1 << k


def picture(function: str, handle: "Handle", index: int, width: int, height: int, *,
            positions: Any = None, window: Any = None, hide: Sequence[str] = ()) -> np.ndarray:
    """[height, width, 3] uint8, what a function of the library draws. positions: [n, 2], kept
    before [now]. window: centre x and y, width and height, voxels [what moves]. hide: of HIDDEN."""
    unknown = set(hide) - set(HIDDEN)
    if unknown:
        raise ValueError(f"hide: {unknown.pop()!r} is none of {', '.join(HIDDEN)}")
    width, height = (whole(name, size, -(1 << 31), (1 << 31) - 1) for name, size in
                     (("width", width), ("height", height)))
    view = View(width, height, sum(1 << HIDDEN.index(part) for part in set(hide)))
    if window is not None:
        view.window[:] = [float(value) for value in window]
    given = None if positions is None else np.ascontiguousarray(positions, np.float64)
    pixels = np.empty((max(0, height), max(0, width), 3), np.uint8)
    call(function, handle, index, None if given is None else address(given), byref(view),
         ctypes.sizeof(view), address(pixels), pixels.nbytes)
    return pixels


class Handle:
    """What a function of the library opened; freed once nothing refers to it."""

    def __init__(self, kind: str, opener: str, *arguments: Any) -> None:
        self._as_parameter_ = c_void_p()
        self._free = getattr(library(), f"evo_{kind}_free")
        call(opener, *arguments, byref(self._as_parameter_))

    def __del__(self) -> None:
        if getattr(self, "_free", None) and self._as_parameter_:
            self._free(self._as_parameter_)

    def __reduce__(self) -> Any:
        raise TypeError("a handle of the library cannot be pickled")


def array_at(owner: Handle, place: int, shape: tuple, kind: Any) -> np.ndarray:
    """The library's own values, not copied and not to be written to. The owner lives as
    long as the array does."""
    count = int(np.prod(shape))
    if count == 0:
        return np.zeros(shape, kind)
    memory = (kind * count).from_address(place)
    memory._owner = owner
    values = np.frombuffer(memory, np.dtype(kind)).reshape(shape)
    values.flags.writeable = False
    return values


def count_of(name: str, *arguments: Any) -> int:
    count = c_size_t()
    call(name, *arguments, byref(count))
    return count.value


def task_of(task: Any, physics: Any, settings: Any) -> Handle:
    """A task by name or file, with its physics changed as --physics does; or one opened before."""
    opened = task if isinstance(task, Handle) else Handle("task", "evo_task_open", text_of(task))
    words = texts_of(([] if physics is None else [physics]) + assignments(settings))
    if words:
        call("evo_task_set_physics", opened, words, len(words))
    return opened
