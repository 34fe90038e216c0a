"""The commands evo-train, evo-render, .. of a wheel: what they start lies within the package."""

from __future__ import annotations

import os
import sys

from .library import PACKAGE

__all__ = ["main"]


def main() -> None:
    """Becomes the tool of this command's name. The tools it starts in turn are found at once."""
    folder = str(PACKAGE / "suite" / "bin")
    path = os.path.join(folder, os.path.basename(sys.argv[0]))
    os.environ["PATH"] = os.pathsep.join([folder, os.environ.get("PATH", os.defpath)])
    os.execv(path, [path, *sys.argv[1:]])
