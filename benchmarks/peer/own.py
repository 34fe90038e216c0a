"""Control steps per second of a world built in Python with a reward and an observation of
one's own in numpy, in evogym's simulator and in evo_robots.Simulations, as tab-separated
values: own.py [SECONDS]
A random 5x5 robot on flat ground; the observation is all its points' positions relative to
their centre and their velocities, the reward how far the centre came. Both are measured in
turn, in processor time of this process. evo runs one and sixteen simulations at once, with
observation and reward of one's own, in a loop and as an evo_robots.Task, and without. Then
Walker-v0, through gymnasium.make of both, and from evo_robots.Simulator, with the speed of
evo-bench, which is without Python, beside it. Needs evogym and evo_robots, as
benchmarks/peer/run installs them."""
import os
import subprocess
import sys
import time

import numpy as np
from evogym import EvoSim, EvoWorld

import evo_robots

TABLE = os.fdopen(os.dup(1), "w")  # evogym greets on standard output
os.dup2(2, 1)
SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 3.0
BODY, LINKS = evo_robots.sample_robot((5, 5), rng=np.random.default_rng(1))
ACTUATORS = int(np.isin(BODY, (3, 4)).sum())
ACTIONS = np.random.default_rng(2).uniform(0.6, 1.6, (1000, 16, ACTUATORS))
GROUND = np.full((1, 100), 5.0)


def evogym_steps(own):
    """Steps one world on, for ever; yields after each."""
    world = EvoWorld()
    world.add_from_array("ground", GROUND, 0, 0)
    world.add_from_array("robot", BODY, 1, 1, LINKS)
    sim = EvoSim(world)
    sim.reset()
    before = sim.object_pos_at_time(0, "robot").mean(axis=1)
    for t in range(1 << 40):
        sim.set_action("robot", ACTIONS[t % 1000, 0])
        sim.step()
        if own:
            now = sim.get_time()
            positions = sim.object_pos_at_time(now, "robot")
            centre = positions.mean(axis=1)
            reward = centre[0] - before[0]
            observation = np.concatenate([(positions - centre[:, None]).ravel(),
                                          sim.object_vel_at_time(now, "robot").ravel()])
            before = centre
            assert observation.size == 4 * positions.shape[1]
        yield 1


def evo_steps(count, own):
    world = evo_robots.World()
    world.add("ground", GROUND, 0, 0)
    world.add("robot", BODY, 1, 1, LINKS)
    sims = evo_robots.Simulations(world, count)
    points = sims.objects["robot"].points
    before = sims.positions[:, points].mean(axis=1)
    for t in range(1 << 40):
        sims.step(ACTIONS[t % 1000, :count])
        if own:
            positions = sims.positions[:, points]
            centres = positions.mean(axis=1)
            rewards = centres[:, 0] - before[:, 0]
            observations = np.concatenate(
                [(positions - centres[:, None]).reshape(count, -1),
                 sims.velocities[:, points].reshape(count, -1)], axis=1)
            before = centres
            assert len(rewards) == len(observations) == count
        yield count


class Walk(evo_robots.Task):
    steps = 1 << 30

    def observe(self, now):
        return np.concatenate([now.shape("robot"), now.velocity("robot").reshape(len(now.steps), -1)],
                              axis=1)

    def reward(self, before, now, actions):
        return now.centre("robot")[:, 0] - before.centre("robot")[:, 0]


def task_steps(count):
    envs = Walk().envs((BODY, LINKS), count)
    envs.reset()
    for t in range(1 << 40):
        envs.step(ACTIONS[t % 1000, :count])
        yield count


def gym_steps(name, actions):
    import evogym.envs  # noqa: F401
    import gymnasium

    env = gymnasium.make(name, body=BODY, connections=LINKS)
    env.reset(seed=1)
    for t in range(1 << 40):
        _, _, terminated, truncated, _ = env.step(actions[t % 1000, 0])
        if terminated or truncated:
            env.reset()
        yield 1


def simulator_steps(count):
    simulator = evo_robots.Simulator("Walker-v0", (BODY, LINKS), count)
    for t in range(1 << 40):
        if t % 500 == 0:
            simulator.reset()
        simulator.step(ACTIONS[t % 1000, :count])
        yield count


def bench(count):
    """Of evo-bench, with a body of this size."""
    said = subprocess.run([evo_robots.find_tool("evo-bench"), "--sizes", "5", "--envs", str(count)],
                          capture_output=True, text=True, check=True).stdout.splitlines()
    return float(dict(zip(said[0].split(), said[1].split()))["steps/s"])


def measure(steps):
    for _ in range(100):
        next(steps)
    done, begin = 0, time.process_time()
    while (taken := time.process_time() - begin) < SECONDS:
        for _ in range(20):
            done += next(steps)
    return done / taken


def main():
    print("what\tsimulations\tsteps_per_second\tratio_to_evogym", file=TABLE)
    for own, what in ((False, "steps alone"), (True, "own reward and observation")):
        package = measure(evogym_steps(own))
        print(f"{what}, evogym\t1\t{package:.0f}\t1", file=TABLE)
        for count in (1, 16):
            speed = measure(evo_steps(count, own))
            print(f"{what}, evo\t{count}\t{speed:.0f}\t{speed / package:.1f}", file=TABLE)
    for count in (1, 16):
        speed = measure(task_steps(count))
        print(f"the same as an evo_robots.Task\t{count}\t{speed:.0f}\t{speed / package:.1f}", file=TABLE)
    package = measure(gym_steps("Walker-v0", ACTIONS))
    print(f"Walker-v0, evogym\t1\t{package:.0f}\t1", file=TABLE)
    for what, count, speed in (
            ("gymnasium.make", 1, measure(gym_steps("evo/Walker-v0", ACTIONS))),
            *(("Simulator", count, measure(simulator_steps(count))) for count in (1, 16)),
            *(("evo-bench", count, bench(count)) for count in (1, 16))):
        print(f"Walker-v0, evo, {what}\t{count}\t{speed:.0f}\t{speed / package:.1f}", file=TABLE)


main()
