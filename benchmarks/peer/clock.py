"""Seconds of processor time, which what others do on a machine does not change:
of this process and of those it steps environments in."""
import time

from evo_robots import Simulator


def seconds(simulator: Simulator | None = None) -> float:
    used = time.process_time()
    if simulator is not None:  # its process, as clock_getcpuclockid(3) of Linux names it
        used += time.clock_gettime((~simulator.pid << 3) | 2)
    return used
