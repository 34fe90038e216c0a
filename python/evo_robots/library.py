"""libevo within this process: its C interface (evo/evo.h) by way of ctypes."""

from __future__ import annotations

import ctypes
import ctypes.util
import functools
import os
import shutil
from ctypes import POINTER, byref, c_char_p, c_double, c_int32, c_size_t, c_uint8, c_void_p
from typing import Any

import numpy as np

from .simulator import EvoError

__all__ = ["Handle", "SimArrays", "SimObject", "array_at", "call", "library", "text_given"]


class SimArrays(ctypes.Structure):
    _fields_ = [("sims", c_size_t), ("points", c_size_t), ("actuators", c_size_t),
                ("positions", c_void_p), ("velocities", c_void_p), ("status", c_void_p),
                ("action_low", c_double), ("action_high", c_double)]


class SimObject(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("first_point", c_size_t), ("points", c_size_t),
                ("first_actuator", c_size_t), ("actuators", c_size_t)]


SIGNATURES = {
    "evo_world_new": [POINTER(c_void_p)],
    "evo_world_read": [c_char_p, POINTER(c_void_p)],
    "evo_world_parse": [c_char_p, POINTER(c_void_p)],
    "evo_world_add": [c_void_p, c_char_p, c_void_p, c_int32, c_int32, c_void_p, c_size_t, c_int32,
                      c_int32],
    "evo_world_move": [c_void_p, c_char_p, c_int32, c_int32],
    "evo_world_remove": [c_void_p, c_char_p],
    "evo_world_json": [c_void_p, POINTER(c_void_p)],
    "evo_sims_open": [c_void_p, c_char_p, c_int32, c_int32, POINTER(c_void_p)],
    "evo_sims_arrays": [c_void_p, POINTER(SimArrays), c_size_t],
    "evo_sims_reset": [c_void_p, c_int32],
    "evo_sims_step": [c_void_p, c_void_p, c_size_t, c_void_p, c_size_t],
    "evo_sims_save": [c_void_p, c_int32, POINTER(c_void_p), POINTER(c_size_t)],
    "evo_sims_restore": [c_void_p, c_int32, c_char_p, c_size_t],
    "evo_sims_object_count": [c_void_p, POINTER(c_size_t)],
    "evo_sims_object": [c_void_p, c_size_t, POINTER(SimObject), c_size_t],
    "evo_sims_orientation": [c_void_p, c_size_t, c_void_p, c_void_p, c_size_t],
}
FREES = ("evo_world_free", "evo_sims_free", "evo_free")


def _candidates() -> list[str]:
    """In $EVO_LIBRARY, beside the tools (built or installed), where the system looks."""
    found = [os.environ.get("EVO_LIBRARY", "")]
    tool = os.environ.get("EVO_BIN") or os.path.dirname(shutil.which("evo-eval") or "")
    if tool:
        found += [os.path.join(tool, os.pardir, folder, "libevo.so.0.1")
                  for folder in ("lib", "lib64", "lib/x86_64-linux-gnu", "lib/aarch64-linux-gnu")]
    return [path for path in found if path and os.path.exists(path)]


@functools.cache
def library() -> ctypes.CDLL:
    """The library, loaded once. Throws EvoError where there is none."""
    path = next(iter(_candidates()), None) or ctypes.util.find_library("evo")
    if path is None:
        raise EvoError("libevo.so is not beside the tools; install evo, or name it in EVO_LIBRARY")
    loaded = ctypes.CDLL(path)
    for name, arguments in SIGNATURES.items():
        getattr(loaded, name).argtypes = arguments
        getattr(loaded, name).restype = ctypes.c_int
    for name in FREES:
        getattr(loaded, name).argtypes = [c_void_p]
        getattr(loaded, name).restype = None
    loaded.evo_error.restype = c_char_p
    return loaded


def call(name: str, *arguments: Any) -> None:
    """A function of the library; its error becomes an EvoError."""
    if getattr(library(), name)(*arguments) != 0:
        raise EvoError(library().evo_error().decode(errors="replace"))


def text_given(name: str, handle: "Handle") -> str:
    """A text that a function gives away."""
    place = c_void_p()
    call(name, handle, byref(place))
    try:
        return ctypes.string_at(place).decode()
    finally:
        library().evo_free(place)


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
        raise TypeError("what a simulation holds cannot be pickled; save() gives its state")


def array_at(owner: Handle, address: int, shape: tuple[int, ...], kind: Any) -> np.ndarray:
    """The library's own values, not copied and not to be written to. The owner lives as
    long as the array does."""
    count = int(np.prod(shape))
    if count == 0:
        return np.zeros(shape, kind)
    memory = (kind * count).from_address(address)
    memory._owner = owner
    values = np.frombuffer(memory, np.dtype(kind)).reshape(shape)
    values.flags.writeable = False
    return values
