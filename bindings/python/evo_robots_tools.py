"""The commands evo-train, evo-render, .. of a wheel: what they start lies within the package, which
is not imported for it (numpy and Gymnasium take 0.4 s)."""

from __future__ import annotations

import importlib.util
import os
import sys

__all__ = ["main"]


def main() -> None:
    """Becomes the tool of this command's name. The tools it starts in turn are found at once."""
    package = importlib.util.find_spec("evo_robots").submodule_search_locations[0]
    folder = os.path.join(package, "suite", "bin")
    path = os.path.join(folder, os.path.basename(sys.argv[0]))
    os.environ["PATH"] = os.pathsep.join([folder, os.environ.get("PATH", os.defpath)])
    os.execv(path, [path, *sys.argv[1:]])
