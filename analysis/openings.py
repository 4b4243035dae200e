"""Designed openings: holes that a pattern keeps when it is contracted, as hexagon patterns do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from analysis import polygons
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class DesignedOpenings:
    """How well every designed opening closes.

    Attributes
    ----------
    angle_residuals : (o,), radians
        Deployed tile angles round an opening with m sides minus (m + 2) pi (8 pi for a hexagon).
    gaps : (o,), units
        Distance from the end to the beginning of the chain of its m sides, with deployed lengths, turned by
        the angles that the tiles leave free; the largest over the corners at which the chain can begin.
    area : float, squared units
        Of all of them together, contracted.
    vertices : (o,)
        One deployed vertex of each.
    """

    angle_residuals: Float[np.ndarray, " o"]
    gaps: Float[np.ndarray, " o"]
    area: float
    vertices: Int[np.ndarray, " o"]


def find_openings(points: Float[np.ndarray, "n 3"], tessellation: Tessellation) -> DesignedOpenings:
    """Return the designed openings of a sheet: inner boundary loops of a contracted sheet that has no ring.

    A pattern with rings (quad, kagome) closes completely: what stays open in it is a gap, not a design.
    """
    loops = _inner_loops(tessellation) if not len(tessellation.rings) else []
    tiles: Loops = tessellation.tiles
    start, end = tiles.indices, tiles.successors
    filled = np.bincount(tessellation.weld[start], polygons.corner_angles(points, tiles), tessellation.n_welded)
    lengths = polygons.edge_lengths(points, tiles)
    angle, gaps, area = [], [], 0.0
    for loop in loops:
        at = filled[tessellation.weld[end[loop]]]
        angle.append(float(at.sum() - (len(loop) + 2) * np.pi))
        # with the tiles on the left, the side turns at a corner by pi minus the filled angle
        turns = np.cumsum(np.pi - at)
        sides = lengths[loop] * np.exp(1j * np.r_[0.0, turns[:-1]])
        # begun at side k, the sides before it come last, turned by the whole turn
        before = np.r_[0.0, np.cumsum(sides)[:-1]]
        gaps.append(float(np.abs(sides.sum() - before + np.exp(1j * turns[-1]) * before).max()))
        area += abs(_signed_area(tessellation.contracted[start[loop]]))
    first = np.array([start[loop[0]] for loop in loops], np.int64)
    return DesignedOpenings(np.array(angle, float), np.array(gaps, float), area, first)


def _inner_loops(tessellation: Tessellation) -> list[np.ndarray]:
    """Boundary loops of the contracted sheet as positions of half-edges, the outer (largest) one left out."""
    weld, tiles = tessellation.weld, tessellation.tiles
    start, end = weld[tiles.indices], weld[tiles.successors]
    n = tessellation.n_welded
    rim = np.flatnonzero(~np.isin(start * n + end, end * n + start))
    following = dict(zip(start[rim].tolist(), rim.tolist(), strict=True))
    loops, areas = [], []
    while following:
        path, here = [], next(iter(following))
        while here in following:
            path.append(following.pop(here))
            here = int(end[path[-1]])
        loops.append(np.array(path))
        areas.append(abs(_signed_area(tessellation.contracted[tiles.indices[path]])))
    outer = int(np.argmax(areas)) if areas else 0
    return [loop for k, loop in enumerate(loops) if k != outer]


def _signed_area(polygon: np.ndarray) -> float:
    x, y = (polygon - polygon[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
