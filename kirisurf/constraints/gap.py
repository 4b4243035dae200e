"""Tiles that hinge on each other do not close the gap between them that contraction leaves open.

A hinge has a gap on either side. One of them is a slit end, which :mod:`kirisurf.constraints.opening` keeps open; the
other, outside the rim or inside a designed opening, closes where both tiles and the slit are too wide.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

_LOW = -np.pi / 6
"""Least angle that is told from one a full turn larger: gaps open to 330 degrees, beside the narrowest tiles."""


class OpenGaps:
    """One inequality row for every gap: the angle from one side to the other, in the plane, minus the least one.

    Parameters
    ----------
    gaps : (g, 3) int
        (end of one side, hinge, end of the other), counter-clockwise; their points are flat.
    least : float
        Smallest angle, in radians.
    """

    name = "gap"
    n_rows = 1

    def __init__(self, gaps: Int[np.ndarray, "g 3"], least: float) -> None:
        self.stencil = np.asarray(gaps, dtype=np.int64)
        self.curvature_stencil = self.stencil
        self._least = least

    def _sides(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        first, hinge, second = points[self.stencil].transpose(1, 0, 2)[:, :, :2]
        return first - hinge, second - hinge

    def residual(self, points: np.ndarray) -> np.ndarray:
        """Angles minus the least, (g, 1): not negative where allowed."""
        return (gap_angles(*self._sides(points)) - self._least)[:, None]

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        """First derivatives (g, 1, 9)."""
        result = np.zeros((len(self.stencil), 1, 3, 3))
        for end, sign, side in zip((0, 2), (-1.0, 1.0), self._sides(points), strict=True):
            around = sign * _gradients(side)
            result[:, 0, end, :2] = around
            result[:, 0, 1, :2] -= around
        return result.reshape(-1, 1, 9)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Second derivatives (g, 9, 9)."""
        result = np.zeros((len(self.stencil), 3, 3, 3, 3))
        for end, sign, side in zip((0, 2), (-1.0, 1.0), self._sides(points), strict=True):
            x, y = _gradients(side).T
            # of the direction of (a, b) with gradient (x, y) = (-b, a) / r^2
            bend = np.stack([np.stack([-2 * x * y, x * x - y * y], 1), np.stack([x * x - y * y, 2 * x * y], 1)], 1)
            bend *= (sign * multipliers[:, 0])[:, None, None]
            result[:, end, :2, end, :2] += bend
            result[:, 1, :2, 1, :2] += bend
            result[:, end, :2, 1, :2] -= bend
            result[:, 1, :2, end, :2] -= bend
        return result.reshape(-1, 9, 9)


def gap_angles(u: Float[np.ndarray, "g 2"], v: Float[np.ndarray, "g 2"]) -> Float[np.ndarray, " g"]:
    """Return the angles from u to v, in radians, from -pi/6 to 11 pi/6.

    Examples
    --------
    >>> gap_angles(np.array([[1.0, 0]]), np.array([[-1.0, -1e-9]])).round(6).tolist()
    [3.141593]
    """
    cross, dot = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1)
    angle = np.arctan2(cross, dot)
    return np.where(angle < _LOW, angle + 2 * np.pi, angle)


def _gradients(side: np.ndarray) -> np.ndarray:
    """Derivatives (g, 2) of the direction of a side."""
    return np.stack([-side[:, 1], side[:, 0]], axis=1) / (side**2).sum(axis=1, keepdims=True)
