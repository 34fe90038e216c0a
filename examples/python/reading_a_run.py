#!/usr/bin/env python3
"""Reads runs as one table (needs h5py and pandas): reading_a_run.py RUN.."""
import sys

from evo_robots.files import read_run

robots = read_run(*sys.argv[1:])
best = robots.loc[robots.fitness.idxmax()]
print(f"{len(robots)} robots, the best {best.id} of {best.run} with {best.fitness:.3f}")
print(robots.groupby(["task", "method"]).fitness.agg(["count", "median", "max"]))
