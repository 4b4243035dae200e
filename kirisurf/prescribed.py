"""A prescribed outline and the vertices that follow it: what a certificate checks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from kirisurf.outlines import Outline, straight
from kirisurf.rim import Rim


@dataclass(frozen=True, eq=False)
class Prescribed:
    """Vertices of a sheet and the outline that they lie on.

    Attributes
    ----------
    vertices : (k,)
    sides : (k,)
        Side of the outline of each; -1 throughout where any will do.
    outline : Outline
        In the units and the frame of the points.
    """

    vertices: Int[np.ndarray, " k"]
    sides: Int[np.ndarray, " k"]
    outline: Outline

    def distances(self, points: Float[np.ndarray, "n d"]) -> Float[np.ndarray, " k"]:
        """Return the distances of the vertices to their sides, which end at the corners, in the points' units."""
        sides = self.sides if len(self.sides) and self.sides.min() >= 0 else None
        return np.abs(self.outline.project(points[self.vertices, :2], sides).distances)


def rectangle_of(points: Float[np.ndarray, "n 2"], rim: Rim, ratio: float | None) -> Outline:
    """Return the rectangle along the axes that the four sides of a contracted rim come nearest to.

    Where a ratio of width to height is asked for, it has that ratio.
    """
    bottom, right, top, left = (float(points[rim.side(k), axis].mean()) for k, axis in enumerate((1, 0, 1, 0)))
    center = 0.5 * np.array([left + right, bottom + top])
    half = 0.5 * np.array([right - left, top - bottom])
    if ratio is not None:
        half = np.sqrt(half[0] * half[1]) * np.array([np.sqrt(ratio), 1 / np.sqrt(ratio)])
    corner = center + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    sides = [straight(np.stack([corner[k], corner[(k + 1) % 4]])) for k in range(4)]
    return Outline("rectangle", tuple(sides))
