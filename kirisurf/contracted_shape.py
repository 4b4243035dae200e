"""The shape of the contracted sheet: free, a rectangle, or a given outline whose size is free."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import group_means
from kirisurf.errors import ParameterError
from kirisurf.four_sides import between, patch
from kirisurf.outline_rows import FollowsScaledOutline, IsRectangle, OutlineRows
from kirisurf.outlines import Outline
from kirisurf.rim import Rim, rectangle_rim
from kirisurf.tessellation import Tessellation

CORNER = np.radians(30.0)
"""Turning of an outline from which a corner of the contracted pattern lies on it."""


@dataclass(frozen=True, eq=False)
class ContractedShape:
    """What is asked of the contracted sheet's outline.

    Attributes
    ----------
    kind : str
        free, rectangle or outline.
    ratio : float, optional
        Width over height of a rectangle.
    outline : Outline, optional
        With four sides, its middle at the origin and of area 1.
    """

    kind: str = "free"
    ratio: float | None = None
    outline: Outline | None = None

    def start(self, tessellation: Tessellation, scale: float) -> Float[np.ndarray, "q 3"]:
        """Return the regular contracted sheet, and the size of its outline where that is unknown."""
        layout = scale * welded(tessellation, tessellation.contracted)
        points = np.column_stack([layout, np.zeros(len(layout))])
        if self.outline is None:
            return points
        # the size is measured about the middle
        low, high = layout.min(axis=0), layout.max(axis=0)
        points[:, :2] -= 0.5 * (low + high)
        return np.concatenate([points, [[float(np.sqrt(np.prod(high - low))), 0.0, 0.0]]])

    def rows(self, tessellation: Tessellation, t: float = 1.0) -> tuple[OutlineRows, ...]:
        """Return the rows on the way (t from 0 to 1) from the regular contracted sheet to this shape.

        Raises
        ------
        ParameterError
            Where the contracted sheet has no four sides.
        """
        if self.kind == "free":
            return ()
        rim, ratio = self.rim(tessellation), regular_ratio(tessellation)
        if self.kind == "rectangle":
            wanted = None if self.ratio is None else ratio ** (1 - t) * self.ratio**t
            return (IsRectangle("contracted", rim, wanted),)
        if self.outline is None:
            return ()
        size = tessellation.n_vertices + tessellation.n_welded
        return (FollowsScaledOutline("contracted", rim, _between(self.outline, ratio, t), size),)

    def moved(
        self, points: Float[np.ndarray, "q 3"], tessellation: Tessellation, t: float, to: float
    ) -> Float[np.ndarray, "q 3"]:
        """Return the points of a problem with the contracted ones displaced as the shape is on the way from t."""
        n, w = tessellation.n_vertices, tessellation.n_welded
        points, ratio = points.copy(), regular_ratio(tessellation)
        if self.kind == "rectangle" and self.ratio is not None:
            factor = np.sqrt((self.ratio / ratio) ** (to - t))
            points[n : n + w, :2] *= [factor, 1 / factor]
        elif self.outline is not None:
            layout = welded(tessellation, tessellation.contracted)
            low, high = layout.min(axis=0), layout.max(axis=0)
            place, size = (layout - low) / (high - low), points[n + w, 0]
            points[n : n + w, :2] += size * (
                patch(_between(self.outline, ratio, to), place) - patch(_between(self.outline, ratio, t), place)
            )
        return points

    def rim(self, tessellation: Tessellation) -> Rim:
        """Return the contracted vertices that follow the shape, as points of the problem.

        Corners of the pattern stay free where the outline has none: a tile's corner cannot become straight.

        Raises
        ------
        ParameterError
            Where the contracted sheet has no four sides.
        """
        found = rectangle_rim(tessellation.contracted)
        if any(len(np.unique(tessellation.weld[found.side(k)])) < 2 for k in range(4)):
            raise ParameterError(
                f"--contracted: expected a pattern whose contracted sheet has four sides, got {tessellation.name} "
                "whose outermost points are not two or more on every side"
            )
        vertices, sides = tessellation.weld[found.vertices], found.sides
        if self.outline is not None:
            for k, turn in enumerate(_turns(self.outline)):
                both = np.intersect1d(vertices[sides == k], vertices[sides == (k - 1) % 4])
                kept = ~np.isin(vertices, both) | (turn > CORNER)
                vertices, sides = vertices[kept], sides[kept]
        # every side in the direction in which the outline runs, each vertex once
        layout = welded(tessellation, tessellation.contracted)
        ordered = []
        for k, (axis, sign) in enumerate(((0, 1.0), (1, 1.0), (0, -1.0), (1, -1.0))):
            side = np.unique(vertices[sides == k])
            ordered.append(side[np.argsort(sign * layout[side, axis], kind="stable")])
        return Rim(
            tessellation.n_vertices + np.concatenate(ordered),
            np.repeat(np.arange(4), [len(side) for side in ordered]),
        )


def _between(outline: Outline, ratio: float, t: float) -> Outline:
    half = 0.5 * np.array([np.sqrt(ratio), 1 / np.sqrt(ratio)])
    return between(-half, half, outline, t)


def _turns(outline: Outline) -> list[float]:
    """Angle (radians) by which an outline turns to the left where each of its sides begins."""
    turns = []
    for k, side in enumerate(outline.sides):
        before = outline.sides[k - 1]
        u = before.tangents(*before.located(np.array([float(before.n_pieces)])))[0]
        v = side.tangents(*side.located(np.array([0.0])))[0]
        turns.append(float(np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v)))
    return turns


def welded(tessellation: Tessellation, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "w 2"]:
    """Return the means of the copies of every welded vertex."""
    return group_means(points, tessellation.weld, tessellation.n_welded)


def regular_ratio(tessellation: Tessellation) -> float:
    """Return width over height of the regular contracted sheet."""
    size = np.ptp(tessellation.contracted, axis=0)
    return float(size[0] / size[1])
