"""Pictures of an EvoSim: off-screen, or in a window where there is a display."""

from __future__ import annotations

import os
import time
from typing import Any

import numpy as np

from ..library import EvoError
from ..video import Video
from .sim import EvoSim
from .utils import Timer

__all__ = ["MODES", "EvoViewer"]

MODES = ("screen", "human", "img", "rgb_array")
LOCKS = ("lock_x", "lock_y", "lock_width", "lock_height")
EASE = 0.1  # share of the way to its aim that the camera goes in a control step


class EvoViewer:
    """A camera: ``pos``, where its middle is, and ``view_size``, in voxels; ``resolution`` in
    pixels, all (x, y). target_rps: pictures per second in a window; None: as fast as they come."""

    def __init__(self, sim_to_view: EvoSim, target_rps: int | None = 50,
                 pos: tuple[float, float] = (12, 4), view_size: tuple[float, float] = (40, 20),
                 resolution: tuple[int, int] = (1200, 600)) -> None:
        self._sim = sim_to_view
        self._window: _Window | None = None
        self._tracked: list[str] = []
        self._settings: dict[str, Any] = {"padding": (5, 3), "scale": (0.2, 0.2),
                                          **dict.fromkeys(LOCKS, False)}
        self._followed_at: int | None = None  # time of the simulation
        self._shown_at = 0.0
        self._timer = Timer()
        self.set_target_rps(target_rps)
        self.set_pos(pos)
        self.set_view_size(view_size)
        self.set_resolution(resolution)

    def set_pos(self, pos: tuple[float, float]) -> None:
        self.pos = _pair("pos", pos)

    def set_view_size(self, view_size: tuple[float, float]) -> None:
        self.view_size = _pair("view_size", view_size)

    def set_resolution(self, resolution: tuple[int, int]) -> None:
        self.resolution = _pair("resolution", resolution)

    def set_target_rps(self, target_rps: int | None) -> None:
        assert target_rps is None or target_rps > 1, "the lowest target_rps is 2"
        self._target_rps = target_rps

    def track_objects(self, *objects: str) -> None:
        """The camera follows these."""
        self._tracked, self._followed_at = list(objects), None

    def set_tracking_settings(self, **settings: Any) -> None:
        """padding: room around what is followed, voxels (x, y); scale: more of it, as a share of the
        view; lock_x, lock_y, lock_width, lock_height: a number, or False."""
        for name, value in settings.items():
            if name not in self._settings:
                raise ValueError(f"no setting {name!r}; there are: " + ", ".join(self._settings))
            if name in LOCKS:
                if value is True or not isinstance(value, (bool, int, float)):
                    raise ValueError(f"{name} is a number or False, not {value!r}")
            else:
                value = _pair(name, value)
            self._settings[name] = value

    def render(self, mode: str = "screen", verbose: bool = False, hide_background: bool = False,
               hide_grid: bool = False, hide_edges: bool = False,
               hide_voxels: bool = False) -> np.ndarray | None:
        """A picture: shown by ``screen`` and ``human``, returned by ``img`` and ``rgb_array`` as
        [height, width, 3] uint8. verbose: prints once a second how many were shown."""
        if mode not in MODES:
            raise ValueError(f"mode {mode!r} is none of {', '.join(MODES)}")
        self._follow()
        hidden = {"background": hide_background, "grid": hide_grid, "edges": hide_edges, "voxels": hide_voxels}
        image = self._sim._picture(*self.resolution, window=(*self.pos, *self.view_size),
                                   hide=[part for part, away in hidden.items() if away])
        if mode in ("img", "rgb_array"):
            return image
        if self._window is None:
            self._window = _Window(*self.resolution)
        self._window.show(image)
        now = time.perf_counter()
        if self._target_rps is not None:
            time.sleep(max(0.0, min(1.0, self._shown_at + 1 / self._target_rps - now)))
        self._timer.step(verbose)
        self._shown_at = time.perf_counter()
        return None

    def video(self, width: int = 480, height: int = 240, fps: float = 25.0,
              speed: float = 1.0) -> Video:
        """What was since the reset, the first object in view."""
        moments = [positions for positions, _ in self._sim._history]
        return Video.of(moments, lambda positions: self._sim._picture(
            width, height, positions=positions), fps=fps, speed=speed)

    def show_debug_window(self) -> None:
        self.render("screen")

    def hide_debug_window(self) -> None:
        self.close()

    def close(self) -> None:
        window, self._window = self._window, None
        if window is not None:
            window.close()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_window": None}  # a copy opens one of its own

    def _follow(self) -> None:
        if not self._tracked:
            return
        now = self._sim.get_time()
        last, self._followed_at = self._followed_at, now
        aim = self._aim()
        share = 1.0 if last is None or now < last else 1 - (1 - EASE) ** (now - last)
        view = [old + share * (new - old) for old, new in zip((*self.pos, *self.view_size), aim)]
        for k, name in enumerate(LOCKS):
            if self._settings[name] is not False:
                view[k] = self._settings[name]
        self.pos, self.view_size = (view[0], view[1]), (view[2], view[3])

    def _aim(self) -> tuple[float, float, float, float]:
        points = np.concatenate(
            [self._sim.object_pos_at_time(self._sim.get_time(), name) for name in self._tracked], axis=1)
        low, high = points.min(axis=1), points.max(axis=1)
        size = (high - low + 2 * np.array(self._settings["padding"])) * (
            1 + np.array(self._settings["scale"]))
        wanted = self.resolution[0] / self.resolution[1]
        size = np.maximum(size, (wanted * size[1], size[0] / wanted))
        return (*(low + high) / 2, *size)


def _pair(name: str, value: Any) -> tuple:
    if not isinstance(value, tuple) or len(value) != 2:
        raise TypeError(f"{name} is a tuple of two numbers, not {value!r}")
    return value


class _Window:
    """By Python's tkinter."""

    def __init__(self, width: int, height: int) -> None:
        if not os.environ.get("DISPLAY"):
            raise EvoError("a window needs a display, and DISPLAY is not set; render_mode 'rgb_array' "
                           "needs none, and env.video() shows an episode in a notebook")
        try:
            import tkinter
        except ModuleNotFoundError:
            raise EvoError("a window needs Python's tkinter (Debian: python3-tk); render_mode "
                           "'rgb_array' needs none") from None
        try:
            self._root = tkinter.Tk()
        except tkinter.TclError as error:
            raise EvoError(f"no window can be opened: {error}; render_mode 'rgb_array' needs none") from None
        self._root.title("Evolution Gym")
        self._gone = tkinter.TclError
        self._image = tkinter.PhotoImage(master=self._root, width=width, height=height)
        tkinter.Label(self._root, image=self._image).pack()

    def show(self, image: np.ndarray) -> None:
        height, width = image.shape[:2]
        try:
            self._image.configure(data=b"P6 %d %d 255\n" % (width, height) + image.tobytes(), format="PPM")
            self._root.update()
        except self._gone:
            pass  # the user closed it

    def close(self) -> None:
        try:
            self._root.destroy()
        except self._gone:
            pass
