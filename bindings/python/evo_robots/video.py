"""Moving pictures for notebooks and files."""

from __future__ import annotations

import base64
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Callable, Sequence

import numpy as np

from .library import EvoError

__all__ = ["MOST_STEPS", "STEPS_PER_SECOND", "Video"]

STEPS_PER_SECOND = 50  # of a video at speed 1: the benchmark's viewer
MOST_STEPS = 2000  # that environments keep of an episode


class Video:
    """Frames [height, width, 3] uint8, all of one size; drawn when they are wanted."""

    def __init__(self, frames: Sequence[Any], fps: float, says: str = "") -> None:
        if len(frames) == 0:
            raise ValueError("a video has a frame or more: reset the environment first")
        self._frames, self.fps, self._says = frames, fps, says

    @classmethod
    def of(cls, moments: Sequence[Any], draw: Callable[[Any], np.ndarray], *, fps: float,
           speed: float, says: str = "") -> "Video":
        """Of what was at every control step."""
        if not (fps > 0 and speed > 0):
            raise ValueError(f"fps and speed are above 0, not {fps} and {speed}")
        every = STEPS_PER_SECOND * speed / fps
        steps = [*np.arange(0, len(moments) - 1, every).astype(int), len(moments) - 1] if moments else []
        return cls(_Drawn([moments[step] for step in steps], draw), fps, says)

    def __len__(self) -> int:
        return len(self._frames)

    def __getitem__(self, number: int) -> np.ndarray:
        return self._frames[number]

    def __repr__(self) -> str:
        return f"Video of {len(self)} frames, {len(self) / self.fps:.1f} s {self._says}".rstrip()

    def save(self, path: str | os.PathLike) -> None:
        """A file by its ending, .mp4, .webm or .gif, by the program ffmpeg. It appears whole or not
        at all."""
        target = Path(path)
        if target.suffix not in (".mp4", ".webm", ".gif"):
            raise ValueError(f"{target}: a video ends in .mp4, .webm or .gif")
        part = target.with_name(f".{target.stem}.{os.getpid()}{target.suffix}")
        try:
            self._encode(part)
            os.replace(part, target)
        finally:
            part.unlink(missing_ok=True)

    def _encode(self, path: Path) -> None:
        if shutil.which("ffmpeg") is None:
            raise EvoError("videos need the program ffmpeg, which is not in PATH")
        height, width = self[0].shape[:2]
        if path.suffix == ".gif":  # of the colours that are there, as evo-render
            coding = ["-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=none"]
        else:
            coding = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]
        encoder = subprocess.Popen(
            ["ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s",
             f"{width}x{height}", "-r", str(self.fps), "-i", "-",
             *coding, str(path)],
            stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            for number in range(len(self)):
                encoder.stdin.write(self[number].tobytes())
        except BrokenPipeError:
            pass  # it says why below
        _, said = encoder.communicate()
        if encoder.returncode != 0:
            raise EvoError(f"ffmpeg: {said.decode(errors='replace').strip()}")

    def _repr_html_(self) -> str:
        with tempfile.TemporaryDirectory() as folder:
            self.save(Path(folder, "video.mp4"))
            data = base64.b64encode(Path(folder, "video.mp4").read_bytes()).decode()
        return f'<video src="data:video/mp4;base64,{data}" controls autoplay loop muted></video>'


class _Drawn(Sequence):
    """Moments that are drawn one by one, and not kept."""

    def __init__(self, moments: list, draw: Callable[[Any], np.ndarray]) -> None:
        self._moments, self._draw = moments, draw

    def __len__(self) -> int:
        return len(self._moments)

    def __getitem__(self, number: int) -> np.ndarray:
        return self._draw(self._moments[number])
