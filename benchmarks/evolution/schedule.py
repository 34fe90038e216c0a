#!/usr/bin/env python3
"""What doing without generations gains in time, by simulation.

Every training takes a time of its own; workers take the next launch (a training, or a
chunk of them one after another) that may begin, in the order of make. With generations
(evo evolve ga, the paper's schedule) that is one of the generation under way; without
(--window) it is robot k as soon as the scores of robots 0 .. k-W-1 are there.
Launching takes no time. Prints a row per case: workers, window, population, robots,
robots per launch, law of the times, idle share of the workers with and without
generations, and how many times faster the run without is.

durations.tsv has times of real trainings: seconds of a core per robot, of a GA's run on
Walker-v0 (16 384 steps) and of sampled bodies on Carrier-v0 (8 192 steps).

    benchmarks/evolution/schedule.py > benchmarks/evolution/schedule.tsv
"""
import heapq
import pathlib
import random


def survivors(created, population, robots):
    """max(2, ceil(0.6 P (M - e - 1) / (M - 1))), spec of the paper's schedule."""
    left = max(robots - created - 1, 0)
    return max(2, -(-3 * population * left // (5 * (robots - 1))))


def generations(population, robots):
    """How many robots each generation trains."""
    sizes = [population]
    while sum(sizes) < robots:
        created = sum(sizes)
        sizes.append(min(population - survivors(created, population, robots), robots - created))
    return sizes


def launches(times, chunk):
    return [sum(times[k:k + chunk]) for k in range(0, len(times), chunk)]


def generational(times, workers, population, chunk):
    now, first = 0.0, 0
    for size in generations(population, len(times)):
        free = [now] * workers
        for time in launches(times[first:first + size], chunk):
            heapq.heappush(free, heapq.heappop(free) + time)
        now = max(free)
        first += size
    return now


def steady(times, workers, population, chunk, window):
    free = [0.0] * workers
    scored = []  # when the scores of launches 0 .. k are all there
    for k, time in enumerate(launches(times, chunk)):
        last = min((k + 1) * chunk, len(times)) - 1
        known = 0 if last < population else max(0, last - window)
        begin = max(heapq.heappop(free), scored[(known - 1) // chunk] if known else 0.0)
        heapq.heappush(free, begin + time)
        scored.append(max(begin + time, scored[-1] if scored else 0.0))
    return scored[-1]


LAWS = {
    "equal": lambda draw: 1.0,
    "uniform 0.5-1.5": lambda draw: draw.uniform(0.5, 1.5),
    "Pareto 1.5": lambda draw: min(draw.paretovariate(1.5), 40.0),
}
measured = {}
for line in (pathlib.Path(__file__).parent / "durations.tsv").read_text().splitlines()[1:]:
    task, seconds = line.split("\t")
    measured.setdefault(task, []).append(float(seconds))
for task, seconds in measured.items():
    LAWS[f"as on {task}"] = lambda draw, seconds=seconds: draw.choice(seconds)


def row(workers, window, population, robots, chunk, law, repetitions):
    idle = [0.0, 0.0]
    faster = 0.0
    for repetition in range(repetitions):
        draw = random.Random(repetition)
        times = [LAWS[law](draw) for _ in range(robots)]
        walls = (generational(times, workers, population, chunk),
                 steady(times, workers, population, chunk, window))
        for i, wall in enumerate(walls):
            idle[i] += (1 - sum(times) / (wall * workers)) / repetitions
        faster += walls[0] / walls[1] / repetitions
    print(f"{workers}\t{window}\t{population}\t{robots}\t{chunk}\t{law}\t{idle[0]:.3f}\t{idle[1]:.3f}\t{faster:.2f}")


print("workers\twindow\tpopulation\trobots\tchunk\ttimes\tidle_generations\tidle_steady\tfaster")
for workers in (2, 8, 25, 64):
    for law in LAWS:
        row(workers, max(25, workers), 25, 250, 1, law, 40)
for window in (1000, 3000):  # docs/cluster.md, "With generations, or without"
    row(100, window, 1000, 10000, 10, "Pareto 1.5", 5)
