"""The rim of a pattern: which of its outer vertices follow a prescribed outline, deployed or contracted.

A deployed rim is a row of tips with gaps between them: tips follow the outline, the hinges behind them do not. In a
rectangular pattern the tips are the vertices farthest out on each of the four sides (as the authors of the paper
take them); in a trimmed one those that no outer vertex nearby exceeds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from kirisurf.arrays import frozen
from kirisurf.tessellation import Tessellation

SIDES = ("bottom", "right", "top", "left")
_NEAR = 1e-6
LEVEL = 0.12
"""Part of a cell by which a tip may lie behind one nearby."""


@dataclass(frozen=True, eq=False)
class Rim:
    """Vertices that follow an outline.

    Attributes
    ----------
    vertices : (k,)
    sides : (k,)
        Side of each: 0 to 3 for bottom, right, top, left; -1 throughout where the pattern has no sides.
    """

    vertices: Int[np.ndarray, " k"]
    sides: Int[np.ndarray, " k"]

    @property
    def has_sides(self) -> bool:
        """Has the pattern four sides?"""
        return bool((self.sides >= 0).all())

    def side(self, k: int) -> np.ndarray:
        """Vertices of side k."""
        return self.vertices[self.sides == k]


def rectangle_rim(layout: Float[np.ndarray, "n 2"]) -> Rim:
    """Return the vertices of a rectangular pattern's layout that lie on its bounding box, side by side."""
    low, high = layout.min(axis=0), layout.max(axis=0)
    near = _NEAR * float((high - low).max())
    found = [
        np.flatnonzero(np.abs(layout[:, axis] - bound) <= near)
        for axis, bound in ((1, low[1]), (0, high[0]), (1, high[1]), (0, low[0]))
    ]
    return Rim(
        frozen(np.concatenate(found), np.int64), frozen(np.repeat(np.arange(4), [len(f) for f in found]), np.int64)
    )


def free_rim(tessellation: Tessellation, outside: Float[np.ndarray, " n"], spacing: float, points: np.ndarray) -> Rim:
    """Return the outer vertices that none nearby exceeds towards an outline, of two along one tile's side one.

    Why not both: with whole sides of its tiles along the outline a sheet cannot open there.

    Parameters
    ----------
    tessellation : Tessellation
    outside : (n,)
        Signed distance of every vertex to the outline, positive outside.
    spacing : float
        Size of a unit cell, in the same units.
    points : (n, 2) or (n, 3)
    """
    outer = tessellation.outline
    near = cKDTree(points[outer]).query_ball_point(points[outer], 0.5 * spacing)
    most = np.array([outside[outer[k]].max() for k in near])
    is_tip = np.zeros(tessellation.n_vertices, bool)
    is_tip[outer[outside[outer] >= most - LEVEL * spacing]] = True
    edges = tessellation.tiles.edges
    edges = edges[is_tip[edges].all(axis=1)]
    # from the outermost on: whoever has a tip next to it along a side is none
    for k in np.argsort(-outside[edges].max(axis=1), kind="stable"):
        if is_tip[edges[k]].all():
            is_tip[edges[k, int(outside[edges[k]].argmin())]] = False
    tips = np.flatnonzero(is_tip)
    return Rim(frozen(tips, np.int64), frozen(np.full(len(tips), -1), np.int64))


def cell_size(tessellation: Tessellation, points: Float[np.ndarray, "n d"]) -> float:
    """Return the size of a unit cell: that of the standard layout, at the scale of the points' tile edges."""
    cells = len(np.unique(tessellation.cells[:, :2], axis=0))
    low, high = tessellation.deployed.min(axis=0), tessellation.deployed.max(axis=0)
    ends = tessellation.tiles.edges
    lengths = [
        np.median(np.linalg.norm(p[ends[:, 1]] - p[ends[:, 0]], axis=1)) for p in (points, tessellation.deployed)
    ]
    columns, rows = np.ptp(tessellation.cells[:, :2], axis=0) + 1
    filled = cells / (columns * rows)
    return float(np.sqrt(filled * np.prod(high - low) / cells) * lengths[0] / lengths[1])
