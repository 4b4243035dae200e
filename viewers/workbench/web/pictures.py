"""The two views of one browser: drawn off-screen, sent as images, turned by what its hand does."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from viewers.drawing import plain_theme
from viewers.opengl import off_screen_window, probe
from viewers.scenes import Scene
from viewers.workbench.placing import turn_and_ratio
from viewers.workbench.views import SIDES, Hit, Views
from viewers.workbench.web import camera
from viewers.workbench.web.charts import scale_bar

LEAST, MOST = 64, 3200
"""Pixels along a side of a picture."""

MOVING, STILL = (72, 0), (93, 4)
"""Quality of the image (JPEG) and samples per pixel, while something moves and when it rests."""


class Pictures:
    """Two views in one image.

    Parameters
    ----------
    width, height : int
        Of the image, in pixels of the page.
    ratio : float
        Pixels of the screen per pixel of the page.
    """

    def __init__(self, width: int, height: int, ratio: float | int = 1.0) -> None:
        import pyvista

        self.ratio = float(min(max(ratio, 1.0), 2.0))
        self.width, self.height = _clamped(width), _clamped(height)
        with off_screen_window(probe()):
            self.plotter = pyvista.Plotter(
                off_screen=True, shape=(1, 2), lighting="none", border=False, theme=plain_theme(), line_smoothing=False
            )
            self.plotter.render_window.SetSize(*self._pixels)
        self.views = Views(self.plotter, self.ratio)
        self._framed: object = None

    @property
    def _pixels(self) -> tuple[int, int]:
        return round(self.width * self.ratio), round(self.height * self.ratio)

    def resize(self, width: int, height: int) -> None:
        """Take another size; what is in the picture stays in it."""
        self.width, self.height = _clamped(width), _clamped(height)
        self.plotter.render_window.SetSize(*self._pixels)

    def show(self, scenes: tuple[Scene, Scene], is_linked: bool, framed: object) -> None:
        """Take in what is to be drawn; `framed` is what the first look at it is told apart by."""
        self.views.link(is_linked)
        self.views.show(scenes)
        if framed != self._framed and any(len(scene.frame) for scene in scenes):
            self._framed = framed
            self.reset()

    def reset(self) -> None:
        """Look from where the scenes say."""
        self.views.reset(self.width, self.height)

    def image(self, is_moving: bool) -> bytes:
        """Draw, and return the image as JPEG."""
        from PIL import Image

        quality, samples = MOVING if is_moving else STILL
        window = self.plotter.render_window
        window.SetMultiSamples(samples)
        window.Render()
        buffer = io.BytesIO()
        Image.fromarray(_pixels(window)).save(buffer, "JPEG", quality=quality, subsampling=2 if is_moving else 0)
        return buffer.getvalue()

    def scales(self, units: str) -> list[dict[str, Any]]:
        """Return the scale bars of both views."""
        return [scale_bar(self.views.units_per_pixel(side, self.height), 0.5 * self.width, units) for side in SIDES]

    def close(self) -> None:
        """Give the OpenGL window back."""
        self.plotter.close()

    # what a hand does, in pixels of the page from the upper left corner of the image

    def turn(self, x: float | int, y: float | int, dx: float | int, dy: float | int) -> None:
        """Turn the view at a place."""
        camera.turn(self._camera(x), dx / self.height, dy / self.height)
        self.views.clip()

    def shift(self, x: float | int, y: float | int, dx: float | int, dy: float | int) -> None:
        """Shift the view at a place."""
        camera.shift(self._camera(x), dx / self.height, dy / self.height)
        self.views.clip()

    def zoom(self, x: float | int, y: float | int, factor: float | int) -> None:
        """Bring the view nearer, or farther; the place stays where it is."""
        middle = (0.75 if self._side(x) else 0.25) * self.width
        camera.zoom(self._camera(x), factor, (x - middle) / self.height, (y - 0.5 * self.height) / self.height)
        self.views.clip()

    def hit(self, x: float | int, y: float | int) -> Hit:
        """Return what lies at a place."""
        return self.views.hit(x / self.width, y / self.height)

    def placed(self, first: tuple[float, float], last: tuple[float, float]) -> tuple[float, float]:
        """Return the angle and the ratio of distances of a drag about the middle of the right view."""
        return turn_and_ratio(first, last, (0.75 * self.width, 0.5 * self.height))

    def _side(self, x: float) -> int:
        return int(x > 0.5 * self.width)

    def _camera(self, x: float) -> Any:
        return self.views.camera(self._side(x))


def numbers(message: dict[str, Any], *names: str) -> tuple[float, ...]:
    """Return numbers of a message from a browser.

    Raises
    ------
    ValueError
        Where one is missing or no finite number.

    Examples
    --------
    >>> numbers({"x": 1, "y": 2.5}, "x", "y")
    (1.0, 2.5)
    """
    found = []
    for name in names:
        value = message.get(name)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise ValueError(f"{name}: expected a finite number, got {value!r}")
        found.append(float(value))
    return tuple(found)


HANDS: dict[str, tuple[Callable[..., None], tuple[str, ...]]] = {
    "turn": (Pictures.turn, ("x", "y", "dx", "dy")),
    "shift": (Pictures.shift, ("x", "y", "dx", "dy")),
    "zoom": (Pictures.zoom, ("x", "y", "factor")),
}
"""What moves the camera, by the kind of a message, and the numbers that it needs."""


def _pixels(window: Any) -> np.ndarray:
    """What a window shows, from the top, (height, width, 3)."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

    width, height = window.GetSize()
    buffer = vtkUnsignedCharArray()
    window.GetPixelData(0, 0, width - 1, height - 1, 1, buffer, 0)
    return np.ascontiguousarray(vtk_to_numpy(buffer).reshape(height, width, 3)[::-1])


def _clamped(pixels: float | int) -> int:
    return int(min(max(pixels, LEAST), MOST))
