#!/usr/bin/env python3
"""Bodies by optuna: asked cell by cell; a study in a database is shared by many machines."""
import optuna
from walking import score

optuna.logging.set_verbosity(optuna.logging.WARNING)
study = optuna.create_study(direction="maximize", sampler=optuna.samplers.TPESampler(seed=1))
for number in range(60):
    trial = study.ask()
    study.tell(trial, score([trial.suggest_categorical(f"cell {k}", range(5)) for k in range(25)]))
print(f"after {len(study.trials)} bodies: {study.best_value:.3f}")
