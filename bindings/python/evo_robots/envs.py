"""Imported for its effect: the tasks under the benchmark's own names, so that
its scripts run with ``evo_robots`` in the place of ``evogym``."""

from .tasks import register

register("")
