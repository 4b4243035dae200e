"""Shapes of the tiles: corner angles, edges, and how alike they are."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from analysis import polygons
from kirisurf.tessellation import Tessellation


def corner_angle_range(
    points: Float[np.ndarray, "n 3"], tessellation: Tessellation
) -> tuple[Float[np.ndarray, " t"], Float[np.ndarray, " t"]]:
    """Return the smallest and the largest interior angle of every tile, radians in [0, 2 pi)."""
    angles = polygons.corner_angles(points, tessellation.tiles)
    first = tessellation.tiles.offsets[:-1]
    return np.minimum.reduceat(angles, first), np.maximum.reduceat(angles, first)


def angle_deviation(points: Float[np.ndarray, "n 3"], tessellation: Tessellation) -> Float[np.ndarray, " t"]:
    """Return the largest difference of an angle of every tile to the same one in the regular pattern, radians.

    The regular pattern is `tessellation.contracted`: squares for quad, equilateral triangles for kagome.
    """
    tiles = tessellation.tiles
    regular = polygons.corner_angles(_standard(tessellation), tiles)
    return np.maximum.reduceat(np.abs(polygons.corner_angles(points, tiles) - regular), tiles.offsets[:-1])


def smallest_edges(points: Float[np.ndarray, "n 3"], tessellation: Tessellation) -> Float[np.ndarray, " t"]:
    """Return the length of the shortest edge of every tile, units."""
    tiles = tessellation.tiles
    return np.minimum.reduceat(polygons.edge_lengths(points, tiles), tiles.offsets[:-1])


def area_spread(points: Float[np.ndarray, "n 3"], tessellation: Tessellation) -> float:
    """Return std / mean of the tiles' areas, each over that of the same tile in the regular pattern.

    Why over it: octagons and squares differ by design. Zero for any regular pattern.
    """
    tiles = tessellation.tiles
    areas, regular = (
        np.linalg.norm(polygons.area_vectors(p, tiles), axis=1) for p in (points, _standard(tessellation))
    )
    return _spread(areas, regular)


def edge_spread(points: Float[np.ndarray, "n 3"], tessellation: Tessellation) -> float:
    """Return std / mean of the tiles' edges, each over that of the same edge in the regular pattern."""
    tiles = tessellation.tiles
    return _spread(polygons.edge_lengths(points, tiles), polygons.edge_lengths(_standard(tessellation), tiles))


def _standard(tessellation: Tessellation) -> np.ndarray:
    return np.pad(tessellation.contracted, ((0, 0), (0, 1)))


def _spread(values: np.ndarray, regular: np.ndarray) -> float:
    ratio = values[regular > 0] / regular[regular > 0]
    return float(ratio.std() / ratio.mean()) if len(ratio) and ratio.mean() > 0 else float("nan")
