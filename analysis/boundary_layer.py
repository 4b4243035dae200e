"""What a planar sheet leaves of its target along the outline."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float
from numpy.typing import ArrayLike

from analysis.rim import deployed_rim
from kirisurf.arrays import checked
from kirisurf.errors import UnusableError
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation

SAMPLES = 20
"""Pieces into which every side of the rim is cut to find its largest distance to the outline."""


@dataclass(frozen=True, eq=False)
class BoundaryLayer:
    """Areas over the target's area, and the gaps along its outline.

    Attributes
    ----------
    area : float
        Of the target outside tiles and closed holes; falls with the number of tiles to the power -1/2.
    outline_area : float
        Between the target's outline and the polygon through the sheet's outer vertices, on either side.
    bases, heights : (k,), units
        Of every gap between neighboring outer vertices: their distance, and the largest distance to the outline of
        a point of the rim between them (the inner end of a notch, the middle of a side).
    """

    area: float
    outline_area: float
    bases: Float[np.ndarray, " k"]
    heights: Float[np.ndarray, " k"]


def measure_boundary_layer(points: ArrayLike, tessellation: Tessellation, outline: ArrayLike) -> BoundaryLayer:
    """Measure how a planar sheet ends at the outline of its target.

    Parameters
    ----------
    points : (n, 2) or (n, 3), units
        Deployed, in the plane z = 0.
    tessellation : Tessellation
    outline : (m, 2), units
        Corners of the target's outline; the last is joined to the first.

    Raises
    ------
    UnusableError
        Where the sheet is not planar, or the outline is no simple polygon.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> low, high = pattern.deployed.min(axis=0), pattern.deployed.max(axis=0)
    >>> square = [low, [high[0], low[1]], high, [low[0], high[1]]]
    >>> round(measure_boundary_layer(pattern.deployed, pattern, square).area, 9)  # (2 n - 1) / (2 n^2) with n = 4
    0.21875
    """
    plane = _planar(points, tessellation)
    corners = checked(outline, "target outline", (None, 2))
    target = shapely.Polygon(corners) if len(corners) > 2 else shapely.Polygon()
    if not target.is_valid or not target.area > 0:
        reason = shapely.is_valid_reason(target) if len(corners) > 2 else f"{len(corners)} corners"
        raise UnusableError(f"target outline: expected a simple polygon, got {reason}")
    sheet = shapely.union_all(
        shapely.make_valid(np.concatenate([_polygons(plane, tessellation.tiles), _polygons(plane, tessellation.holes)]))
    )
    outer = tessellation.outline
    polygon = shapely.make_valid(shapely.Polygon(plane[outer])) if len(outer) > 2 else shapely.Polygon()
    paths = deployed_rim(tessellation)
    first, last = paths.indices[paths.offsets[:-1]], paths.indices[paths.offsets[1:] - 1]
    return BoundaryLayer(
        area=float((target.area - target.intersection(sheet).area) / target.area),
        outline_area=float(target.symmetric_difference(polygon).area / target.area),
        bases=np.linalg.norm(plane[last] - plane[first], axis=1),
        heights=_heights(plane, paths, target.exterior),
    )


def _planar(points: ArrayLike, tessellation: Tessellation) -> np.ndarray:
    width = np.shape(points)[1] if np.ndim(points) == 2 else 0
    space = checked(points, "deployed vertices", (tessellation.n_vertices, 2 if width == 2 else 3))
    if width == 3 and np.abs(space[:, 2]).max(initial=0.0) > 1e-9 * np.ptp(space[:, :2], axis=0).max(initial=0.0):
        raise UnusableError(
            "deployed vertices: expected a sheet in the plane z = 0 beside a target outline, "
            f"got z up to {np.abs(space[:, 2]).max():g}"
        )
    return space[:, :2]


def _polygons(plane: np.ndarray, loops: Loops) -> np.ndarray:
    result = np.full(len(loops), shapely.Polygon(), object)
    for which, indices in loops.by_size().values():
        result[which] = shapely.polygons(plane[indices])
    return result


def _heights(plane: np.ndarray, paths: Loops, curve: shapely.LinearRing) -> np.ndarray:
    """Largest distance to the curve along every path."""
    inner = np.ones(len(paths.indices), bool)
    inner[paths.offsets[1:] - 1] = False
    side = np.flatnonzero(inner)
    a, b = plane[paths.indices[side]], plane[paths.indices[side + 1]]
    t = (np.arange(SAMPLES + 1) / SAMPLES)[:, None]
    samples = a[:, None] + t * (b - a)[:, None]
    shapely.prepare(curve)
    apart = shapely.distance(shapely.points(samples), curve).max(axis=1)
    result = np.zeros(len(paths))
    np.maximum.at(result, paths.owners[side], apart)
    return result
