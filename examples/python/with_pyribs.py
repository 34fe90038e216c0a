#!/usr/bin/env python3
"""The best body of every kind by pyribs: MAP-Elites over numbers of voxels and of actuators."""
import numpy as np
from ribs.archives import GridArchive
from ribs.emitters import EvolutionStrategyEmitter
from ribs.schedulers import Scheduler
from walking import score

archive = GridArchive(solution_dim=125, dims=[25, 25], ranges=[(1, 26), (1, 26)], seed=1)
emitters = [EvolutionStrategyEmitter(archive, x0=np.zeros(125), sigma0=0.5, batch_size=20, seed=k)
            for k in range(2)]
scheduler = Scheduler(archive, emitters)
for iteration in range(10):
    bodies = scheduler.ask().reshape(-1, 25, 5).argmax(axis=2)
    kinds = np.column_stack([np.count_nonzero(bodies, axis=1), np.count_nonzero(bodies >= 3, axis=1)])
    scheduler.tell([score(body) for body in bodies], kinds)
print(f"{len(archive)} kinds, the best {archive.stats.obj_max:.3f}")
