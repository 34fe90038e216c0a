#!/usr/bin/python3
"""Compares a rollout with a reference trajectory, step by step.

usage: compare_rollout.py REFERENCE.h5 OURS.h5 [STEPS]

Positions and rewards within 1e-9, observations within 1e-8 (orientations agree
exactly, the summation order being the reference's), ends equal. STEPS bounds
what is compared. Files of a falling body hold positions only.
"""

import sys

import h5py
import numpy as np


def main():
    reference = h5py.File(sys.argv[1], "r")["episode_0"]
    ours = h5py.File(sys.argv[2], "r")["episode_0"]
    steps = len(reference["actions"])
    if len(ours["actions"]) != steps:
        sys.exit(f"{sys.argv[2]}: {len(ours['actions'])} steps, not {steps}")
    if len(sys.argv) > 3:
        steps = min(steps, int(sys.argv[3]))
    checks = [("infos/positions", steps + 1, 1e-9)]
    if reference["observations"].shape[1] > 0:
        checks += [("observations", steps + 1, 1e-8), ("rewards", steps, 1e-9),
                   ("terminations", steps, 0), ("truncations", steps, 0)]
    for name, rows, tolerance in checks:
        a = np.asarray(reference[name][:rows], dtype=float)
        b = np.asarray(ours[name][:rows], dtype=float)
        if a.shape != b.shape:
            sys.exit(f"{sys.argv[2]}: {name} has shape {b.shape}, not {a.shape}")
        difference = np.abs(a - b).max()
        if not difference <= tolerance:
            sys.exit(f"{sys.argv[2]}: {name} differs by {difference:g}, more than {tolerance:g}")


main()
