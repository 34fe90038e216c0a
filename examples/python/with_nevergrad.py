#!/usr/bin/env python3
"""Bodies by any optimiser of nevergrad: a choice of five kinds in each cell."""
import nevergrad
from walking import score

cells = nevergrad.p.TransitionChoice(range(5), repetitions=25)
optimizer = nevergrad.optimizers.DiscreteOnePlusOne(parametrization=cells, budget=200)
optimizer.parametrization.random_state.seed(1)
for number in range(optimizer.budget):
    asked = optimizer.ask()
    optimizer.tell(asked, -score(asked.value))
best = optimizer.provide_recommendation().value
print(f"after {optimizer.budget} bodies: {score(best):.3f}")
