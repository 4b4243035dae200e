"""How far a sheet opens: enclosed areas, porosity and magnification."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial.distance import cdist

from analysis import polygons
from analysis.rim import contracted_rim, deployed_rim, partners
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True)
class Openness:
    """Areas of both states in squared units, and what follows from them.

    Attributes
    ----------
    tiles, holes, notches : float
        Deployed area of the tiles, of the closed holes as they are filled, and between notches of the rim and the
        straight lines across their mouths.
    contracted : float
        Area inside the contracted outline, designed openings included.
    extents : (float, float)
        Largest distance of two vertices, deployed and contracted, units.
    """

    tiles: float
    holes: float
    notches: float
    contracted: float
    extents: tuple[float, float]

    @property
    def enclosed(self) -> float:
        """Deployed area inside the outline: tiles + holes + notches."""
        return self.tiles + self.holes + self.notches

    @property
    def porosity(self) -> float:
        """Holes / (tiles + holes): the open part of what tiles and closed holes cover; notches are outside."""
        return self.holes / (self.tiles + self.holes)

    @property
    def area_magnification(self) -> float:
        """Enclosed / contracted."""
        return self.enclosed / self.contracted

    @property
    def linear_magnification(self) -> float:
        """The side of a square as large as the deployed sheet over that of the contracted one."""
        return float(np.sqrt(self.area_magnification))

    @property
    def extent_magnification(self) -> float:
        """Largest distance of two vertices, deployed over contracted."""
        return self.extents[0] / self.extents[1]


def measure_openness(
    points: Float[np.ndarray, "n 3"],
    flat: Float[np.ndarray, "n d"],
    tessellation: Tessellation,
    hole_areas: Float[np.ndarray, " g"],
) -> Openness:
    """Return the areas of both states of a sheet.

    A notch of the rim counts by the length of its vector area 1/2 sum p_i x p_(i+1), which is its area in the plane.

    Parameters
    ----------
    points : (n, 3), units
        Deployed, near the origin.
    flat : (n, 2) or (n, 3), units
        Contracted.
    tessellation : Tessellation
    hole_areas : (g,), squared units
        Of the closed holes as they are filled.
    """
    tiles = tessellation.tiles
    space = np.pad(flat - flat.mean(axis=0), ((0, 0), (0, 3 - flat.shape[1])))
    outside, filled = contracted_rim(space, tessellation)
    contracted = 0.0
    for curve in outside:
        if np.sum(np.pi - filled[curve]) > 0:
            contracted += float(np.linalg.norm(polygons.newell(space[tiles.indices[curve]][None])))
    return Openness(
        tiles=float(np.linalg.norm(polygons.area_vectors(points, tiles), axis=1).sum()),
        holes=float(np.abs(hole_areas).sum()),
        notches=float(np.linalg.norm(polygons.area_vectors(points, deployed_rim(tessellation)), axis=1).sum()),
        contracted=contracted,
        extents=(largest_distance(points), largest_distance(space)),
    )


def tile_magnification(
    points: Float[np.ndarray, "n 3"],
    flat: Float[np.ndarray, "n d"],
    tessellation: Tessellation,
    hole_areas: Float[np.ndarray, " g"],
) -> Float[np.ndarray, " t"]:
    """Return the area magnification round every tile, NaN where a side lies on the rim.

    (a + sum h/k) / (a' + sum o/m): the tile's area a deployed and a' contracted; over its sides, the area h of the
    hole there over its k sides; over its sides that stay open, the area o of the designed opening over its m sides.
    Every area is handed out once, so that means over tiles, weighted by the denominator, are ratios of areas.

    Parameters
    ----------
    points, flat, tessellation, hole_areas
        As in :func:`measure_openness`.
    """
    tiles, holes, n = tessellation.tiles, tessellation.holes, tessellation.n_vertices
    start, end = tiles.indices, tiles.successors
    key = start * n + end
    order = np.argsort(key)
    place = order[np.searchsorted(key[order], holes.successors * n + holes.indices)] if len(holes) else order[:0]
    share = np.full(len(key), np.nan)
    share[place] = (np.abs(hole_areas) / np.maximum(holes.sizes, 1))[holes.owners]

    space = np.pad(flat - flat.mean(axis=0), ((0, 0), (0, 3 - flat.shape[1])))
    kept = np.where(partners(tessellation) < 0, np.nan, 0.0)
    curves, filled = contracted_rim(space, tessellation)
    for curve in curves:
        if np.sum(np.pi - filled[curve]) < 0:
            kept[curve] = np.linalg.norm(polygons.newell(space[start[curve]][None])) / len(curve)
    first = tiles.offsets[:-1]
    deployed = np.linalg.norm(polygons.area_vectors(points, tiles), axis=1) + np.add.reduceat(share, first)
    closed = np.linalg.norm(polygons.area_vectors(space, tiles), axis=1) + np.add.reduceat(kept, first)
    return deployed / np.where(closed > 0, closed, np.nan)


def largest_distance(points: Float[np.ndarray, "n 3"]) -> float:
    """Return the largest distance of two of the points, units.

    Only points whose distance to the middle m could make it are compared: |p - m| >= d - max |q - m|, with d the
    distance of two points that are far apart.
    """
    if not len(points):
        return 0.0
    radius = np.linalg.norm(points - 0.5 * (points.min(axis=0) + points.max(axis=0)), axis=1)
    far = points[radius.argmax()]
    for _ in range(2):
        apart = np.linalg.norm(points - far, axis=1)
        far = points[apart.argmax()]
    left = points[radius >= (apart.max() - radius.max()) * (1 - 1e-9)]
    return float(max(cdist(part, left).max() for part in np.array_split(left, 1 + len(left) // 1000)))
