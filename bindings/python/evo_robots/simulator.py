"""Environments of tasks within this process, without Gymnasium: one robot or many, of one size or
several. Needs numpy alone."""

from __future__ import annotations

import ctypes
import json
from dataclasses import dataclass
from typing import Any, Mapping, Sequence

import numpy as np

from .library import (EnvArrays, EnvObject, EvoError, Handle, RobotFacts, Start, TaskFacts, VoxelFacts,
                      address, array_at, bytes_given, call, count_of, facts, failure, library, picture, targets,
                      task_of, text_given, whole, whole64)
from .robots import robots_of, stiffened

__all__ = ["STATUS", "Simulator", "State", "Voxels", "env_mask"]

STATUS = ("ok", "unreset", "unstable")


def env_mask(mask: Any, envs: int) -> np.ndarray:
    """One truth value for each environment, [E]; numbers of environments, or one value for
    all, would be taken for something else."""
    values = np.asarray(mask)
    if values.shape != (envs,) or not np.isin(values, (0, 1)).all():
        raise ValueError(f"a mask has {envs} values, each True or False, not {mask!r}")
    return values.astype(np.uint8)


@dataclass(frozen=True)
class State:
    """What every environment shows after a reset or a step. The arrays are new
    with every state."""

    observations: np.ndarray  # float64; [E, D] where all have one length, else all in one row
    rewards: np.ndarray  # [E] float64
    terminated: np.ndarray  # [E] bool, ended by a rule of the task
    truncated: np.ndarray  # [E] bool, ended by the time limit
    status: np.ndarray  # [E] uint8, an index of STATUS


@dataclass(frozen=True)
class Voxels:
    """What does not change of what a robot's V voxels see (Simulator.look has the rest), for
    controllers that are the same for every body; docs/modular.md says which numbers. Voxels are in
    scan order, row by row from the top."""

    fixed: np.ndarray  # [V, F] float32: materials around the voxel, its place, the body as a whole
    actuators: np.ndarray  # [A] int32, the voxel of each action
    links: np.ndarray  # [N, 2] int32, a voxel and one that it is linked to; each link both ways
    local_length: int  # L
    task_length: int  # T

    @property
    def mask(self) -> np.ndarray:
        """[V] bool, whether a voxel acts."""
        mask = np.zeros(len(self.fixed), bool)
        mask[self.actuators] = True
        return mask


class Simulator:
    """``envs`` environments for each robot in one task; environment ``e`` holds
    robot ``e // envs``. ``jobs``: threads that share a step.

    robots: a body as a matrix, a tuple ``(body, connections)``, a Robot, the path of a file, a
    robot document as a dict, or a list of any of these. stiffness: of one robot, see Robot.

    The arrays are the library's own: they show what is after every reset and step, and are copied
    by whoever wants to keep them. Raw units: a voxel is 0.1 wide.

    Copied and pickled, a simulator continues from where it is. A forked process may continue with one
    of ``jobs=1``. Threads may use several simulators at once; a second thread in one of them gets
    an EvoError. Ctrl-C, or the stop button of a notebook, comes between two steps.
    """

    observations: np.ndarray  # and the others of State, with
    steps: np.ndarray  # [E] taken in this episode
    positions: np.ndarray  # [E, P, 2], or [points of all, 2] where numbers of points differ
    velocities: np.ndarray  # the same
    info: dict[str, Any]  # task, episode_steps, action_low, action_high; robots with their lengths

    def __init__(
        self,
        task: Any,
        robots: Any,
        envs: int = 1,
        *,
        seed: int = 0,
        jobs: int = 1,
        stiffness: Any = None,
        physics: Any = None,
        settings: Mapping[str, Any] | None = None,
    ) -> None:
        self._task = task_of(task, physics, settings)
        known = robots_of(robots if stiffness is None else stiffened(robots, stiffness))
        self._open(known, envs, jobs)
        self._seed = whole64("seed", seed)
        described = [facts("evo_robots_describe", RobotFacts, known, index)
                     for index in range(self.num_envs // envs)]
        task_facts = self._task_facts()
        self.info = {
            "task": task_facts.name.decode(), "episode_steps": task_facts.episode_steps,
            "hold": task_facts.hold,
            "action_low": task_facts.action_low, "action_high": task_facts.action_high,
            "environments_per_robot": envs,
            "robots": [{
                "id": robot.id.decode(), "rows": robot.rows, "cols": robot.columns,
                "observation_length": int(self.observation_lengths[index * envs]),
                "action_length": int(self.action_lengths[index * envs]),
                "observation_layout": json.loads(
                    text_given("evo_envs_observed", self._handle, index * envs)),
            } for index, robot in enumerate(described)]}
        # What makes another one of the same.
        self._made = dict(
            task=task, robots=[json.loads(robot.json) for robot in described], envs=envs, jobs=jobs,
            seed=seed, physics=physics,
            settings=None if settings is None else dict(settings))

    def _open(self, robots: Handle, envs: int, jobs: int) -> None:
        self._handle: Handle | None = Handle("envs", "evo_envs_open", self._task, robots, envs, jobs)
        self._do_step = library().evo_envs_step
        at = facts("evo_envs_arrays", EnvArrays, self._handle)
        self.num_envs: int = at.environments
        self._per_robot = envs

        def array(place: int, shape: tuple, kind: Any) -> np.ndarray:
            return array_at(self._handle, place, shape, kind)

        def lengths(place: int) -> np.ndarray:
            return np.diff(array(place, (self.num_envs + 1,), ctypes.c_size_t).astype(int))

        def each(counts: np.ndarray) -> tuple:  # a row for each environment where all have one length
            return (len(counts), int(counts[0])) if (counts == counts[0]).all() else (int(counts.sum()),)

        self.observation_lengths = lengths(at.observation_offsets)
        self.action_lengths = lengths(at.action_offsets)
        self._actions = at.action_values
        shape = (*each(lengths(at.point_offsets)), 2)
        self.positions = array(at.positions, shape, ctypes.c_double)
        self.velocities = array(at.velocities, shape, ctypes.c_double)
        self.observations = array(at.observations, each(self.observation_lengths), ctypes.c_double)
        one = (self.num_envs,)
        self.rewards = array(at.rewards, one, ctypes.c_double)
        self.terminated = array(at.terminated, one, ctypes.c_uint8).view(bool)
        self.truncated = array(at.truncated, one, ctypes.c_uint8).view(bool)
        self.status = array(at.status, one, ctypes.c_uint8)
        self.steps = array(at.steps, one, ctypes.c_int32)
        self._action_shapes = [*dict.fromkeys([each(self.action_lengths), (self._actions,)])]
        self._shapes: Any = None  # of what look() returns, once it was called
        self._seeds = np.zeros(self.num_envs, np.uint64)
        self._begun = np.zeros(self.num_envs, bool)  # was reset at least once
        self._next = np.arange(self.num_envs, dtype=np.uint64) % np.uint64(envs)  # episodes

    # ---- episodes -------------------------------------------------------------

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
        chosen = np.arange(self.num_envs) if environments is None else np.array(
            [whole("environment", e, 0, self.num_envs - 1) for e in environments], int)
        if seed is not None:
            self._begin(chosen, whole64("seed", seed), episode, draws, jitter)
        else:  # the seed of the constructor is in force from the first reset on
            first = ~self._begun[chosen]
            for group, begun in ((chosen[first], self._seed), (chosen[~first], None)):
                if len(group) > 0 or len(chosen) == 0:
                    self._begin(group, begun, episode, draws, jitter)
        return self.state()

    def _begin(self, chosen: np.ndarray, seed: int | None, episode: int | None, draws: Any,
               jitter: float) -> None:
        if episode is not None:
            episode = whole64("episode", episode)
        start = Start(seed is not None, episode is not None, seed or 0, episode or 0, jitter,
                      None if draws is None else json.dumps(draws).encode())
        numbers = np.ascontiguousarray(chosen, np.int32)
        call("evo_envs_reset", self._running(), address(numbers), len(numbers), ctypes.byref(start))
        if seed is not None:
            self._seeds[chosen] = seed
            self._next[chosen] = chosen % self._per_robot
        if episode is not None:
            self._next[chosen] = episode
        self._next[chosen] += np.uint64(self._per_robot)
        self._begun[chosen] = True

    def step(self, actions: Any, mask: Any = None) -> State:
        """One step (info["hold"] control steps): actions of all environments, [E, A], or one after the
        other in one row. Those of environments outside of ``mask``, [E], are ignored."""
        self.advance(actions, mask)
        return self.state()

    def advance(self, actions: Any, mask: Any = None) -> None:
        """step() for those who look at the arrays."""
        values = targets(actions, self.info["action_low"], self.info["action_high"])
        if values.shape not in self._action_shapes:
            raise ValueError(f"actions of shape {values.shape}; expected "
                             + " or ".join(map(str, self._action_shapes)))
        active = None if mask is None else env_mask(mask, self.num_envs)
        failed = self._do_step(self._running(), address(values), self._actions,
                               None if active is None else address(active), self.num_envs)
        if failed:
            raise failure(failed)

    def state(self) -> State:
        """What the environments show now."""
        self._running()
        return State(self.observations.copy(), self.rewards.copy(), self.terminated.copy(),
                     self.truncated.copy(), self.status.copy())

    def save(self, environments: Sequence[int] | None = None) -> list[bytes]:
        """The states of episodes in progress, of all environments or of these: opaque,
        for restore() in this or another Simulator of the same robots and task."""
        chosen = range(self.num_envs) if environments is None else environments
        return [bytes_given("evo_envs_save", self._running(), e) for e in chosen]

    def restore(self, states: Sequence[bytes], environments: Sequence[int] | None = None) -> State:
        """Puts states into the environments, each into one: their episodes continue from
        there, as often as they are restored, to the same bits. All of them, or none."""
        places = list(range(self.num_envs) if environments is None else environments)
        if isinstance(states, bytes) or len(states) != len(places):
            raise ValueError(f"a list of {len(places)} states is expected")
        before = [(e, self.save([e])[0]) for e in places
                  if 0 <= e < self.num_envs and self.status[e] == 0]
        try:
            for e, state in zip(places, states):
                call("evo_envs_restore", self._running(), e, bytes(state), len(state))
        except EvoError:
            for e, state in before:
                call("evo_envs_restore", self._running(), e, state, len(state))
            raise
        return self.state()

    # ---- what there is to see ---------------------------------------------------

    def voxels(self, environment: int = 0) -> Voxels:
        """Of the robot of an environment."""
        handle = self._running()
        known = facts("evo_envs_voxels", VoxelFacts, handle, environment)
        return Voxels(
            array_at(handle, known.fixed, (known.voxels, known.fixed_length), ctypes.c_float),
            array_at(handle, known.actuators, (known.actions,), ctypes.c_int32),
            array_at(handle, known.linked, (known.links, 2), ctypes.c_int32),
            known.local_length, known.task_length)

    def look(self) -> tuple[list[np.ndarray], np.ndarray]:
        """What voxels see now: for each robot an array [envs, V, L], and what the task shows to
        all voxels of an environment, [E, T]."""
        per_robot = self._per_robot
        if self._shapes is None:
            robots = [self.voxels(e) for e in range(0, self.num_envs, per_robot)]
            self._shapes = ([(per_robot, len(robot.fixed), robot.local_length) for robot in robots],
                            (self.num_envs, robots[0].task_length))
        shapes, of_task = self._shapes
        counts = [int(np.prod(shape)) for shape in shapes]
        local, task = np.empty(sum(counts)), np.empty(of_task)
        call("evo_envs_look", self._running(), address(local), local.size, address(task), task.size)
        parts = np.split(local, np.cumsum(counts)[:-1])
        return [part.reshape(shape) for part, shape in zip(parts, shapes)], task

    def act(self, policy: Any) -> np.ndarray:
        """Deterministic targets of a trained controller (evo_robots.Trained) in all environments,
        as step() takes them. A modular policy acts on every robot of its task."""
        actions = np.empty(self._action_shapes[0])
        call("evo_envs_act", self._running(), policy._policy, address(actions), actions.size)
        return actions

    def objects(self, environment: int = 0) -> dict[str, slice]:
        """Which points of an environment's world are an object's: ``positions[0, objects()["robot"]]``."""
        count = count_of("evo_envs_object_count", self._running(), environment)
        found = [facts("evo_envs_object", EnvObject, self._running(), environment, index)
                 for index in range(count)]
        return {o.name.decode(): slice(o.first_point, o.first_point + o.points) for o in found}

    def orientation(self, name: str, positions: Any = None, environment: int = 0) -> float:
        """How far an object is turned from where its episode began, counter-clockwise, radians; now,
        or in positions [P, 2] kept before."""
        given = None if positions is None else np.ascontiguousarray(positions, np.float64)
        own = self.positions[environment].shape if self.positions.ndim == 3 else None
        if given is not None and given.shape != own:
            raise ValueError(f"positions of shape {given.shape}; expected {own}")
        angle = ctypes.c_double()
        call("evo_envs_orientation", self._running(), environment, self._index(name, environment),
             None if given is None else address(given), ctypes.byref(angle), 1)
        return angle.value

    def translate(self, name: str, by: tuple[float, float], environment: int = 0) -> None:
        """Moves an object, as it is, by (x, y), raw units; velocities stay, no reward counts it."""
        call("evo_envs_translate", self._running(), environment, self._index(name, environment), *by)

    def _index(self, name: str, environment: int) -> int:
        objects = list(self.objects(environment))
        if name not in objects:
            raise ValueError(f"there is no object {name}; there are: " + ", ".join(objects))
        return objects.index(name)

    def picture(self, environment: int = 0, width: int = 600, height: int = 300,
                **view: Any) -> np.ndarray:
        """[height, width, 3] uint8. ``positions``: kept before [now]; ``window``: centre x and y,
        width and height, voxels [what moves]; ``hide``: of grid, background, edges, voxels."""
        return picture("evo_envs_render", self._running(), environment, width, height, **view)

    def task(self) -> dict[str, str]:
        """``task``, ``task_yaml`` and ``physics_yaml``, as files keep them."""
        found = self._task_facts()
        return {name: getattr(found, "name" if name == "task" else name.replace("task_", "")).decode()
                for name in ("task", "task_yaml", "physics_yaml")}

    def _task_facts(self) -> TaskFacts:
        return facts("evo_task_describe", TaskFacts, self._task)

    # ---- its life -----------------------------------------------------------------

    def close(self) -> None:
        """Lets go of the environments. Arrays taken from here stay. Safe to call twice."""
        self._handle = None
        for name in ("positions", "velocities", "observations", "rewards", "terminated",
                     "truncated", "status", "steps"):
            self.__dict__.pop(name, None)

    def __enter__(self) -> "Simulator":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def _running(self) -> Handle:
        if self._handle is None:
            raise EvoError("the simulator was closed")
        return self._handle

    def __reduce__(self) -> Any:
        self._running()
        states = [(int(self._seeds[e]), (int(self._next[e]) - self._per_robot) % (1 << 64),
                   self.save([e])[0] if self.status[e] == 0 else None)
                  if self._begun[e] else None for e in range(self.num_envs)]
        return _rebuilt, (self._made, states)


def _rebuilt(made: dict[str, Any], states: list[Any]) -> Simulator:
    simulator = Simulator(**made)
    for e, found in enumerate(states):
        if found is None:
            continue
        seed, episode, state = found
        simulator.reset([e], seed=seed, episode=episode)
        if state is not None:  # else it has failed, and waits for a reset
            simulator.restore([state], [e])
    return simulator
