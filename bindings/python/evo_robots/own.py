"""Tasks in Python: a class with observe, reward and done over a batch of environments.

    class Walk(Task):
        def observe(self, now):
            return np.concatenate([now.shape("robot"), now.mean_velocity("robot")], axis=1)
        def reward(self, before, now):
            return now.centre("robot")[:, 0] - before.centre("robot")[:, 0]

    trained = evo_robots.train(Walk(), body, steps=100_000, seed=1)
    env = Walk().env(body)                      # for Gymnasium, if it is installed
"""

from __future__ import annotations

import contextlib
import copy
import ctypes
import os
import signal
import threading
from dataclasses import dataclass, field
from typing import Any, Callable, Iterator, Mapping

import numpy as np

from .library import (CurvePoint, EvoError, Handle, LearnerFacts, PolicyFacts, Training,
                      address, call, facts, failure, library, numbers, robots_of, task_of, text_of,
                      whole, whole64)
from .robots import Robot
from .video import Video
from .worlds import SIM_STATUS, Simulations, World

__all__ = ["Moment", "Task", "TaskEnvironments", "Trained", "train"]


class Moment:
    """What is in E environments of P points each at one time; raw units (a voxel is 0.1 wide)."""

    def __init__(self, sims: Simulations, steps: np.ndarray) -> None:
        self._sims = sims
        self.positions = sims.positions  # [E, P, 2]; now: the simulator's own, before: kept
        self.velocities = sims.velocities  # [E, P, 2]
        self.steps = steps  # [E] taken in the episodes
        self._centres: dict[str, np.ndarray] = {}  # those asked for since the last step

    def points(self, name: str) -> np.ndarray:
        """[E, n, 2] of an object."""
        return self.positions[:, self._sims._known(name).points]

    def velocity(self, name: str) -> np.ndarray:
        """[E, n, 2]"""
        return self.velocities[:, self._sims._known(name).points]

    def centre(self, name: str) -> np.ndarray:
        """[E, 2], the mean of its points."""
        if name not in self._centres:
            points = self.points(name)
            self._centres[name] = np.add.reduce(points, axis=1) / points.shape[1]
        return self._centres[name].copy()

    def mean_velocity(self, name: str) -> np.ndarray:
        """[E, 2]"""
        velocity = self.velocity(name)
        return np.add.reduce(velocity, axis=1) / velocity.shape[1]

    def shape(self, name: str) -> np.ndarray:
        """[E, 2 n], its points from its centre."""
        points = self.points(name)
        return (points - self.centre(name)[:, None]).reshape(len(points), -1)

    def orientation(self, name: str) -> np.ndarray:
        """[E], radians, counter-clockwise from the initial shape."""
        return self._sims.orientation(name, self.positions)

    def _keep(self, into: "Moment | None") -> "Moment":
        """A copy, which the next step does not change."""
        if into is None:
            into = copy.copy(self)
            into.positions, into.velocities, into.steps = (
                self.positions.copy(), self.velocities.copy(), self.steps.copy())
        else:
            np.copyto(into.positions, self.positions)
            np.copyto(into.velocities, self.velocities)
            np.copyto(into.steps, self.steps)
        into._centres, self._centres = self._centres, {}
        return into


class Task:
    """A task of one's own: derive from it, and define observe and reward."""

    steps = 500  # time limit of an episode
    folded = -3.0  # added to the reward where a robot folds onto itself, which ends its episode
    physics: Any = None  # a profile by name or file [the benchmark's]

    def world(self, body: np.ndarray, connections: np.ndarray) -> World:
        """Where the robot stands. [Flat ground of 100 cells, the robot at its left end.]"""
        world = World()
        world.add("ground", np.full((1, 100), 5), 0, 0)
        world.add("robot", body, 1, 1, connections)
        return world

    def observe(self, now: Moment) -> np.ndarray:
        """[E, D]"""
        raise NotImplementedError(f"{type(self).__name__} has no observe()")

    def reward(self, before: Moment, now: Moment) -> np.ndarray:
        """[E], of the step from before to now."""
        raise NotImplementedError(f"{type(self).__name__} has no reward()")

    def done(self, now: Moment) -> np.ndarray:
        """[E] bool, whose episode is over."""
        return np.zeros(len(now.steps), bool)

    def envs(self, robot: Any, count: int, jobs: int = 1) -> "TaskEnvironments":
        return TaskEnvironments(self, robot, count, jobs=jobs)

    def env(self, robot: Any, **arguments: Any) -> Any:
        """For Gymnasium: one environment."""
        from .own_gymnasium import OneEnvironment

        return OneEnvironment(self, robot, **arguments)

    def vector_env(self, robot: Any, num_envs: int, jobs: int = 1) -> Any:
        """For Gymnasium: many, stepped together."""
        from .own_gymnasium import ManyEnvironments

        return ManyEnvironments(self, robot, num_envs, jobs)


class TaskEnvironments:
    """``count`` environments of a robot in a task of one's own, stepped side by side. What has ended
    shows it until it is reset."""

    def __init__(self, task: Task, robot: Any, count: int = 1, *, jobs: int = 1) -> None:
        self.task = task
        self.robot = robot if isinstance(robot, Robot) else Robot(robot)
        self.sims = Simulations(task.world(self.robot.body, self.robot.connections), count,
                                physics=task.physics, jobs=jobs)
        self.num_envs = count
        self.num_actuators = self.sims.num_actuators
        self.action_low, self.action_high = self.sims.action_low, self.sims.action_high
        if self.num_actuators == 0:
            raise ValueError(f"the world of {type(task).__name__} has no robot in it")
        self._all = np.ones(count, bool)
        self._steps = np.zeros(count, np.int32)
        self._now = Moment(self.sims, self._steps)
        self._before: Moment | None = None
        self.num_observations = self.observe().shape[1]

    def reset(self, mask: Any = None) -> np.ndarray:
        """Begins episodes, all or those of mask [E]; the observations of all, [E, D]."""
        self._now._centres = {}
        if mask is None:
            self.sims.reset()
            self._steps[:] = 0
        else:
            for index in np.flatnonzero(mask):
                self.sims.reset(index)
                self._steps[index] = 0
        return self.observe()

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Observations [E, D], rewards [E], terminated [E], truncated [E]."""
        self._before = self._now._keep(self._before)
        self.sims.step(actions)
        self._steps += 1
        rewards = self._values("reward", self.task.reward(self._before, self._now), np.float64)
        terminated = self._values("done", self.task.done(self._now), np.bool_)
        if np.count_nonzero(self.sims.status):  # a tenth of the time of any()
            folded = self.sims.status != SIM_STATUS.index("ok")
            terminated, rewards = terminated | folded, rewards + self.task.folded * folded
        return self.observe(), rewards, terminated, self._steps >= self.task.steps

    def observe(self) -> np.ndarray:
        values = np.asarray(self.task.observe(self._now), np.float64)
        if values.ndim != 2 or len(values) != self.num_envs or values.shape[1] == 0:
            raise ValueError(f"{type(self.task).__name__}.observe gave shape {values.shape}; expected "
                             f"({self.num_envs}, D): a row for each environment")
        # The simulator's own arrays would change under whoever keeps them.
        shared = values.base is not None and (np.may_share_memory(values, self.sims.positions) or
                                              np.may_share_memory(values, self.sims.velocities))
        return values.copy() if shared else values

    @property
    def steps(self) -> np.ndarray:
        """[E] taken in the episodes."""
        return self._steps

    def _values(self, name: str, values: Any, kind: type) -> np.ndarray:
        found = np.asarray(values, kind)
        if found.shape != (self.num_envs,):
            raise ValueError(f"{type(self.task).__name__}.{name} gave shape {found.shape}; expected "
                             f"({self.num_envs},): a value for each environment")
        return found


# ---- training ---------------------------------------------------------------------------


@dataclass
class Trained:
    """A controller with what is known of its training."""

    robot: Robot
    fitness: float  # the best evaluation
    curve: np.ndarray  # [n, 3]: environment steps, evaluation, the best until then
    _policy: Handle = field(repr=False)

    @classmethod
    def read(cls, path: str | os.PathLike) -> "Trained":
        """From a policy file."""
        return _trained(Robot(path), Handle("policy", "evo_policy_read", text_of(path)))

    def act(self, observations: Any, steps: Any = 0) -> np.ndarray:
        """Deterministic targets [n, A] of observations [n, D] at these steps of their episodes.
        A modular policy sees voxels instead: Simulator.act."""
        known = facts("evo_policy_describe", PolicyFacts, self._policy)
        if known.observation_length == 0:
            raise EvoError("a modular policy acts on voxels, not on an observation: Simulator.act")
        values = numbers("observations", observations).reshape(-1, known.observation_length)
        at = np.ascontiguousarray(np.broadcast_to(np.asarray(steps, np.int32), len(values)))
        actions = np.empty((len(values), known.action_length))
        call("evo_policy_act", self._policy, address(values), address(at), len(values),
             address(actions), actions.size)
        return actions

    def save(self, path: str | os.PathLike) -> None:
        """A policy file. evo-eval and evo-render take those of the suite's tasks."""
        call("evo_policy_write", self._policy, text_of(path))

    def video(self, task: Task | type[Task], width: int = 480, height: int = 240, fps: float = 25.0,
              speed: float = 1.0) -> Video:
        """Its episode in a Task of one's own: plays in a notebook, ``save(path)`` writes it."""
        envs = TaskEnvironments(_task(task), self.robot)
        film: list[np.ndarray] = []
        _evaluate(envs, self, film)
        return Video.of(film, lambda positions: envs.sims.picture(0, width, height, positions=positions),
                        fps=fps, speed=speed)


def _task(task: Any) -> Any:
    """A class stands for one of its kind."""
    return task() if isinstance(task, type) and issubclass(task, Task) else task


def train(task: Any, robot: Any, *, steps: int | None = None, seed: int = 0,
          profile: str | os.PathLike = "default", settings: Mapping[str, Any] | None = None,
          progress: bool | Callable[[int], Any] = False, **physics: Any) -> Trained:
    """Trains a robot by the suite's own learner: with a task of the suite (a name or a file) as
    evo-train does, to the same bytes; with a Task of one's own by the same PPO.

    steps: environment steps [the profile's]. profile, settings: as --train of
    evo-train. physics, settings of the physics as ``physics_settings``: for tasks of the suite.
    progress: True shows a bar by tqdm; a function is called with the steps so far. Ctrl-C ends it.
    """
    known = robot if isinstance(robot, Robot) else Robot(robot)
    wanted = _Wanted(profile, settings, steps, seed)
    report, close = _reporter(progress)
    try:
        task = _task(task)
        if isinstance(task, Task):
            if physics:
                raise TypeError(f"a Task says its physics itself: {', '.join(physics)} has no place here")
            return _train_own(task, known, wanted, report)
        opened = task_of(task, physics.pop("physics", None), physics.pop("physics_settings", None))
        if physics:
            raise TypeError(f"train() does not know {', '.join(physics)}")
        return _train_known(opened, known, wanted, report)
    finally:
        close()


class _Wanted:
    """An evo_training, and what it points to."""

    def __init__(self, profile: Any, settings: Mapping[str, Any] | None, steps: int | None,
                 seed: int) -> None:
        texts = [f"{name}={value}".encode() for name, value in (settings or {}).items()]
        self._texts = (ctypes.c_char_p * max(1, len(texts)))(*texts)
        self._profile = text_of(profile)
        if any(b"\0" in text for text in texts):
            raise ValueError("settings: a NUL is in one of them")
        self.struct = Training(self._profile, self._texts, len(texts),
                               0 if steps is None else whole("steps", steps, 1, (1 << 63) - 1),
                               whole64("seed", seed))


def _reporter(progress: Any) -> tuple[Callable[[int], Any], Callable[[], Any]]:
    if callable(progress):
        return progress, lambda: None
    if not progress:
        return lambda step: None, lambda: None
    from tqdm.auto import tqdm

    bar = tqdm(unit=" steps")
    return lambda step: bar.update(step - bar.n), bar.close


def _train_known(task: Handle, robot: Robot, wanted: _Wanted, report: Callable) -> Trained:
    raised: list[BaseException] = []

    def go_on(step: int, _: Any) -> int:
        if not raised:
            try:
                report(step)
            except BaseException as error:  # ctypes would drop it
                raised.append(error)
        return 0 if raised else 1

    wanted.struct.go_on = Training.GO_ON(go_on)
    policy = None
    with _signals_into(raised):
        try:
            policy = Handle("policy", "evo_train", task, robot._handle, 0,
                            ctypes.byref(wanted.struct), ctypes.sizeof(wanted.struct))
        except EvoError as error:
            raised.append(error)
    if raised:
        raise raised[0] from None
    return _trained(robot, policy)


@contextlib.contextmanager
def _signals_into(raised: list[BaseException]) -> Iterator[None]:
    """What Python's handlers of signals raise is put into a list. Raised on the way into a
    callback, before its first line, it would be lost in ctypes, as Ctrl-C was."""
    def keeping(handler: Callable) -> Callable:
        def keep(number: int, frame: Any) -> None:
            try:
                handler(number, frame)
            except BaseException as error:
                raised.append(error)
        return keep

    handlers = {}
    if threading.current_thread() is threading.main_thread():  # which alone has any
        handlers = {number: handler for number in signal.valid_signals()
                    if callable(handler := signal.getsignal(number))}
    try:
        for number, handler in handlers.items():
            signal.signal(number, keeping(handler))
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)


def _trained(robot: Robot, policy: Handle) -> Trained:
    known = facts("evo_policy_describe", PolicyFacts, policy)
    points = (CurvePoint * known.curve_points).from_address(known.curve) if known.curve_points else []
    return Trained(robot, known.fitness,
                   np.array([(p.step, p.evaluation, p.best) for p in points]).reshape(-1, 3), policy)


def check_training(*, steps: int | None = None, seed: int = 0,
                   profile: str | os.PathLike = "default",
                   settings: Mapping[str, Any] | None = None) -> None:
    """Raises what ``train`` with a Task of one's own would raise of these."""
    wanted = _Wanted(profile, settings, steps, seed)
    Handle("learner", "evo_learner_open", ctypes.byref(wanted.struct), ctypes.sizeof(wanted.struct),
           1, 1, 0.0, 1.0, b"")


def _train_own(task: Task, robot: Robot, wanted: _Wanted, report: Callable) -> Trained:
    one = TaskEnvironments(task, robot)  # for evaluations
    learner = Handle("learner", "evo_learner_open", ctypes.byref(wanted.struct),
                     ctypes.sizeof(wanted.struct), one.num_observations, one.num_actuators,
                     one.action_low, one.action_high, robot.id.encode())
    plan = facts("evo_learner_describe", LearnerFacts, learner)
    count = plan.environments
    envs = TaskEnvironments(task, robot, count)
    actions = np.empty((count, envs.num_actuators))
    observe, act, reward = (getattr(library(), f"evo_learner_{name}")
                            for name in ("observe", "act", "reward"))

    def checked(status: int) -> None:
        if status != 0:
            raise failure(status)

    def tell(observations: np.ndarray) -> None:
        values = np.ascontiguousarray(observations)
        checked(observe(learner, address(values), values.size, address(envs.steps), count))

    tell(envs.reset())
    best: Handle | None = None
    curve: list[tuple[int, float, float]] = []
    for update in range(1, plan.updates + 1):
        for _ in range(plan.rollout):
            checked(act(learner, address(actions), actions.size))
            reached, rewards, terminated, truncated = envs.step(actions)
            reached, rewards = np.ascontiguousarray(reached), np.ascontiguousarray(rewards)
            checked(reward(learner, address(rewards), address(terminated), address(truncated),
                           address(reached), reached.size, address(envs.steps), count))
            ended = terminated | truncated
            tell(envs.reset(ended) if ended.any() else reached)
        call("evo_learner_learn", learner)
        step = update * plan.rollout * count
        if update % plan.evaluation_interval == 0 or update == plan.updates:
            now = _snapshot(learner, robot, [])
            score = _evaluate(one, Trained(robot, 0.0, np.empty((0, 3)), now))
            highest = max([score, *(point[2] for point in curve[-1:])])
            curve.append((step, score, highest))
            if len(curve) == 1 or score > curve[-2][2]:
                best = _snapshot(learner, robot, curve)
        report(step)
    found = _trained(robot, best)
    return Trained(robot, found.fitness, np.array(curve), best)


def _snapshot(learner: Handle, robot: Robot, curve: list[tuple[int, float, float]]) -> Handle:
    points = (CurvePoint * max(1, len(curve)))(*curve)
    return Handle("policy", "evo_learner_policy", learner, robot._handle, 0, points, len(curve))


def _evaluate(one: TaskEnvironments, policy: Trained, film: list[np.ndarray] | None = None) -> float:
    """The return of one deterministic episode, whose positions go to ``film``."""
    observations, total = one.reset(), 0.0
    while True:
        if film is not None:
            film.append(one.sims.positions[0].copy())
        observations, rewards, terminated, truncated = one.step(
            policy.act(observations, one.steps))
        total += float(rewards[0])
        if terminated[0] or truncated[0]:
            return total
