"""Framing: from where a target is looked at, and how large a picture of it is.

Every picture is a parallel projection: lengths across the line of sight keep their scale, so that a scale
bar is true, and things can be drawn before or behind others without moving in the picture.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.surface import Surface

ELEVATIONS = (38.0, 46.0, 54.0)
ASIDE = 18.0
WELL_SEEN = 0.9


@dataclass(frozen=True)
class View:
    """A line of sight.

    Attributes
    ----------
    direction : 3 floats
        Unit vector from what is looked at toward the eye.
    up : 3 floats
        Direction that stands upright in the picture.
    """

    direction: tuple[float, float, float]
    up: tuple[float, float, float]

    @property
    def axes(self) -> np.ndarray:
        """Rows: right, up in the picture, and toward the eye; (3, 3), orthonormal."""
        toward = np.array(self.direction) / np.linalg.norm(self.direction)
        right = np.cross(self.up, toward)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(toward, right), toward])


FROM_ABOVE = View((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))


@dataclass(frozen=True)
class Frame:
    """The rectangle of a picture in the user's units: its center, and half of its height."""

    center: tuple[float, float, float]
    half_height: float
    depth: float


def choose_view(surface: Surface) -> View:
    """Choose the line of sight from the target's shape.

    The z axis stands upright. A surface that faces up or down (most of its area) is seen obliquely from
    above, its longer side, if it is clearly longer, across the picture, from the lowest of three elevations
    that shows nearly all of it from one side; a surface that faces sideways (a mask, a facade) is seen a
    little from the side and from above.
    """
    areas = surface.face_areas
    if not len(areas) or not areas.sum() > 0:
        return View(_toward(-60.0, ELEVATIONS[0]), (0.0, 0.0, 1.0))
    normals = surface.face_normals
    facing = areas @ normals / areas.sum()
    strength = float(np.linalg.norm(facing))
    if strength > 0.2 and abs(facing[2]) < 0.5 * strength:
        azimuth = float(np.degrees(np.arctan2(facing[1], facing[0])))
        return View(_toward(azimuth + 25.0, 15.0), (0.0, 0.0, 1.0))
    weights = areas / areas.sum()
    across = _longer_axis(surface.vertices[surface.faces].mean(axis=1), weights)
    best = (-1.0, -np.inf)
    chosen = View(_toward(-60.0, ELEVATIONS[0]), (0.0, 0.0, 1.0))
    for elevation in ELEVATIONS:
        # The eye stands a little to the side of the broad side; of equals the first (south) wins.
        for azimuth in sorted((across + s * 90.0 + t for s in (-1, 1) for t in (ASIDE, -ASIDE)), key=_from_south):
            view = View(_toward(azimuth, elevation), (0.0, 0.0, 1.0))
            share = float(weights @ (normals @ np.array(view.direction) * np.sign(facing[2] or 1.0) > 0.08))
            score = (round(share, 1), -fit_frame(view, surface.vertices, 4.0 / 3.0).half_height)
            if score[0] > best[0] or (score[0] == best[0] and score[1] > best[1] * (1 - 0.02 * np.sign(best[1]))):
                best, chosen = score, view
        if best[0] >= WELL_SEEN:
            break
    return chosen


def fit_frame(view: View, points: Float[np.ndarray, "n 3"], aspect: float, margin: float = 0.04) -> Frame:
    """Return the smallest rectangle of the given aspect (width / height) that shows all points.

    Parameters
    ----------
    view : View
    points : (n, 3)
    aspect : float
        Width over height of the picture.
    margin : float
        Free part of the picture on every side.
    """
    axes = view.axes
    if not len(points):
        return Frame((0.0, 0.0, 0.0), 1.0, 1.0)
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    size = high - low
    half = 0.5 * max(float(size[1]), float(size[0]) / aspect) / (1.0 - 2.0 * margin)
    center = (0.5 * (low + high)) @ axes
    depth = float(np.linalg.norm(size))
    return Frame((float(center[0]), float(center[1]), float(center[2])), half or 1.0, depth or 1.0)


def round_length(length: float | int) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not longer than `length`.

    Examples
    --------
    >>> round_length(730.0)
    500.0
    """
    if not length > 0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(length))
    return float(max(step for step in (1.0, 2.0, 5.0, 0.5) if step * power <= length * (1 + 1e-12)) * power)


def _toward(azimuth: float, elevation: float) -> tuple[float, float, float]:
    a, e = np.radians(azimuth), np.radians(elevation)
    return float(np.cos(e) * np.cos(a)), float(np.cos(e) * np.sin(a)), float(np.sin(e))


def _from_south(azimuth: float) -> float:
    return abs((azimuth + 60.0 + 180.0) % 360.0 - 180.0)


def _longer_axis(centers: np.ndarray, weights: np.ndarray) -> float:
    """Azimuth in degrees of the longer horizontal extent; 0 (the x axis) where none stands out by half."""
    flat = centers[:, :2] - weights @ centers[:, :2]
    spread = flat.T @ (weights[:, None] * flat)
    values, vectors = np.linalg.eigh(spread)
    if values[1] < 2.4 * values[0]:
        return 0.0
    x, y = vectors[:, 1]
    return float(np.degrees(np.arctan2(y, x)))
