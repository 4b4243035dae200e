"""Ways to construct the patch of a hole: what of the sheet round it the patch is fitted to.

A patch is a graph over the best plane of the vertices round the hole, so that only its heights are fitted. What is
known of them stands in rows for polynomials in the plane's coordinates, scaled to [0, 1]^2.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from analysis import polygons
from analysis.bernstein import tensor_rows
from analysis.hole_sides import tiles_beyond
from analysis.patch_fitting import (
    SMOOTHING,
    SMOOTHING_OF_MANY,
    conditions,
    fitted_nets,
    net_differences,
)
from analysis.patch_frames import HoleFrames
from kirisurf.arrays import group_means
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation

FEWEST = 8
"""Vertices that a patch through the vertices of the tiles needs: six determine a quadratic, two more average. A hole
among four triangles has eight."""

BENDING = 1e-6
"""Weight of the second differences of a patch through corners alone: what they leave open bends least."""


@dataclass(frozen=True, eq=False)
class FittedHeights:
    """Control nets of the heights, and how well what they are fitted to determines them.

    Attributes
    ----------
    nets : (g, 4, 4), units
    sizes : (g,), units
        Half the side of the square that the unit square of the parameters stands for.
    conditions : (g,)
        Condition number of the monomials that must be determined: all six quadratic ones, or the three linear ones
        for a patch through corners alone; infinite where there are too few rows.
    residuals : (g,), units
        Largest distance to a vertex that was fitted.
    """

    nets: Float[np.ndarray, "g 4 4"]
    sizes: Float[np.ndarray, " g"]
    conditions: Float[np.ndarray, " g"]
    residuals: Float[np.ndarray, " g"]


def through_tiles(points: Float[np.ndarray, "n 3"], tessellation: Tessellation, frames: HoleFrames) -> FittedHeights:
    """Fit the vertices of all tiles round the hole, with a small weight on third differences."""
    return _fitted(points, frames, frames.around, None, _smoothing, FEWEST, 6)


def through_corners(points: Float[np.ndarray, "n 3"], tessellation: Tessellation, frames: HoleFrames) -> FittedHeights:
    """Fit the corners of the hole alone by the quadratic that bends least.

    Through four corners of a square that is the bilinear patch: whatever the surface, its Gaussian curvature is not
    positive, since the corners of a square cannot tell a bowl from a plane.
    """
    penalty = np.concatenate([net_differences(3), np.sqrt(BENDING) * net_differences(2)])
    return _fitted(points, frames, tessellation.holes, None, lambda size: penalty, 3, 3)


def through_corners_and_normals(
    points: Float[np.ndarray, "n 3"], tessellation: Tessellation, frames: HoleFrames
) -> FittedHeights:
    """Fit the corners of the hole, and in each where two tiles meet the normal between theirs.

    The normal is interpolated between the centers of the two tiles by their distances from the corner. A corner that
    is one of a single tile, beside a designed opening, has its place alone: the tile's normal is not that of the
    surface there.
    """
    holes, tiles = tessellation.holes, tessellation.tiles
    beyond = tiles_beyond(tessellation)
    before = beyond[polygons.before(holes)]
    middles = group_means(points[tiles.indices], tiles.owners, len(tiles))
    corner, normals = points[holes.indices], polygons.normals(points, tiles)
    far, near = (np.linalg.norm(corner - middles[tile], axis=1)[:, None] for tile in (beyond, before))
    normal = np.einsum("sij,sj->si", frames.axes[holes.owners], near * normals[beyond] + far * normals[before])
    # a tile that stands across the plane has no slope; the hole is flagged
    slopes = -normal[:, :2] / np.where(np.abs(normal[:, 2:]) > 1e-9 * (far + near), normal[:, 2:], 1.0)
    slopes[beyond == before] = np.nan
    return _fitted(points, frames, holes, slopes, _smoothing, 3, 6)


Construct = Callable[[np.ndarray, Tessellation, HoleFrames], FittedHeights]
BY_NAME: dict[str, Construct] = {
    "tiles": through_tiles,
    "corners": through_corners,
    "corners_and_normals": through_corners_and_normals,
}
CONSTRUCTIONS = tuple(BY_NAME)
"""Names of all constructions; the first is the default."""


def _smoothing(size: int) -> np.ndarray:
    return np.sqrt(SMOOTHING_OF_MANY if size >= 16 else SMOOTHING) * net_differences(3)


def _fitted(
    points: np.ndarray,
    frames: HoleFrames,
    loops: Loops,
    slopes: np.ndarray | None,
    penalty: Callable[[int], np.ndarray],
    fewest: int,
    monomials: int,
) -> FittedHeights:
    """Least squares of heights, and slopes (s, 2) that are not NaN, at the vertices that every hole's loop names."""
    g, local = len(loops), frames.local(points, loops)
    size = np.zeros(g)
    np.maximum.at(size, loops.owners, np.abs(local[:, :2]).max(axis=1, initial=0.0))
    size = np.where(size > 0, size, 1.0)
    place = local[:, :2] / size[loops.owners, None]
    nets, condition, residual = np.zeros((g, 16)), np.full(g, np.inf), np.zeros(g)
    for count, (which, _) in loops.by_size().items():
        at = loops.offsets[which, None] + np.arange(count)
        x, y = np.moveaxis(place[at], -1, 0)
        height = local[at, 2]
        u, v = (1 + x) / 2, (1 + y) / 2
        rows, values = [tensor_rows(u, v)], [height]
        powers = [_monomials(x, y)]
        if slopes is not None:
            # by the radius of the hole, so that slopes weigh as much as the heights that they make
            radius = np.sqrt((x**2 + y**2).mean(axis=1))[:, None, None]
            given = np.where(np.isnan(slopes[at][..., :1]), 0.0, radius)
            rows += [given / 2 * tensor_rows(u, v, 1, 0), given / 2 * tensor_rows(u, v, 0, 1)]
            values += [given[..., 0] * size[which, None] * np.nan_to_num(slopes[at, k]) for k in range(2)]
            powers += [given * part for part in _monomial_slopes(x, y)]
        fitted = fitted_nets(np.concatenate(rows, axis=1), np.concatenate(values, axis=1)[..., None], penalty(count))
        nets[which] = fitted[..., 0]
        residual[which] = np.abs((rows[0] @ fitted)[..., 0] - height).max(axis=1, initial=0.0)
        if count >= fewest:
            condition[which] = conditions(np.concatenate(powers, axis=1)[..., :monomials])
    return FittedHeights(nets.reshape(g, 4, 4), size, condition, residual)


def _monomials(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)


def _monomial_slopes(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    zero, one = np.zeros_like(x), np.ones_like(x)
    return np.stack([zero, one, zero, 2 * x, y, zero], axis=-1), np.stack([zero, zero, one, zero, x, 2 * y], axis=-1)
