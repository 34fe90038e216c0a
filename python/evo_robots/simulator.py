"""The client of ``evo-env``: environments in a process of their own, stepped
over pipes in binary frames (docs/evo-env.md). Needs numpy alone."""

from __future__ import annotations

import contextlib
import itertools
import json
import os
import re
import select
import shutil
import struct
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from typing import Any, Iterator, Mapping, Sequence

import numpy as np

from .robots import is_matrix, robot_document

__all__ = ["EvoError", "Simulator", "State", "env_mask", "find_tool"]

HEADER = struct.Struct("<4sI")
STATUS = ("ok", "unreset", "unstable")


class LookOut:
    """Whether an answer is worth looking out for before the process is put to sleep
    for it. One asleep on an idle processor is woken some 50 us after its answer has
    come: as long as a step of a small robot takes. Looking out in vain costs others
    the processor, so the next turn is put off, each time for twice as long. As in
    evo-env itself (cli/env/stream.h)."""

    LONGEST = 200e-6  # s
    LONGEST_PUT_OFF = 1024  # waits

    def __init__(self, descriptor: int) -> None:
        self._poll = select.poll()
        self._poll.register(descriptor, select.POLLIN)
        self._put_off = 0  # waits that the last turn in vain put the next one off for
        self._left = 0  # of them

    def wait(self) -> None:
        """Returns once there is input (or its end), or after a moment without."""
        if self._left > 0:
            self._left -= 1
            return
        end = time.perf_counter() + self.LONGEST
        while not self._poll.poll(0):
            if time.perf_counter() > end:
                self._put_off = min(max(2 * self._put_off, 1), self.LONGEST_PUT_OFF)
                self._left = self._put_off
                return
        self._put_off = 0


class EvoError(RuntimeError):
    """A request that evo-env could not fulfil, or a process that is gone."""


def find_tool(name: str) -> str:
    """The path of one of the tools: in the folder $EVO_BIN, beside this Python,
    or in PATH."""
    for folder in (os.environ.get("EVO_BIN"), os.path.dirname(sys.executable)):
        if folder and os.access(os.path.join(folder, name), os.X_OK):
            return os.path.join(folder, name)
    found = shutil.which(name)
    if found is None:
        raise EvoError(f"{name} is not in PATH; install evo, or name its folder in EVO_BIN")
    return found


def env_mask(mask: Any, envs: int) -> np.ndarray:
    """One truth value for each environment, [E]; numbers of environments, or one value for
    all, would be taken for something else."""
    values = np.asarray(mask)
    if values.shape != (envs,) or not np.isin(values, (0, 1)).all():
        raise ValueError(f"a mask has {envs} values, each True or False, not {mask!r}")
    return values.astype(bool)


@dataclass(frozen=True)
class State:
    """What every environment shows after a reset or a step. The arrays are new
    with every state."""

    observations: np.ndarray  # float64; [E, D] where all have one length, else all in one row
    rewards: np.ndarray  # [E] float64
    terminated: np.ndarray  # [E] bool, ended by a rule of the task
    truncated: np.ndarray  # [E] bool, ended by the time limit
    status: np.ndarray  # [E] uint8, an index of STATUS


class Simulator:
    """``envs`` environments for each robot in one task; environment ``e`` holds
    robot ``e // envs``.

    robots: a body as a matrix, a tuple ``(body, connections)``, the path of a file, a
    robot document as a dict, or a list of any of these.

    Belongs to the process that made it: one forked from that makes its own. A request
    that is interrupted (by Ctrl-C) closes it, for nobody knows how far that came.
    """

    def __init__(
        self,
        task: str,
        robots: Any,
        envs: int = 1,
        *,
        seed: int = 0,
        jobs: int = 1,
        fast: bool = False,
        physics: str | None = None,
        settings: Mapping[str, Any] | None = None,
    ) -> None:
        command = [find_tool("evo-env"), "--task", os.fspath(task), "--mode", "binary",
                   "--envs", str(envs), "--seed", str(seed), "--jobs", str(jobs)]
        if fast:
            command.append("--fast")
        if physics is not None:
            command += ["--physics", os.fspath(physics)]
        for key, value in (settings or {}).items():
            command += ["--set", f"{key}={value}"]
        self._process: subprocess.Popen | None = None
        with contextlib.ExitStack() as documents:
            files = [documents.enter_context(_document_file(group)) if not are_paths else group
                     for are_paths, group in _grouped(robots)]
            names = [name for file in files for name in (
                file if isinstance(file, list) else [f"/dev/fd/{file.fileno()}"])]
            self._errors = tempfile.TemporaryFile()
            self._process = subprocess.Popen(
                command + ["--"] + names,
                bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors,
                pass_fds=[file.fileno() for file in files if not isinstance(file, list)],
                start_new_session=True)  # Ctrl-C is for us to hear
        self._owner = os.getpid()
        self._ending = "the simulator was closed"
        self._in = self._process.stdout.fileno()
        self._out = self._process.stdin.fileno()
        self._look_out = LookOut(self._in)
        self._state_bytes = 0
        self._awaited = False
        self.info: dict[str, Any] = json.loads(self._exchange(None, b"JSON"))

        robots_info = self.info["robots"]
        self.num_envs: int = len(robots_info) * envs
        self.observation_lengths = np.repeat([r["observation_length"] for r in robots_info], envs)
        self.action_lengths = np.repeat([r["action_length"] for r in robots_info], envs)
        self._observation_values = int(self.observation_lengths.sum())
        self._action_values = int(self.action_lengths.sum())
        self._same_length = len(set(self.observation_lengths.tolist())) == 1
        self._state_bytes = 8 * self._observation_values + 11 * self.num_envs
        self._action_shapes = [(self._action_values,)]
        if len(set(self.action_lengths.tolist())) == 1:
            self._action_shapes.insert(0, (self.num_envs, int(self.action_lengths[0])))
        self._step_header = HEADER.pack(b"STEP", 8 * self._action_values)
        self._mask = np.zeros((self.num_envs + 7) // 8 * 8, np.uint8)
        self._mask_header = HEADER.pack(b"MASK", self._mask.nbytes + 8 * self._action_values)

    @property
    def pid(self) -> int:
        """The process of evo-env."""
        return self._running().pid

    # ---- requests -----------------------------------------------------------

    def reset(
        self,
        environments: Sequence[int] | None = None,
        *,
        seed: int | None = None,
        episode: int | None = None,
        draws: Mapping[str, Any] | None = None,
        jitter: float = 0.0,
    ) -> State:
        """Begins episodes. What is not given: the seed stays, episodes are
        counted on, the task's draws follow from seed and episode."""
        wanted: dict[str, Any] = {"jitter": jitter}
        if environments is not None:
            wanted["environments"] = [int(e) for e in environments]
        if seed is not None:
            wanted["seed"] = int(seed)
        if episode is not None:
            wanted["episode"] = int(episode)
        if draws is not None:
            wanted["draws"] = draws
        return self._state(self._exchange({"reset": wanted}, b"DATA"))

    def step(self, actions: Any, mask: Any = None) -> State:
        """One control step: actions of all environments, [E, A], or one after the
        other in one row. Those of environments outside of ``mask``, [E], are ignored."""
        try:
            self.send_step(actions, mask)
            return self.receive_step()
        except BaseException as error:
            self._abandon(error)
            raise

    def send_step(self, actions: Any, mask: Any = None) -> None:
        """The first half of step(): returns while the environments move."""
        values = np.ascontiguousarray(actions, np.float64)
        if values.shape not in self._action_shapes:
            raise ValueError(f"actions of shape {values.shape}; expected "
                             + " or ".join(map(str, self._action_shapes)))
        payload = memoryview(values.reshape(-1)).cast("B")
        if mask is not None:
            self._mask[: self.num_envs] = env_mask(mask, self.num_envs)
        try:
            if mask is None:
                self._send(self._step_header, payload)
            else:
                self._send(self._mask_header, memoryview(self._mask), payload)
            self._awaited = True
        except BaseException as error:
            self._abandon(error)
            raise

    def receive_step(self) -> State:
        if not self._awaited:
            raise EvoError("no step is under way")
        self._awaited = False
        try:
            return self._state(self._receive(b"DATA"))
        except BaseException as error:
            self._abandon(error)
            raise

    def save(self, environments: Sequence[int] | None = None) -> list[bytes]:
        """The states of episodes in progress, of all environments or of these: opaque,
        for restore() in this or another Simulator of the same robots and task."""
        wanted = {} if environments is None else {"environments": [int(e) for e in environments]}
        payload = self._exchange({"save": wanted}, b"SAVE")
        [count] = struct.unpack_from("<Q", payload)
        table = struct.unpack_from(f"<{2 * count}Q", payload, 8)
        states, at = [], 8 + 16 * count
        for length in table[1::2]:
            states.append(bytes(payload[at : at + length]))
            at += length
        return states

    def restore(self, states: Sequence[bytes], environments: Sequence[int] | None = None) -> State:
        """Puts states into the environments, each into one: their episodes go on from
        there, as often as they are restored, to the same bits."""
        places = range(self.num_envs) if environments is None else environments
        if isinstance(states, bytes) or len(states) != len(places):
            raise ValueError(f"a list of {len(places)} states is expected")
        table = [struct.pack("<qQ", int(e), len(state)) for e, state in zip(places, states)]
        payload = b"".join([struct.pack("<Q", len(states)), *table, *states])
        return self._state(self._exchange(payload, b"DATA", b"LOAD"))

    def positions(self, environment: int = 0) -> dict[str, Any]:
        """All points of the world: ``positions`` and ``velocities`` [N, 2], raw
        units, and ``objects``, a dict from names to slices of the points."""
        [found] = json.loads(
            self._exchange({"positions": {"environments": [environment]}}, b"JSON"))["positions"]
        return {
            "positions": np.array(found["positions"]).reshape(-1, 2),
            "velocities": np.array(found["velocities"]).reshape(-1, 2),
            "objects": {o["name"]: slice(o["first_point"], o["first_point"] + o["points"])
                        for o in found["objects"]},
        }

    def picture(self, environment: int = 0, width: int = 600, height: int = 300) -> np.ndarray:
        """[height, width, 3] uint8."""
        payload = self._exchange(
            {"picture": {"environment": environment, "width": width, "height": height}}, b"PICT")
        width, height = struct.unpack_from("<II", payload)
        return np.frombuffer(payload, np.uint8, offset=8).reshape(height, width, 3)

    def task(self) -> dict[str, str]:
        """``task``, ``task_yaml`` and ``physics_yaml``, as files keep them."""
        return json.loads(self._exchange({"task": {}}, b"JSON"))

    def close(self) -> None:
        """Ends the process. Safe to call twice."""
        process, self._process = self._process, None
        if process is None:
            return
        process.stdin.close()
        process.stdout.close()
        if self._owner == os.getpid():
            process.wait()
        else:  # it goes on for the one it belongs to
            process.returncode = 0
        self._errors.close()

    def __enter__(self) -> "Simulator":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_process", None) is not None:
            self.close()

    # ---- frames ---------------------------------------------------------------

    def _running(self) -> subprocess.Popen:
        if self._process is None:
            raise EvoError(self._ending)
        if self._owner != os.getpid():
            raise EvoError(f"this simulator belongs to process {self._owner}, from which this one "
                           "was forked; make one here")
        return self._process

    def _abandon(self, error: BaseException) -> None:
        """After a request that was interrupted, of which nobody knows how far it came."""
        if not isinstance(error, (EvoError, ValueError)):
            self.close()
            self._ending = "the simulator was closed: a request was interrupted; make another one"

    def _exchange(self, request: Any, expected: bytes, kind: bytes = b"JSON") -> Any:
        """A request, a document or bytes, unless there is none, and its answer."""
        try:
            if request is not None:
                text = request if kind != b"JSON" else json.dumps(request).encode()
                self._send(HEADER.pack(kind, len(text)), memoryview(text))
            return self._receive(expected)
        except BaseException as error:
            self._abandon(error)
            raise

    def _send(self, *pieces: Any) -> None:
        self._running()
        if self._awaited:
            raise EvoError("a step is under way; receive_step() takes its result")
        rest = [memoryview(piece) for piece in pieces]
        try:
            while rest:
                sent = os.writev(self._out, rest)
                while rest and sent >= len(rest[0]):
                    sent -= len(rest.pop(0))
                if rest and sent:
                    rest[0] = rest[0][sent:]
        except BrokenPipeError:
            raise self._gone() from None

    def _receive(self, expected: bytes) -> memoryview:
        # A state is by far the most frequent answer: read with its header at once.
        buffer = np.empty(HEADER.size + self._state_bytes, np.uint8)
        view = memoryview(buffer)
        wanted = len(view) if expected == b"DATA" else HEADER.size
        self._look_out.wait()
        got = self._fill(view, 0, HEADER.size, wanted)
        kind, length = HEADER.unpack_from(view)
        whole = HEADER.size + length
        if whole > len(view):
            larger = np.empty(whole, np.uint8)
            larger[:got] = buffer[:got]
            view = memoryview(larger)
        self._fill(view, got, whole, whole)
        payload = view[HEADER.size : whole]
        if kind == b"FAIL":
            raise EvoError(json.loads(bytes(payload))["error"])
        if kind != expected:
            raise EvoError(f"evo-env answered {kind!r} instead of {expected!r}")
        return _text(payload) if expected == b"JSON" else payload

    def _fill(self, view: memoryview, got: int, needed: int, most: int) -> int:
        while got < needed:
            n = os.readv(self._in, [view[got:most]])
            if n == 0:
                raise self._gone()
            got += n
        return got

    def _state(self, payload: memoryview) -> State:
        count, values = self.num_envs, self._observation_values
        observations = np.frombuffer(payload, np.float64, values)
        flags = np.frombuffer(payload, np.uint8, 3 * count, 8 * (values + count))
        return State(
            observations.reshape(count, -1) if self._same_length else observations,
            np.frombuffer(payload, np.float64, count, 8 * values),
            flags[:count].view(np.bool_),
            flags[count : 2 * count].view(np.bool_),
            flags[2 * count :],
        )

    def _gone(self) -> EvoError:
        process, self._process = self._process, None
        status = process.wait()
        process.stdin.close()
        process.stdout.close()
        self._errors.seek(0)
        said = self._errors.read().decode(errors="replace").strip()
        said = re.sub(r"/dev/fd/\d+", "robots given", said)
        self._errors.close()
        return EvoError(said or f"evo-env ended with status {status}")


def _text(payload: memoryview) -> str:
    return bytes(payload).decode()


def _is_path(robot: Any) -> bool:
    return isinstance(robot, (str, os.PathLike))


def _grouped(robots: Any) -> Iterator[tuple[bool, list[Any]]]:
    """Robots in order: runs of paths, and runs of anything else."""
    for are_paths, group in itertools.groupby(_listed(robots), _is_path):
        yield are_paths, [os.fspath(robot) for robot in group] if are_paths else list(group)


def _document_file(robots: list[Any]) -> Any:
    """A file without a name, for a child that inherits it."""
    lines = [json.dumps(robot_document(robot)).encode() + b"\n" for robot in robots]
    file = tempfile.TemporaryFile()
    file.writelines(lines)
    file.flush()
    file.seek(0)
    return file


def _listed(robots: Any) -> list[Any]:
    """One robot or a list of them."""
    if _is_path(robots) or isinstance(robots, (Mapping, np.ndarray)):
        return [robots]
    robots = robots if isinstance(robots, tuple) else list(robots)
    if is_matrix(robots):
        return [np.asarray(robots)]
    if isinstance(robots, tuple) and len(robots) == 2:
        return [robots]  # (body, connections)
    return list(robots)
