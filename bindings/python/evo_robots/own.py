"""Tasks in Python: a class with observe, reward and done over a batch of environments.

    class Walk(Task):
        def observe(self, now):
            return np.concatenate([now.shape("robot"), now.mean_velocity("robot")], axis=1)
        def reward(self, before, now, actions):
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

from .library import (CurvePoint, EvoError, Handle, LearnerFacts, OwnEpisode, PolicyFacts, Training,
                      address, assignments, call, facts, failure, library, needs, numbers, targets, task_of,
                      text_of, texts_of, whole, whole64)
from .robots import Robot
from .simulator import Simulator
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
        self.actions = np.ones((sims.num_sims, sims.num_actuators))  # [E, A] of the step that led here
        self.draws: dict[str, np.ndarray] = {}  # [E] each: what the episodes drew
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
            into.positions, into.velocities, into.steps, into.actions = (
                self.positions.copy(), self.velocities.copy(), self.steps.copy(), self.actions.copy())
        else:
            np.copyto(into.positions, self.positions)
            np.copyto(into.velocities, self.velocities)
            np.copyto(into.steps, self.steps)
            np.copyto(into.actions, self.actions)
        into._centres, self._centres = self._centres, {}
        return into


class Task:
    """A task of one's own: derive from it, and define observe and reward."""

    steps = 500  # time limit of an episode
    hold = 1  # control steps of a step, all with the same action
    step_cost = 0.0  # subtracted from the reward of every step
    folded = -3.0  # added to the reward where a robot folds onto itself, which ends its episode
    physics: Any = None  # a profile by name or file [the benchmark's]

    def world(self, body: np.ndarray, connections: np.ndarray) -> World:
        """Where the robot stands. [Flat ground of 100 cells, the robot at its left end.]"""
        world = World()
        world.add("ground", np.full((1, 100), 5), 0, 0)
        world.add("robot", body, 1, 1, connections)
        return world

    def draw(self, random: np.random.Generator) -> Mapping[str, Any]:
        """What an episode draws by its seed and number: numbers by name, which ``now.draws`` has,
        [E]; an object's name with (x, y) lets it begin moved by so many voxels."""
        return {}

    def observe(self, now: Moment) -> np.ndarray:
        """[E, D]"""
        raise NotImplementedError(f"{type(self).__name__} has no observe()")

    def reward(self, before: Moment, now: Moment, actions: np.ndarray) -> np.ndarray:
        """[E], of the step from before to now by these actions [E, A], targets of the actuators;
        ``before.actions`` are those of the step before, 1 at an episode's start."""
        raise NotImplementedError(f"{type(self).__name__} has no reward()")

    def done(self, now: Moment) -> np.ndarray:
        """[E] bool, whose episode is over."""
        return np.zeros(len(now.steps), bool)

    def envs(self, robot: Any, count: int, **arguments: Any) -> "TaskEnvironments":
        return TaskEnvironments(self, robot, count, **arguments)

    def env(self, robot: Any, **arguments: Any) -> Any:
        """For Gymnasium: one environment."""
        from .own_gymnasium import OneEnvironment

        return OneEnvironment(self, robot, **arguments)

    def vector_env(self, robot: Any, num_envs: int, **arguments: Any) -> Any:
        """For Gymnasium: many, stepped together."""
        from .own_gymnasium import ManyEnvironments

        return ManyEnvironments(self, robot, num_envs, **arguments)


class TaskEnvironments:
    """``count`` environments of a robot in a task of one's own, stepped side by side. What has ended
    shows it until it is reset. seed: of what episodes draw; environment i plays the episodes i,
    i + count, .. of it. jitter: every start coordinate is moved by up to this, voxels."""

    def __init__(self, task: Task, robot: Any, count: int = 1, *, jobs: int = 1, seed: int = 0,
                 jitter: float = 0.0, purpose: int = 0) -> None:
        self.task = task
        self.robot = robot if isinstance(robot, Robot) else Robot(robot)
        world = task.world(self.robot.body, self.robot.connections)
        if self.robot.stiffness is not None:
            world.stiffen("robot", self.robot.stiffness)
        self.sims = Simulations(world, count, physics=task.physics, jobs=jobs)
        self.num_envs = count
        self.num_actuators = self.sims.num_actuators
        self.action_low, self.action_high = self.sims.action_low, self.sims.action_high
        if self.num_actuators == 0:
            raise ValueError(f"the world of {type(task).__name__} has no robot in it")
        self._hold = whole("hold", task.hold, 1, 1000)
        self._seed, self._purpose, self._jitter = whole64("seed", seed), purpose, jitter
        self._drawn = jitter != 0 or type(task).draw is not Task.draw
        self._episodes = np.arange(count)  # the next of each
        self._steps = np.zeros(count, np.int32)
        self._now = Moment(self.sims, self._steps)
        self._before: Moment | None = None
        self.reset()
        self._episodes[:] = np.arange(count)
        self.num_observations = self.observe().shape[1]

    def reset(self, mask: Any = None, seed: int | None = None) -> np.ndarray:
        """Begins episodes, all or those of mask [E]; the observations of all, [E, D]. A seed stays in
        force, and begins the count of its episodes anew."""
        if seed is not None:
            self._seed = whole64("seed", seed)
            self._episodes[:] = np.arange(self.num_envs)
        chosen = np.arange(self.num_envs) if mask is None else np.flatnonzero(mask)
        for index in chosen:
            self.sims.reset(index)
            if self._drawn:
                self._draw(index)
        self._episodes[chosen] += self.num_envs
        self._steps[chosen] = 0
        self._now.actions[chosen] = 1.0
        self._now._centres = {}
        return self.observe()

    def _draw(self, index: int) -> None:
        random = np.random.default_rng(np.random.SeedSequence(
            self._seed, spawn_key=(self._purpose, int(self._episodes[index]))))
        jitter_seed = int(random.integers(1 << 63))  # first, so that draws are the same with and without
        for name, value in self.task.draw(random).items():
            if np.ndim(value) == 0:
                self._now.draws.setdefault(name, np.zeros(self.num_envs))[index] = value
            else:
                self.sims.translate(name, (0.1 * value[0], 0.1 * value[1]), index)
        if self._jitter != 0:
            self.sims.perturb(self._jitter, jitter_seed, index)

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Observations [E, D], rewards [E], terminated [E], truncated [E]."""
        self._before = self._now._keep(self._before)
        self.sims.step(actions)
        for _ in range(1, self._hold):
            self.sims.step(actions, self.sims.status == SIM_STATUS.index("ok"))
        self._steps += 1
        taken = targets(actions, self.action_low, self.action_high)
        if getattr(actions, "dtype", None) == np.float32:  # clipped already, in its own precision
            self._now.actions[:] = taken
        else:
            np.clip(taken, self.action_low, self.action_high, out=self._now.actions)
        rewards = self._values("reward", self.task.reward(self._before, self._now, self._now.actions),
                               np.float64) - self.task.step_cost
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
    _task: Task | None = field(default=None, repr=False)  # of one's own
    final: dict[str, float] | None = None  # of a Task's: episodes, mean, standard_error from perturbed starts

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
        """A policy file. evo-eval takes those of the suite's tasks."""
        call("evo_policy_write", self._policy, text_of(path))

    def rollout(self, path: str | os.PathLike, task: Task | type[Task] | None = None) -> None:
        """Writes its episode from the official start as a file for evo-render, evo-inspect and
        read_rollout. task: for a policy that was read from a file and is of a Task."""
        own = _task(self._task if task is None else task)
        if own is None:
            call("evo_policy_record", self._policy, None, None, 0, text_of(path))
            return
        envs = TaskEnvironments(own, self.robot, seed=self._seed())
        played = _play(envs, self)
        about = f"name: {type(own).__name__}\nsteps: {own.steps}\nhold: {own.hold}\n"
        kept = {name: np.ascontiguousarray(values, np.float64) for name, values in (
            ("observations", played.observations), ("actions", played.actions),
            ("rewards", played.rewards), ("positions", played.positions))}
        episode = OwnEpisode(
            about.encode(), len(played.rewards), kept["observations"].size, kept["actions"].size,
            *(address(values) for values in kept.values()), played.terminated, played.truncated)
        call("evo_policy_record", self._policy, envs.sims._handle, ctypes.byref(episode),
             ctypes.sizeof(episode), text_of(path))

    def video(self, task: Any = None, width: int = 480, height: int = 240, fps: float = 25.0,
              speed: float = 1.0) -> Video:
        """Its episode in a Task, or in a task of the suite by name or file [what it was trained on]:
        plays in a notebook, ``save(path)`` writes it."""
        task = _task(self._task if task is None else task)
        if isinstance(task, Task):
            envs = TaskEnvironments(task, self.robot, seed=self._seed())
            shown, hold, film = envs.sims, task.hold, _play(envs, self).positions
        else:
            if task is None:
                task = Handle("task", "evo_policy_task", self._policy)
            shown = Simulator(task, self.robot, seed=self._seed())
            hold, film = shown.info["hold"], []
            shown.reset()
            while not film or not (shown.terminated[0] or shown.truncated[0]):
                film.append(shown.positions[0].copy())
                shown.advance(shown.act(self))
            film.append(shown.positions[0].copy())
        return Video.of(film, lambda positions: shown.picture(0, width, height, positions=positions),
                        fps=fps, speed=speed / hold)

    def _seed(self) -> int:
        return facts("evo_policy_describe", PolicyFacts, self._policy).seed


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
        self._texts = texts_of(assignments(settings))
        self._profile = text_of(profile)
        self.struct = Training(self._profile, self._texts, len(self._texts),
                               0 if steps is None else whole("steps", steps, 1, (1 << 63) - 1),
                               whole64("seed", seed))


def _reporter(progress: Any) -> tuple[Callable[[int], Any], Callable[[], Any]]:
    if callable(progress):
        return progress, lambda: None
    if not progress:
        return lambda step: None, lambda: None
    bar = needs("tqdm.auto", "data").tqdm(unit=" steps")
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


def _trained(robot: Robot, policy: Handle, task: Task | None = None) -> Trained:
    known = facts("evo_policy_describe", PolicyFacts, policy)
    points = (CurvePoint * known.curve_points).from_address(known.curve) if known.curve_points else []
    return Trained(robot, known.fitness,
                   np.array([(p.step, p.evaluation, p.best) for p in points]).reshape(-1, 3), policy,
                   task)


def check_training(*, steps: int | None = None, seed: int = 0,
                   profile: str | os.PathLike = "default",
                   settings: Mapping[str, Any] | None = None) -> None:
    """Raises what ``train`` with a Task of one's own would raise of these."""
    wanted = _Wanted(profile, settings, steps, seed)
    Handle("learner", "evo_learner_open", ctypes.byref(wanted.struct), ctypes.sizeof(wanted.struct),
           1, 1, 0.0, 1.0, b"")


def _train_own(task: Task, robot: Robot, wanted: _Wanted, report: Callable) -> Trained:
    one = TaskEnvironments(task, robot)
    learner = Handle("learner", "evo_learner_open", ctypes.byref(wanted.struct),
                     ctypes.sizeof(wanted.struct), one.num_observations, one.num_actuators,
                     one.action_low, one.action_high, robot.id.encode())
    plan = facts("evo_learner_describe", LearnerFacts, learner)
    count, seed = plan.environments, wanted.struct.seed
    envs = TaskEnvironments(task, robot, count, seed=seed, jitter=plan.start_jitter, purpose=1)
    judged = TaskEnvironments(task, robot, plan.evaluation_episodes, seed=seed,
                              jitter=plan.evaluation_jitter)
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
            now = _snapshot(learner, robot, task, [])
            score = float(_evaluate(judged, Trained(robot, 0.0, np.empty((0, 3)), now)).mean())
            highest = max([score, *(point[2] for point in curve[-1:])])
            curve.append((step, score, highest))
            if len(curve) == 1 or score > curve[-2][2]:
                best = _snapshot(learner, robot, task, curve)
        report(step)
    trained = Trained(robot, _trained(robot, best).fitness, np.array(curve), best, task)
    if plan.final_episodes > 0:
        last = TaskEnvironments(task, robot, plan.final_episodes, seed=seed, jitter=plan.final_jitter, purpose=2)
        returns = _evaluate(last, trained)
        error = returns.std(ddof=1) / np.sqrt(len(returns)) if len(returns) > 1 else 0.0
        trained.final = {"episodes": len(returns), "mean": float(returns.mean()), "standard_error": float(error)}
        call("evo_policy_set_final", best, *trained.final.values())
    return trained


def _snapshot(learner: Handle, robot: Robot, task: Task,
              curve: list[tuple[int, float, float]]) -> Handle:
    points = (CurvePoint * max(1, len(curve)))(*curve)
    return Handle("policy", "evo_learner_policy", learner, robot._handle, 0,
                  type(task).__name__.encode(), points, len(curve))


def _evaluate(envs: TaskEnvironments, policy: Trained) -> np.ndarray:
    """The return of the first deterministic episode of each environment."""
    envs._episodes[:] = np.arange(envs.num_envs)
    observations, total, running = envs.reset(), np.zeros(envs.num_envs), np.ones(envs.num_envs, bool)
    while running.any():
        observations, rewards, terminated, truncated = envs.step(policy.act(observations, envs.steps))
        total[running] += rewards[running]
        running &= ~(terminated | truncated)
    return total


@dataclass
class _Played:
    """An episode of T steps."""

    observations: list  # [T + 1, D], and so on
    actions: list
    rewards: list
    positions: list
    terminated: bool = False
    truncated: bool = False


def _play(one: TaskEnvironments, policy: Trained) -> _Played:
    """A deterministic episode of the one environment."""
    played = _Played([one.reset()[0]], [], [], [one.sims.positions[0].copy()])
    while not (played.terminated or played.truncated):
        actions = policy.act(played.observations[-1][None], one.steps)
        observations, rewards, terminated, truncated = one.step(actions)
        played.observations.append(observations[0])
        played.actions.append(actions[0])
        played.rewards.append(rewards[0])
        played.positions.append(one.sims.positions[0].copy())
        played.terminated, played.truncated = bool(terminated[0]), bool(truncated[0])
    return played
