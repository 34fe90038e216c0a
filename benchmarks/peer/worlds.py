"""What the benchmark's own package computes in random worlds, as the table that a test
compares with (tests/unit/sim/worlds_test.cpp): worlds.py [WORLDS [STEPS]] > tests/data/pinned/worlds.tsv
World w is the same on every machine. Its kind is w mod 5: what the 32 tasks hardly reach.

A row has the steps before a robot folds, whether one does then, the first 16 hexadecimal
digits of the SHA-256 of all positions and velocities after each of those steps, and the
world: "NAME X Y ROWS", ROWS from the top divided by /, and what is linked, "A-B", if not
all neighbours are, cells being counted by rows. Targets of actuators are 0.6 to 1.6, drawn
by a linear congruential generator that begins with w. Needs evogym, as benchmarks/peer/run
installs it; the table is that of evogym 2.0.0, simulator 2.2.5."""
import hashlib
import os
import sys

import numpy as np
from evogym import EvoSim, EvoWorld, get_full_connectivity
from evogym.simulator_cpp import Sim

# evogym greets on standard output: that goes to standard error, the table here.
TABLE = os.fdopen(os.dup(1), "w", buffering=1)
os.dup2(2, 1)
KINDS = ("bare floor", "heap of objects", "fixed and soft cells", "partial connections", "long fall")
RIGID, SOFT, HORIZONTAL, VERTICAL, FIXED = range(1, 6)
LETTERS = ".RSHV#"


def grown(rng, cells, voxels):
    """A connected matrix without empty border, of up to `cells` voxels."""
    taken = {(0, 0)}
    while len(taken) < cells:
        y, x = sorted(taken)[rng.integers(len(taken))]
        dy, dx = ((0, 1), (1, 0), (0, -1), (-1, 0))[rng.integers(4)]
        taken.add((y + dy, x + dx))
    top, left = (min(c[i] for c in taken) for i in (0, 1))
    body = np.zeros((max(c[0] for c in taken) - top + 1, max(c[1] for c in taken) - left + 1), int)
    for y, x in sorted(taken):
        body[y - top, x - left] = rng.choice(voxels)
    return body


def links(rng, body, kept):
    """[2, k]: pairs that hold the body together, and `kept` of the others."""
    pairs = np.asarray(get_full_connectivity(body)).reshape(2, -1).T
    group = list(range(body.size))

    def root(i):
        while group[i] != i:
            i = group[i]
        return i

    chosen = []
    for a, b in rng.permutation(pairs):
        if root(a) != root(b) or rng.random() < kept:
            group[root(a)] = root(b)
            chosen.append((int(min(a, b)), int(max(a, b))))
    return np.array(sorted(chosen), int).reshape(-1, 2).T


def world(number):
    """[(name, body, connections or None, x, y)], the robot first, and its actuators."""
    rng = np.random.default_rng([38, number])
    kind = number % len(KINDS)
    robot = grown(rng, rng.integers(3, 14), [RIGID, SOFT, HORIZONTAL, HORIZONTAL, VERTICAL, VERTICAL])
    if not np.isin(robot, (HORIZONTAL, VERTICAL)).any():
        robot[tuple(np.argwhere(robot)[0])] = VERTICAL
    bodies = [("robot", robot)]
    for i in range((rng.integers(0, 3), rng.integers(3, 9), rng.integers(1, 4),
                    rng.integers(0, 4), rng.integers(1, 5))[kind]):
        voxels = [RIGID, SOFT, SOFT] + [FIXED] * (2 if kind == 2 else 0)
        bodies.append((f"object{i}", grown(rng, rng.integers(1, 9), voxels)))
    placed, tops = [], np.zeros(64, int)
    if kind != 0 and rng.random() < 0.5:
        placed.append(("ground", np.full((1, 64), FIXED), None, 0, 0))
        tops[:] = 1
    for i in rng.permutation(len(bodies)):
        name, body = bodies[i]
        height, width = body.shape
        x = int(rng.integers(0, 8 if kind == 1 else 16)) + 4
        y = int(tops[x:x + width].max()) + int(rng.integers(0, 2) if kind < 4 else rng.integers(5, 40))
        tops[x:x + width] = y + height
        kept = links(rng, body, rng.choice([0.0, 0.3, 0.7])) if kind == 3 else None
        placed.append((name, body, kept, x, y))
    placed.sort(key=lambda item: (item[0] != "robot", item[0]))
    return placed, int(np.isin(robot, (HORIZONTAL, VERTICAL)).sum())


def targets(number):
    """Of actuators, without end."""
    state = number
    while True:
        state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
        yield 0.6 + (state >> 11) * 2.0**-53


def described(name, body, connections, x, y):
    rows = "/".join("".join(LETTERS[c] for c in row) for row in body)
    pairs = "" if connections is None else " " + ",".join(f"{a}-{b}" for a, b in connections.T)
    return f"{name} {x} {y} {rows}{pairs}"


def main():
    count, steps = (*map(int, sys.argv[1:]), *(2000, 100)[len(sys.argv) - 1:])
    print("kind", "steps", "folds", "hash", "world", sep="\t", file=TABLE)
    for number in range(count):
        objects, actuators = world(number)
        built = EvoWorld()
        for name, body, connections, x, y in objects:
            built.add_from_array(name, body, x, y, connections)
        simulator = EvoSim(built)
        simulator.reset()
        draws = targets(number)
        seen = hashlib.sha256()
        done, folds = 0, False
        while done < steps and not folds:
            simulator.set_action("robot", np.array([next(draws) for _ in range(actuators)]))
            folds = bool(simulator.step())
            if not folds:
                done += 1
                for values in (Sim.pos_at_time(simulator, done), Sim.vel_at_time(simulator, done)):
                    seen.update((np.asarray(values).T + 0.0).astype("<f8").tobytes())  # -0 is 0
        print(KINDS[number % len(KINDS)], done, int(folds), seen.hexdigest()[:16],
              "; ".join(described(*thing) for thing in objects), sep="\t", file=TABLE)


main()
