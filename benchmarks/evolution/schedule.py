#!/usr/bin/env python3
"""What doing without generations gains in time, by simulation.

Every training takes a time of its own; workers take the next one that may begin, in
the order of make. With generations (scripts/ga.mk, the paper's schedule) that is one
of the generation under way; without (scripts/steady.mk) it is robot k as soon as the
scores of robots 0 .. k-W-1 are there. Prints a row per case: workers, law of the
times, idle share of the workers with and without generations, and how many times
faster the run without is. durations.tsv has times of real trainings: seconds of a core
for each robot of a GA's run (bodies of 5x5, 16 384 steps, profile `default`).

    benchmarks/evolution/schedule.py > benchmarks/evolution/schedule.tsv
"""
import heapq
import pathlib
import random

POPULATION, EVALUATIONS, REPETITIONS = 25, 250, 40


def survivors(created):
    """max(2, ceil(0.6 P (M - e - 1) / (M - 1))), spec of the paper's schedule."""
    left = max(EVALUATIONS - created - 1, 0)
    return max(2, -(-3 * POPULATION * left // (5 * (EVALUATIONS - 1))))


def generations():
    """How many robots each generation trains."""
    sizes = [POPULATION]
    while sum(sizes) < EVALUATIONS:
        created = sum(sizes)
        sizes.append(min(POPULATION - survivors(created), EVALUATIONS - created))
    return sizes


def generational(times, workers):
    now, first = 0.0, 0
    for size in generations():
        free = [now] * workers
        for time in times[first:first + size]:
            heapq.heappush(free, heapq.heappop(free) + time)
        now = max(free)
        first += size
    return now


def steady(times, workers, window):
    free = [0.0] * workers
    scored = []  # when the scores of robots 0 .. k are all there
    for k, time in enumerate(times):
        known = 0 if k < POPULATION else max(0, k - window)
        begin = max(heapq.heappop(free), scored[known - 1] if known else 0.0)
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
for task, times in measured.items():
    LAWS[f"trained on {task}"] = lambda draw, times=times: draw.choice(times)

print("workers\twindow\ttimes\tidle_generations\tidle_steady\tfaster")
for workers in (2, 8, 25, 64):
    window = max(POPULATION, workers)
    for law, draw_time in LAWS.items():
        idle = [0.0, 0.0]
        faster = 0.0
        for repetition in range(REPETITIONS):
            draw = random.Random(repetition)
            times = [draw_time(draw) for _ in range(EVALUATIONS)]
            walls = generational(times, workers), steady(times, workers, window)
            for i, wall in enumerate(walls):
                idle[i] += (1 - sum(times) / (wall * workers)) / REPETITIONS
            faster += walls[0] / walls[1] / REPETITIONS
        print(f"{workers}\t{window}\t{law}\t{idle[0]:.3f}\t{idle[1]:.3f}\t{faster:.2f}")
