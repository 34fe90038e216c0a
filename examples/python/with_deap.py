#!/usr/bin/env python3
"""Bodies by a genetic algorithm of DEAP."""
import random

from deap import algorithms, base, creator, tools
from walking import score

random.seed(1)
creator.create("Fitness", base.Fitness, weights=(1.0,))
creator.create("Cells", list, fitness=creator.Fitness)
box = base.Toolbox()
box.register("cell", random.randrange, 5)
box.register("cells", tools.initRepeat, creator.Cells, box.cell, 25)
box.register("population", tools.initRepeat, list, box.cells)
box.register("evaluate", lambda cells: (score(cells),))
box.register("mate", tools.cxTwoPoint)
box.register("mutate", tools.mutUniformInt, low=0, up=4, indpb=0.1)
box.register("select", tools.selTournament, tournsize=3)
best = tools.HallOfFame(1)
algorithms.eaSimple(box.population(20), box, cxpb=0.5, mutpb=0.8, ngen=10, halloffame=best, verbose=False)
print(f"the best of {10} generations: {best[0].fitness.values[0]:.3f}")
