"""Random worlds in evogym's simulator and in evo's, side by side, as tab-separated
values: worlds.py [WORLDS [STEPS [FIRST [PHYSICS]]]]     PHYSICS: package
World w of a seed is the same on every machine. Its kind is w mod 5: what the 32 tasks
hardly reach. Every point's position and velocity is compared after every control step,
until a robot folds. Worlds that differ by more than 1e-9 are named on standard error,
with the step at which they first differ at all and the one at which by more than that.
Needs evogym and evo_robots, as benchmarks/peer/run installs them."""
import os
import sys
import tempfile

import numpy as np
from evogym import EvoSim, EvoWorld
from evogym.simulator_cpp import Sim

import evo_robots

# evogym greets on standard output: that goes to standard error, the table here.
TABLE = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
KINDS = ("bare floor", "heap of objects", "fixed and soft cells", "partial connections", "long fall")
RIGID, SOFT, HORIZONTAL, VERTICAL, FIXED = range(1, 6)
LETTERS = ".RSHV#"
LIMIT = 1e-9


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
    pairs = np.asarray(evo_robots.get_full_connectivity(body)).reshape(2, -1).T
    group = list(range(body.size))

    def root(i):
        while group[i] != i:
            i = group[i]
        return i

    chosen = []
    for a, b in rng.permutation(pairs):
        if root(a) != root(b) or rng.random() < kept:
            group[root(a)] = root(b)
            chosen.append((int(a), int(b)))
    return np.array(sorted(chosen), int).reshape(-1, 2).T


def world(number):
    """[(name, body, connections, x, y)], the robot first."""
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
    order = rng.permutation(len(bodies))
    for i in order:
        name, body = bodies[i]
        height, width = body.shape
        x = int(rng.integers(0, 8 if kind == 1 else 16)) + 4
        y = int(tops[x:x + width].max()) + int(rng.integers(0, 2) if kind < 4 else rng.integers(5, 40))
        tops[x:x + width] = y + height
        kept = rng.choice([0.0, 0.3, 0.7]) if kind == 3 else 1.0
        placed.append((name, body, links(rng, body, kept), x, y))
    placed.sort(key=lambda item: (item[0] != "robot", item[0]))
    actuators = int(np.isin(robot, (HORIZONTAL, VERTICAL)).sum())
    return placed, actuators, rng


def task_text(objects):
    lines = ["format: evo/task", "version: 1", "name: side-by-side", "description: A random world.",
             "steps: 100000", f"robot: {{at: [{objects[0][3]}, {objects[0][4]}]}}"]
    lines += ["world:", "  objects:"] if len(objects) > 1 else ["world: {objects: {}}"]
    for name, body, connections, x, y in objects[1:]:
        lines += [f"    {name}:", f"      at: [{x}, {y}]", "      rows: |"]
        lines += ["        " + "".join(LETTERS[c] for c in row) for row in body]
        if connections is not None:
            lines.append(f"      connections: {connections.T.tolist()}")
    return "\n".join(lines + ["observation: [{velocity: robot}]",
                              "reward: [{displacement: {of: robot, axis: x}}]", ""])


def compare(number, steps, physics):
    """Steps compared, largest differences of positions and velocities, the first step
    that differs at all and the first beyond LIMIT (0: none), whether both folded alike."""
    objects, actuators, rng = world(number)
    theirs = EvoWorld()
    for name, body, connections, x, y in objects:
        theirs.add_from_array(name, body, x, y, connections)
    simulator = EvoSim(theirs)
    simulator.reset()
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as task:
        task.write(task_text(objects))
        task.flush()
        with evo_robots.Simulator(task.name, (objects[0][1], objects[0][2]), physics=physics) as ours:
            ours.reset()
            position = velocity = 0.0
            first = beyond = 0
            for step in range(1, steps + 1):
                action = rng.uniform(0.6, 1.6, actuators)
                simulator.set_action("robot", action)
                folded = simulator.step()
                state = ours.step(action[None])
                if folded or state.terminated[0] or state.status[0]:
                    same = bool(folded) == bool(state.terminated[0])
                    return step, position, velocity, first, beyond, same
                apart = np.abs(Sim.pos_at_time(simulator, step).T - ours.positions[0]).max()
                position = max(position, apart)
                velocity = max(velocity, np.abs(Sim.vel_at_time(simulator, step).T - ours.velocities[0]).max())
                first = first or (step if apart > 0 else 0)
                beyond = beyond or (step if not apart <= LIMIT else 0)
    return steps, position, velocity, first, beyond, True


def main():
    given = sys.argv[1:] + ["2000", "100", "0", "package"][len(sys.argv) - 1:]
    count, steps, start = map(int, given[:3])
    print("kind", "worlds", "steps", "same bits", "within 1e-9", "largest difference",
          "of a velocity", "folded differently", sep="\t", file=TABLE)
    results = {kind: [] for kind in KINDS}
    for number in range(start, start + count):
        result = compare(number, steps, given[3])
        results[KINDS[number % len(KINDS)]].append(result)
        if result[4] or not result[5]:
            print(f"world {number} ({KINDS[number % len(KINDS)]}): {result}", file=sys.stderr)
    for kind, rows in results.items():
        if rows:
            print(kind, len(rows), sum(r[0] for r in rows), sum(r[3] == 0 for r in rows),
                  sum(r[4] == 0 for r in rows), max(r[1] for r in rows), max(r[2] for r in rows),
                  sum(not r[5] for r in rows), sep="\t", file=TABLE)


main()
