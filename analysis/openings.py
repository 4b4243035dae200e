"""Designed openings: what a pattern keeps open when it is contracted, as hexagon patterns do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from analysis import polygons
from analysis.rim import contracted_rim
from kirisurf.tessellation import Tessellation

REPEATS = 4
"""Openings with equally many sides that make a design of them in a sheet that also closes round inner points."""


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


def find_openings(
    points: Float[np.ndarray, "n 3"], tessellation: Tessellation, designed: bool | None = None
) -> DesignedOpenings:
    """Return the designed openings of a sheet: inner boundary curves of the contracted sheet.

    The points alone do not tell a design from a fault, a tile that is missing say. Unless it is told, the judge
    takes as designed all that stays open in a sheet without inner points that tiles close round (hexagons), and in
    one with such points (quads, kagome) what is repeated: at least `REPEATS` openings with equally many sides.

    Parameters
    ----------
    points : (n, 3), units
        Deployed.
    tessellation : Tessellation
    designed : bool, optional
        Whether what stays open is meant to: none of it is where False.
    """
    tiles = tessellation.tiles
    start = tiles.indices
    curves, angles = contracted_rim(points, tessellation)
    lengths = polygons.edge_lengths(points, tiles)
    loops = [loop for loop in curves if np.sum(np.pi - angles[loop]) < 0]
    if designed is None and len(tessellation.rings):
        sizes = [len(loop) for loop in loops]
        loops = [loop for loop in loops if sizes.count(len(loop)) >= REPEATS]
    elif designed is False:
        loops = []
    residual, gaps, area = [], [], 0.0
    for loop in loops:
        at = angles[loop]
        residual.append(float(at.sum() - (len(loop) + 2) * np.pi))
        # with the tiles on the left, the side turns at a corner by pi minus the filled angle
        turns = np.cumsum(np.pi - at)
        sides = lengths[loop] * np.exp(1j * np.r_[0.0, turns[:-1]])
        # begun at side k, the sides before it come last, turned by the whole turn
        before = np.r_[0.0, np.cumsum(sides)[:-1]]
        gaps.append(float(np.abs(sides.sum() - before + np.exp(1j * turns[-1]) * before).max()))
        area += abs(_signed_area(tessellation.contracted[start[loop]]))
    first = np.array([start[loop[0]] for loop in loops], np.int64)
    return DesignedOpenings(np.array(residual, float), np.array(gaps, float), area, first)


def _signed_area(polygon: np.ndarray) -> float:
    x, y = (polygon - polygon[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
