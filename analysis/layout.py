"""The contracted layout: overlap, gaps and designed openings of the flat sheet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float, Int

from analysis import polygons
from kirisurf.loops import Loops


@dataclass(frozen=True, eq=False)
class Layout:
    """What the contracted tiles cover.

    Attributes
    ----------
    area : float
        Sum of the tiles' areas, squared units.
    overlap, gap : float or None
        Area covered twice, and area inside the outline that no tile covers, over `area`; None where a tile
        is no simple polygon.
    overlapping : (x, 2) int
        Pairs of tiles that overlap, largest overlap first.
    gap_place : (2,), units
        Inside the largest gap; the origin where there is none.
    flipped : (f,) int
        Tiles of the wrong orientation.
    broken : (b,) int
        Tiles that are no simple polygons.
    """

    area: float
    overlap: float | None
    gap: float | None
    overlapping: Int[np.ndarray, "x 2"]
    gap_place: Float[np.ndarray, "2"]
    flipped: Int[np.ndarray, " f"]
    broken: Int[np.ndarray, " b"]


def measure_layout(plane: Float[np.ndarray, "n 2"], tiles: Loops, weld: Int[np.ndarray, " n"] | None) -> Layout:
    """Measure overlap and gaps of the contracted tiles.

    For the gap, copies of a welded vertex that lie closer than 1e-6 edges to their mean are moved there first,
    so that cracks of rounding size do not show; for the overlap nothing is moved.

    Parameters
    ----------
    plane : (n, 2), units
        Most tiles counter-clockwise.
    tiles : Loops
    weld : (n,) int or None
    """
    signed = polygons.area_vectors(np.c_[plane, np.zeros(len(plane))], tiles)[:, 2]
    shapes = _shapes(plane, tiles)
    broken = np.flatnonzero(~shapely.is_valid(shapes))
    area = float(np.abs(signed).sum())
    flipped = np.flatnonzero(~(signed > 0))
    if len(broken) or not area > 0:
        return Layout(area, None, None, np.zeros((0, 2), np.int64), np.zeros(2), flipped, broken)

    pairs, common = _common_areas(plane, tiles, shapes)
    overlapping = pairs[common > 1e-9 * area / len(tiles)]
    welded = plane if weld is None else _with_copies_joined(plane, weld, 1e-6 * np.sqrt(area / len(tiles)))
    dissolved = _shapes(welded, tiles)
    union = shapely.union_all(dissolved) if common.sum() > 1e-9 * area else shapely.coverage_union_all(dissolved)
    inner = [ring for part in shapely.get_parts(union) for ring in part.interiors]
    gaps = np.array([shapely.Polygon(r).area for r in inner])
    place = np.zeros(2)
    if len(gaps):
        point = shapely.Polygon(inner[int(gaps.argmax())]).representative_point()
        place = np.array([point.x, point.y])
    return Layout(area, float(common.sum() / area), float(gaps.sum() / area), overlapping, place, flipped, broken)


def overlapping_tiles(plane: Float[np.ndarray, "n 2"], tiles: Loops) -> Int[np.ndarray, "m 2"]:
    """Return the pairs of tiles of a layout that overlap, the worst first; a tile that crosses itself with itself."""
    shapes = _shapes(plane, tiles)
    broken = np.flatnonzero(~shapely.is_valid(shapes))
    if len(broken):
        return np.repeat(broken[:, None], 2, axis=1)
    pairs, common = _common_areas(plane, tiles, shapes)
    return pairs[common > 1e-9 * shapely.area(shapes).sum() / len(tiles)]


def _common_areas(plane: np.ndarray, tiles: Loops, shapes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of tiles that may overlap, and their common areas, largest first."""
    pairs = _touching(plane, tiles, shapes)
    common = shapely.area(shapely.intersection(shapes[pairs[:, 0]], shapes[pairs[:, 1]]))
    order = np.argsort(-common, kind="stable")
    return pairs[order], common[order]


def _shapes(plane: np.ndarray, tiles: Loops) -> np.ndarray:
    """The tiles as shapely polygons, (t,) objects."""
    rings = shapely.linearrings(
        plane[np.insert(tiles.indices, tiles.offsets[1:], tiles.indices[tiles.offsets[:-1]])],
        indices=np.repeat(np.arange(len(tiles)), tiles.sizes + 1),
    )
    return shapely.polygons(rings)


def _touching(plane: np.ndarray, tiles: Loops, shapes: np.ndarray) -> np.ndarray:
    """Pairs of tiles that may overlap: boxes meet, and no edge of a convex one has the other on its outer side."""
    i, j = shapely.STRtree(shapes).query(shapes)
    pairs = np.stack([i, j], axis=1)[i != j].astype(np.int64)
    size = float(np.ptp(plane, axis=0).max())
    apart = np.zeros(len(pairs), bool)
    for k in np.unique(tiles.sizes):
        for m in np.unique(tiles.sizes):
            which = np.flatnonzero((tiles.sizes[pairs[:, 0]] == k) & (tiles.sizes[pairs[:, 1]] == m))
            a = plane[tiles.indices[tiles.offsets[pairs[which, 0], None] + np.arange(k)]]
            b = plane[tiles.indices[tiles.offsets[pairs[which, 1], None] + np.arange(m)]]
            along = np.roll(a, -1, axis=1) - a
            along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-300)

            def side(q: np.ndarray, a: np.ndarray = a, along: np.ndarray = along) -> np.ndarray:
                relative = q[:, None] - a[:, :, None]
                return along[:, :, None, 0] * relative[..., 1] - along[:, :, None, 1] * relative[..., 0]

            own, other = side(a).min(axis=2), side(b).max(axis=2)
            apart[which] = ((own > -1e-14 * size) & (other < 1e-14 * size)).any(axis=1)
    key = np.sort(pairs, axis=1) @ np.array([len(tiles), 1])
    separated = np.unique(key[apart])
    keep = (pairs[:, 0] < pairs[:, 1]) & ~np.isin(key, separated)
    return pairs[keep]


def _with_copies_joined(plane: np.ndarray, weld: np.ndarray, near: float) -> np.ndarray:
    labels = np.unique(weld, return_inverse=True)[1].ravel()
    counts = np.bincount(labels)
    means = np.stack([np.bincount(labels, plane[:, i]) / counts for i in range(2)], axis=1)[labels]
    apart = np.zeros(len(counts))
    np.maximum.at(apart, labels, np.linalg.norm(plane - means, axis=1))
    return np.where((apart <= near)[labels, None], means, plane)
