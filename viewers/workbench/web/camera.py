"""A camera that a hand turns, shifts and brings nearer: a parallel projection, as every picture here is."""

from __future__ import annotations

from typing import Any

import numpy as np

TURN = 180.0
"""Degrees of a drag across the height of a picture."""


def turn(camera: Any, dx: float | int, dy: float | int) -> None:
    """Turn round what is looked at, by a drag in shares of the picture's height (right and down)."""
    camera.Azimuth(-TURN * dx)
    camera.Elevation(TURN * dy)
    camera.OrthogonalizeViewUp()


def shift(camera: Any, dx: float | int, dy: float | int) -> None:
    """Shift so that what was under the hand stays there, by a drag in shares of the picture's height."""
    right, up = _axes(camera)
    by = 2.0 * camera.GetParallelScale() * (-dx * right + dy * up)
    for get, put in (
        (camera.GetFocalPoint, camera.SetFocalPoint),
        (camera.GetPosition, camera.SetPosition),
    ):
        put(*(np.array(get()) + by))


def zoom(camera: Any, factor: float | int, x: float | int = 0.0, y: float | int = 0.0) -> None:
    """Make everything larger by a factor; what lies at (x, y) stays there.

    Parameters
    ----------
    camera : vtkCamera
    factor : float
    x, y : float
        From the middle of the view, in shares of its height (right and down).
    """
    factor = min(max(float(factor), 0.1), 10.0)
    shift(camera, -x, -y)
    camera.SetParallelScale(camera.GetParallelScale() / factor)
    shift(camera, x, y)


def _axes(camera: Any) -> tuple[np.ndarray, np.ndarray]:
    """Directions that point right and up in the picture."""
    toward = np.array(camera.GetPosition()) - np.array(camera.GetFocalPoint())
    right = np.cross(camera.GetViewUp(), toward)
    right /= np.linalg.norm(right)
    up = np.cross(toward, right)
    return right, up / np.linalg.norm(up)
