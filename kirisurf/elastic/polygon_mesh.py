"""Triangles that fill a polygon, in graded sizes, with the polygon's own points on its boundary and no others."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Float, Int
from scipy.spatial import Delaunay, cKDTree

from kirisurf.elastic.grading import Grading
from kirisurf.errors import UnusableError

_ROUNDS = 8  # of smoothing; the worst angle hardly changes afterwards
_CLEAR = 0.55  # of the wanted length: how near a point may lie to the boundary, or to another point
_EXPECTED = "expected a simple polygon without spikes, to be filled with triangles, got one that they do not fill"
_FEW = 1000  # lattice points that are quicker all made than searched for round every fine place
_SLIVER = 1e-9  # area over the squared longest side below which a triangle is rounding


def polygon_mesh(
    boundary: Float[np.ndarray, "b 2"], grading: Grading
) -> tuple[Float[np.ndarray, "n 2"], Int[np.ndarray, "m 3"]]:
    """Fill a simple polygon with triangles.

    Points of hexagonal lattices, each of the spacing that is wanted where it lies, are triangulated (Delaunay), and
    moved to the weighted mean of the triangles round them, a few times over.

    Parameters
    ----------
    boundary : (b, 2)
        Counter-clockwise, already divided; its points stay as they are.
    grading : Grading

    Returns
    -------
    points : (n, 2)
        Those of the boundary first.
    triangles : (m, 3) int
        Counter-clockwise.

    Raises
    ------
    UnusableError
        Where the triangles do not fill the polygon: it crosses itself, or has a spike.
    """
    shape = shapely.Polygon(boundary)
    if not shape.is_valid or not shape.area > _SLIVER * shape.length**2:
        raise UnusableError(_EXPECTED)
    grading = grading.near(boundary)
    inner = _lattices(shape, boundary, grading)
    b = len(boundary)
    for _ in range(_ROUNDS):
        points = np.concatenate([boundary, inner])
        triangles = _filling(points, shape)
        corner = points[triangles]
        center = corner.mean(axis=1)
        weight = np.abs(_doubled_areas(corner)) / grading.sizes(center) ** 3
        total = np.bincount(triangles.ravel(), np.repeat(weight, 3), len(points))
        mean = [np.bincount(triangles.ravel(), np.repeat(weight * c, 3), len(points)) for c in center.T]
        held = total[b:] > 0
        inner = (np.stack(mean, axis=1)[b:][held]) / total[b:][held, None]
    points = np.concatenate([boundary, inner])
    triangles = _filling(points, shape)
    _check(points, triangles, shape, b)
    return points, triangles


def _lattices(shape: shapely.Polygon, boundary: np.ndarray, grading: Grading) -> np.ndarray:
    """Points inside, each on the lattice of the level that is wanted there, the finest first."""
    low, high = boundary.min(axis=0), boundary.max(axis=0)
    finest = float(min(grading.sizes(boundary).min(), np.linalg.norm(high - low)))
    levels = max(1, int(np.ceil(2 * np.log2(grading.coarsest / finest))) + 1)
    shapely.prepare(shape)
    ring = shapely.LinearRing(boundary)
    found = np.zeros((0, 2))
    for level in range(levels):
        spacing = min(finest * 2 ** (0.5 * level), grading.coarsest)
        last = level == levels - 1
        grid = _lattice(low, high, spacing, None if last else grading)
        wanted = grading.sizes(grid)
        grid = grid[(wanted >= spacing * 0.999) & (last | (wanted < spacing * np.sqrt(2)))]
        grid = grid[shapely.contains_xy(shape, grid)]
        near = shapely.distance(shapely.points(grid), ring) < _CLEAR * grading.sizes(grid)
        grid = grid[~near]
        if len(found) and len(grid):
            apart = cKDTree(found).query(grid)[0]
            grid = grid[apart >= _CLEAR * grading.sizes(grid)]
        found = np.concatenate([found, grid])
    return found


def _lattice(low: np.ndarray, high: np.ndarray, spacing: float, grading: Grading | None) -> np.ndarray:
    """Points of one hexagonal lattice over a box; with a grading, those as near to its places as it wants them."""
    steps = np.array([spacing, spacing * np.sqrt(0.75)])
    if grading is None or np.prod((high - low) / steps) < _FEW:
        boxes = np.stack([low, high])[None]
    else:
        reach = np.maximum((np.sqrt(2) * spacing - grading.finest) / grading.growth, 0.0)[:, None]
        boxes = np.stack([np.maximum(grading.places - reach, low), np.minimum(grading.places + reach, high)], axis=1)
        boxes = boxes[(boxes[:, 0] < boxes[:, 1]).all(axis=1)]
    found = [np.zeros((0, 2), np.int64)]
    for begin, end in boxes:
        first = np.floor((begin - low) / steps).astype(np.int64) - 1
        last = np.ceil((end - low) / steps).astype(np.int64) + 1
        column, row = np.meshgrid(np.arange(first[0], last[0]), np.arange(first[1], last[1]))
        found.append(np.stack([column.ravel(), row.ravel()], axis=1))
    number = np.unique(np.concatenate(found), axis=0)
    grid = low + number * steps
    grid[:, 0] += 0.5 * spacing * (number[:, 1] % 2)
    return grid


def _filling(points: np.ndarray, shape: shapely.Polygon) -> np.ndarray:
    """Delaunay triangles of points that lie in the polygon, counter-clockwise."""
    triangles = Delaunay(points).simplices.astype(np.int64)
    corner = points[triangles]
    doubled = _doubled_areas(corner)
    triangles[doubled < 0] = triangles[doubled < 0][:, ::-1]
    longest = np.max(np.sum((corner - np.roll(corner, 1, axis=1)) ** 2, axis=2), axis=1)
    thick = np.abs(doubled) > _SLIVER * longest
    return triangles[thick & shapely.contains_xy(shape, corner.mean(axis=1))]


def _doubled_areas(corner: np.ndarray) -> np.ndarray:
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]


def _check(points: np.ndarray, triangles: np.ndarray, shape: shapely.Polygon, b: int) -> None:
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    _, index, count = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
    outer = sides[index[count == 1]]
    area = 0.5 * float(_doubled_areas(points[triangles]).sum())
    is_boundary = len(outer) == b and ((outer[:, 1] - outer[:, 0]) % b == 1).all()
    if not is_boundary or abs(area - shape.area) > 1e-9 * shape.area:
        raise UnusableError(_EXPECTED)
