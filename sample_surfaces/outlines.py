"""Outlines of the samples in the plane: closed curves, counter-clockwise, sampled evenly along their length."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from kirisurf.errors import ParameterError

# Length is measured on this many chords a side; only the spacing of the samples depends on it, never the curve.
_CHORDS = 4096


@dataclass(frozen=True, eq=False)
class CurvedPolygon:
    """A polygon whose sides are parabolic arcs.

    Attributes
    ----------
    corners : (k, 2)
        Counter-clockwise.
    bulges : (k,)
        Largest offset of each side (from corner i to the next) to the outside, over its chord; 0 for a
        straight side, negative for one that curves inward.
    """

    corners: Float[np.ndarray, "k 2"]
    bulges: Float[np.ndarray, " k"]

    @property
    def n_sides(self) -> int:
        """Number of sides."""
        return len(self.corners)

    def side(self, i: int, s: Float[np.ndarray, " m"]) -> Float[np.ndarray, "m 2"]:
        """Return the points (m, 2) of side i at parameters (m,) from 0 to 1."""
        start, end = self.corners[i], self.corners[(i + 1) % len(self.corners)]
        chord = end - start
        outward = np.array([chord[1], -chord[0]])
        return start + s[:, None] * chord + (4 * self.bulges[i] * s * (1 - s))[:, None] * outward


@dataclass(frozen=True, eq=False)
class PolarCurve:
    """The curve (a, b) * R(t) (cos t, sin t) with R(t) = 1 + sum of amplitude * cos(k t - phase).

    Without harmonics an ellipse.

    Attributes
    ----------
    semi_axes : (2,)
        a and b, in the sample's units.
    harmonics : (m, 3)
        Rows (k, amplitude, phase): whole number, over 1, radians.
    """

    semi_axes: Float[np.ndarray, "2"]
    harmonics: Float[np.ndarray, "m 3"]

    @property
    def n_sides(self) -> int:
        """One: the curve has no corners."""
        return 1

    def side(self, i: int, s: Float[np.ndarray, " m"]) -> Float[np.ndarray, "m 2"]:
        """Return the points (m, 2) of the curve at parameters (m,) from 0 to 1."""
        t = 2 * np.pi * s
        waves = self.harmonics[:, 1:2] * np.cos(self.harmonics[:, :1] * t - self.harmonics[:, 2:])
        return self.semi_axes * ((1 + waves.sum(axis=0)) * np.array([np.cos(t), np.sin(t)])).T


@dataclass(frozen=True, eq=False)
class RoundedPolygon:
    """A regular polygon with rounded corners: where sum over sides of max(0, m.x / apothem)^sharpness = 1.

    Attributes
    ----------
    sides : int
    apothem : float
        Distance from the center to a side, in the sample's units; m is a side's outward normal.
    sharpness : float
        The higher, the rounder the corners are not; the curve is as often differentiable.
    """

    sides: int
    apothem: float
    sharpness: float

    @property
    def n_sides(self) -> int:
        """One: the curve has no corners."""
        return 1

    def side(self, i: int, s: Float[np.ndarray, " m"]) -> Float[np.ndarray, "m 2"]:
        """Return the points (m, 2) of the curve at parameters (m,) from 0 to 1."""
        t = 2 * np.pi * s
        facing = 2 * np.pi * np.arange(self.sides)[:, None] / self.sides
        total = (np.maximum(np.cos(t - facing), 0.0) ** self.sharpness).sum(axis=0)
        return (self.apothem * total ** (-1 / self.sharpness) * np.array([np.cos(t), np.sin(t)])).T


# A closed plane curve, counter-clockwise, of `n_sides` smooth sides with corners between them.
Outline = CurvedPolygon | PolarCurve | RoundedPolygon


def outline_from(table: Mapping[str, Any]) -> Outline:
    """Return the outline that a spec's table describes.

    Raises
    ------
    ParameterError
        Where the kind of outline is unknown.
    """
    match table["kind"]:
        case "curved_polygon":
            return CurvedPolygon(np.array(table["corners"], dtype=float), np.array(table["bulges"], dtype=float))
        case "polar":
            harmonics = np.array(table.get("harmonics", []), dtype=float).reshape(-1, 3)
            return PolarCurve(np.array(table["semi_axes"], dtype=float), harmonics)
        case "rounded_polygon":
            return RoundedPolygon(int(table["sides"]), float(table["apothem"]), float(table["sharpness"]))
        case kind:
            raise ParameterError(f"outline: expected curved_polygon, polar or rounded_polygon, got {kind!r}")


def outline_points(outline: Outline, edge: float) -> Float[np.ndarray, "b 2"]:
    """Return points (b, 2) on an outline, about `edge` apart along it, every corner among them."""
    return np.concatenate([outline.side(i, _evenly(side, edge)) for i, side in enumerate(_dense(outline))])


def outline_box(outline: Outline) -> Float[np.ndarray, "2 2"]:
    """Return the lower and upper corner (2, 2) of an outline's box."""
    points = np.concatenate(_dense(outline))
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _dense(outline: Outline) -> list[np.ndarray]:
    return [outline.side(i, np.linspace(0.0, 1.0, _CHORDS)) for i in range(outline.n_sides)]


def _evenly(dense: np.ndarray, edge: float) -> np.ndarray:
    # Parameters (m,) in [0, 1), evenly spaced along the length of a curve given by dense points.
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(dense, axis=0), axis=1))])
    count = max(1, round(float(length[-1]) / edge))
    wanted = np.arange(count) * (length[-1] / count)
    return np.interp(wanted, length, np.linspace(0.0, 1.0, len(dense)))
