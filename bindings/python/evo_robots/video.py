"""Moving pictures for notebooks and files."""

from __future__ import annotations

import base64
import os
import shutil
import struct
import subprocess
import zlib
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
        steps = np.unique(np.append(np.arange(0, len(moments) - 1, every).astype(int),
                                    len(moments) - 1)) if moments else []
        return cls(_Drawn([moments[step] for step in steps], draw), fps, says)

    def __len__(self) -> int:
        return len(self._frames)

    def __getitem__(self, number: int) -> np.ndarray:
        return self._frames[number]

    def __repr__(self) -> str:
        return f"Video of {len(self)} frames, {len(self) / self.fps:.1f} s {self._says}".rstrip()

    def png(self) -> bytes:
        """All of it as an animated PNG, which every browser plays."""
        height, width = self[0].shape[:2]

        def chunk(kind: bytes, data: bytes) -> bytes:
            return struct.pack(">I", len(data)) + kind + data + struct.pack(
                ">I", zlib.crc32(kind + data))

        parts = [b"\x89PNG\r\n\x1a\n",
                 chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
                 chunk(b"acTL", struct.pack(">II", len(self), 0))]
        order = 0
        for number in range(len(self)):
            # Rows as they are, without one of PNG's filters: the pictures are flat.
            rows = np.zeros((height, 1 + 3 * width), np.uint8)
            rows[:, 1:] = self[number].reshape(height, -1)
            data = zlib.compress(rows.tobytes(), 6)
            parts.append(chunk(b"fcTL", struct.pack(">IIIIIHHBB", order, width, height, 0, 0, 1000,
                                                    round(1000 * self.fps), 0, 0)))
            order += 1
            if number == 0:
                parts.append(chunk(b"IDAT", data))
            else:
                parts.append(chunk(b"fdAT", struct.pack(">I", order) + data))
                order += 1
        return b"".join(parts + [chunk(b"IEND", b"")])

    def save(self, path: str | os.PathLike) -> None:
        """A file by its ending: .png or .apng (animated), and with the program ffmpeg .mp4, .webm
        or .gif. It appears whole or not at all."""
        target = Path(path)
        if target.suffix not in (".png", ".apng", ".mp4", ".webm", ".gif"):
            raise ValueError(f"{target}: a video ends in .png, .apng, .mp4, .webm or .gif")
        part = target.with_name(f".{target.stem}.{os.getpid()}{target.suffix}")
        try:
            if target.suffix in (".png", ".apng"):
                part.write_bytes(self.png())
            else:
                self._encode(part)
            os.replace(part, target)
        finally:
            part.unlink(missing_ok=True)

    def _encode(self, path: Path) -> None:
        if shutil.which("ffmpeg") is None:
            raise EvoError(f"{path.suffix} needs the program ffmpeg; a video ending in .png does not")
        height, width = self[0].shape[:2]
        even = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]
        encoder = subprocess.Popen(
            ["ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s",
             f"{width}x{height}", "-r", str(self.fps), "-i", "-",
             *([] if path.suffix == ".gif" else even), str(path)],
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
        data = base64.b64encode(self.png()).decode()
        return f'<img src="data:image/png;base64,{data}" alt="a robot in motion"/>'


class _Drawn(Sequence):
    """Moments that are drawn one by one, and not kept."""

    def __init__(self, moments: list, draw: Callable[[Any], np.ndarray]) -> None:
        self._moments, self._draw = moments, draw

    def __len__(self) -> int:
        return len(self._moments)

    def __getitem__(self, number: int) -> np.ndarray:
        return self._draw(self._moments[number])
