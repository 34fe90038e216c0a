#!/usr/bin/env python3
"""Reads a run folder of the pipelines: reading_a_run.py RUN"""
import sys

from evo_robots.files import read_run

history = read_run(sys.argv[1])
best = max(history, key=lambda robot: robot["fitness"] if robot["fitness"] is not None else float("-inf"))
print(f"{len(history)} robots, the best {best['id']} with {best['fitness']:.3f}")
so_far = float("-inf")
for number, robot in enumerate(history):
    if robot["fitness"] is not None and robot["fitness"] > so_far:
        so_far = robot["fitness"]
        print(f"after {number + 1:4d} robots {so_far:.3f}")
