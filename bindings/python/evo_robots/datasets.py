"""Tables that others have published, as robots and policies of the suite."""

from __future__ import annotations

import io
import math
import os
import pickle
import re
import zipfile
from pathlib import Path
from typing import Any, Iterator

import numpy as np

from .robots import robot_document
from .simulator import Simulator

__all__ = ["read_evogym"]

COLUMNS = ("uid", "body", "connections", "reward", "env_name")
ACTION_OFFSET = 1.0  # the training code of that time gave the environment 1 + a
OBSERVATION_CLIP = 10.0


def read_evogym(path: str | os.PathLike, policies: str | os.PathLike | None = None) -> Iterator[dict[str, Any]]:
    """The robots of a parquet table of Evolution Gym's authors (columns uid, body, connections, reward,
    env_name, and generated_by or policy_blob), as documents with ``fitness`` and ``task``.

    policies: a folder for the controllers of policy_blob, UID.policy.h5; a document then has ``policy``.
    They are read without running any code that is in them (needs h5py, and a PyTorch archive of
    networks of Linear and Tanh layers with a running normaliser). Needs pyarrow.
    """
    import pyarrow.parquet

    table = pyarrow.parquet.ParquetFile(path)
    names = table.schema_arrow.names
    missing = [name for name in COLUMNS if name not in names]
    if missing:
        raise ValueError(f"{path}: has no column {', '.join(missing)}; there are: " + ", ".join(names))
    if policies is not None and "policy_blob" not in names:
        raise ValueError(f"{path}: has no column policy_blob, and so no policies")
    wanted = [*COLUMNS, *(name for name in ("generated_by", "policy_blob") if name in names)]
    number = 0
    for batch in table.iter_batches(batch_size=256, columns=wanted):
        for row in batch.to_pylist():
            try:
                yield _document(row, policies)
            except ValueError as error:
                raise ValueError(f"{path}: row {number} (uid {row['uid']}): {error}") from None
            number += 1


def _document(row: dict[str, Any], policies: Any) -> dict[str, Any]:
    body = np.array(row["body"], float)
    document = robot_document((body, np.array(row["connections"], int).reshape(2, -1)))
    document.update(fitness=row["reward"], task=row["env_name"], origin={
        "tool": "evogym-dataset", "uid": row["uid"],
        **({"generated_by": row["generated_by"]} if row.get("generated_by") else {})})
    if policies is not None and row["policy_blob"] is not None:
        if not re.fullmatch(r"[A-Za-z0-9_-][A-Za-z0-9_.-]*", str(row["uid"])):
            raise ValueError("its uid cannot be the name of a file")
        os.makedirs(policies, exist_ok=True)
        file = Path(policies, f"{row['uid']}.policy.h5")
        _write_policy(file, document, row["policy_blob"])
        document["policy"] = str(file)
    return document


# ---- policies -----------------------------------------------------------------------------


class _Thing:
    """Stands for an object of a class that is not here: its attributes, and nothing it could do."""

    def __init__(self, *_: Any, **__: Any) -> None:
        pass

    def __setstate__(self, state: Any) -> None:
        if isinstance(state, tuple):  # of classes with slots
            state = {key: value for part in state if part for key, value in part.items()}
        self.__dict__.update(state if isinstance(state, dict) else {})


class _Storage:
    """The numbers of tensors, by PyTorch's names of types."""

    TYPES = {"FloatStorage": np.float32, "DoubleStorage": np.float64, "LongStorage": np.int64,
             "IntStorage": np.int32}


def _exactly(kind: type, *values: Any) -> None:
    if not all(type(value) is kind for value in values):
        raise ValueError(f"the policy has something else where {kind.__name__} is expected")


def _tensor(storage: Any, offset: Any, size: Any, stride: Any, *_: Any) -> np.ndarray:
    _exactly(np.ndarray, storage)
    _exactly(tuple, size, stride)
    _exactly(int, offset, *size, *stride)
    if min(offset, *size, *stride, 0) < 0 or len(size) != len(stride):
        raise ValueError("the policy has a tensor of an impossible shape")
    last = offset + sum((n - 1) * step for n, step in zip(size, stride)) if all(size) else offset
    if math.prod(size) > storage.size or (all(size) and last >= storage.size):
        raise ValueError("the policy's tensors reach beyond their numbers")
    return np.lib.stride_tricks.as_strided(
        storage[offset:], size, tuple(step * storage.itemsize for step in stride)).copy()


class _Type(_Thing):
    """A type of numbers, by NumPy's names."""

    def __init__(self, name: Any, *_: Any) -> None:
        _exactly(str, name)
        self.name, self.order = name, "<"

    def __setstate__(self, state: Any) -> None:
        _exactly(tuple, state)
        if len(state) < 2 or state[1] not in ("<", "|"):
            raise ValueError("the policy has numbers in an order of bytes that is not read")

    def numbers(self, data: Any, shape: Any) -> np.ndarray:
        """[*shape], as many as there are bytes for."""
        _exactly(tuple, shape)
        _exactly(int, *shape)
        _exactly(bytes, data)
        if not re.fullmatch("[fiub][1248]", self.name):  # an object would be an address
            raise ValueError(f"the policy has numbers of the type {self.name!r}")
        found = np.frombuffer(data, "<" + self.name)
        if min(shape, default=0) < 0 or found.size != math.prod(shape):
            raise ValueError("the policy has an array of another shape than its numbers")
        return found.reshape(shape)


class _Array(_Thing):
    """An array of NumPy's; ``values`` once its state is there."""

    values = np.empty(0)

    def __setstate__(self, state: Any) -> None:
        _exactly(tuple, state)
        _, shape, kind, by_columns, data = state
        _exactly(_Type, kind)
        self.values = kind.numbers(data, shape if not by_columns else shape[::-1])
        if by_columns:
            self.values = self.values.T


def _scalar(kind: Any, data: Any) -> _Array:
    _exactly(_Type, kind)
    found = _Array()
    found.values = kind.numbers(data, ())
    return found


def _bytes(text: Any, encoding: Any) -> bytes:
    _exactly(str, text)
    return text.encode("latin1")


class _Reader(pickle.Unpickler):
    """Numbers and containers are read, exactly the types that are named here; every other class
    becomes a _Thing."""

    KNOWN = {
        ("collections", "OrderedDict"): dict,
        ("_codecs", "encode"): _bytes,  # of arrays
        ("torch._utils", "_rebuild_tensor_v2"): _tensor,
        ("torch._utils", "_rebuild_parameter"): lambda data, *_: data,
        ("numpy", "ndarray"): _Array, ("numpy", "dtype"): _Type,
        **{(f"numpy.{core}.multiarray", name): made for core in ("core", "_core")
           for name, made in (("_reconstruct", _Array), ("scalar", _scalar))},
    }

    def __init__(self, archive: zipfile.ZipFile, folder: str) -> None:
        super().__init__(io.BytesIO(archive.read(f"{folder}/data.pkl")))
        self._archive, self._folder = archive, folder

    def find_class(self, module: str, name: str) -> Any:
        if module == "torch" and name in _Storage.TYPES:
            return type(name, (_Storage,), {"kind": _Storage.TYPES[name]})
        return self.KNOWN.get((module, name)) or type(name, (_Thing,), {})

    def persistent_load(self, saved: Any) -> np.ndarray:
        _exactly(tuple, saved)
        _, kind, key, *_ = saved
        if not (isinstance(kind, type) and issubclass(kind, _Storage)):
            raise ValueError("the policy has tensors of an unknown type")
        return np.frombuffer(self._archive.read(f"{self._folder}/data/{key}"), kind.kind)


def _read_archive(blob: bytes) -> Any:
    try:
        with zipfile.ZipFile(io.BytesIO(blob)) as archive:
            [pickled] = [name for name in archive.namelist() if name.endswith("/data.pkl")]
            return _Reader(archive, pickled[: -len("/data.pkl")]).load()
    except Exception as error:  # whatever a damaged pickle asks for
        raise ValueError(f"the policy is no archive of PyTorch that can be read: {error}") from None


def _linear(module: Any, what: str) -> tuple[np.ndarray, np.ndarray]:
    parameters = getattr(module, "_parameters", {})
    weight, bias = (parameters.get(name) for name in ("weight", "bias"))
    if not isinstance(weight, np.ndarray) or weight.ndim != 2 or not isinstance(bias, np.ndarray):
        raise ValueError(f"the policy's {what} is no Linear layer")
    return weight, bias


def _write_policy(path: Path, document: dict[str, Any], blob: bytes) -> None:
    from .files import write_policy

    found = _read_archive(blob)
    if not (isinstance(found, (list, tuple)) and len(found) == 2):
        raise ValueError("the policy is not a network with the normaliser of its observations")
    network, normaliser = found
    parts = getattr(network, "_modules", {})
    actor = getattr(getattr(parts.get("base"), "_modules", {}).get("actor"), "_modules", {})
    layers = []
    for number, module in actor.items():
        kind = type(module).__name__
        if kind == "Linear":
            layers.append(_linear(module, f"actor's layer {number}"))
        elif kind != "Tanh":
            raise ValueError(f"the policy's actor has a layer {kind}; Linear and Tanh are expected")
    layers.append(_linear(getattr(parts.get("dist"), "_modules", {}).get("fc_mean"), "head"))
    with Simulator(document["task"], document) as simulator:
        length = int(simulator.observation_lengths[0])
        mean, variance = (np.asarray(getattr(getattr(normaliser, name, None), "values", ()), float).ravel()
                          for name in ("mean", "var"))
        if normaliser is None:
            mean = variance = None
        elif len(mean) != length or len(variance) != length:
            raise ValueError(f"the policy's normaliser is of {len(mean)} observations, the robot has {length}")
        write_policy(path, simulator, document, layers, offset=ACTION_OFFSET, mean=mean,
                     variance=variance, clip=OBSERVATION_CLIP, fitness=document["fitness"],
                     created_by="evogym-dataset")
