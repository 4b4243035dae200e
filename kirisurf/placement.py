"""Placement: where a pattern's contracted lattice lies in the plane of a flattening, and how large it is."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from jaxtyping import Bool, Float

from kirisurf.errors import UnusableError
from kirisurf.flattening import Flattening
from kirisurf.regular import Regular
from kirisurf.trimming import overlap_fractions, rectangle_mask, sound_tiles
from kirisurf.unit_cell import quad_cell

CLOSE = 1e-6
"""Relative difference below which two scores are a tie: the first candidate wins, whatever the rounding."""


MOST_SQUARES = 100
"""Lattice squares that are looked at for one tile asked for; an outline that needs more is a thin strip."""

MOST_UNEQUAL = 1.25
"""Ratio of proportions up to which a fitted lattice is stretched to its rectangle."""

FINE = 0.02
"""Part of the spacing by which the outline may be simplified before squares are cut by it."""

INSET = 0.03
"""Part of a unit cell by which a fitted lattice is smaller than its rectangle.

Outer vertices would otherwise start exactly on the rim, where rounding decides between inside and outside.
"""


@dataclass(frozen=True, eq=False)
class Placement:
    """An affine map from the lattice of a pattern to a flattening.

    Attributes
    ----------
    matrix : (2, 2)
        Images of the translations to the next column (first column of the matrix) and the next row.
    origin : (2,)
        Image of the contracted origin.
    mask : (columns, rows, tiles per cell) bool
        Tiles of the pattern.
    angle : float
        Direction of the lattice in the plane, in radians, from the long side of the outline.
    overlap : float
        Area common to lattice and outline over the area of both.
    shape : (int, int) or None
        Columns and rows of a rectangular sheet; None for one that is trimmed to the outline.
    """

    matrix: Float[np.ndarray, "2 2"]
    origin: Float[np.ndarray, " 2"]
    mask: Bool[np.ndarray, "columns rows k"]
    angle: float
    overlap: float
    shape: tuple[int, int] | None = None

    @property
    def n_tiles(self) -> int:
        """Number of tiles."""
        return int(self.mask.sum())


def main_direction(outline: shapely.Polygon) -> float:
    """Direction (radians) of the long side of the smallest rectangle round an outline, the first among equals.

    The result lies in a window (of 180 degrees, of 90 for a square) whose ends are no usual angle, so that
    rounding never decides between two equal directions.
    """
    hull = np.asarray(outline.convex_hull.exterior.coords)
    step = np.diff(hull, axis=0)
    angles = np.arctan2(step[:, 1], step[:, 0])[np.linalg.norm(step, axis=1) > 1e-9 * np.sqrt(outline.area)]
    across, along = (
        hull @ np.stack([f(angles), g(angles)]) for f, g in ((np.cos, np.sin), (lambda a: -np.sin(a), np.cos))
    )
    areas = np.ptp(across, axis=0) * np.ptp(along, axis=0)
    best = np.flatnonzero(areas <= (1 + CLOSE) * areas.min())[0]
    long, short = np.ptp(across[:, best]), np.ptp(along[:, best])
    angle, period = angles[best], np.pi
    if abs(long - short) <= CLOSE * long:
        period = np.pi / 2
    elif long < short:
        angle = angle + np.pi / 2
    low = np.radians(-33.7)
    return float((angle - low) % period + low)


def trimmed_placement(
    flattening: Flattening,
    n_tiles: int,
    angle: float | None = None,
    tolerance: float = 0.03,
    regular: Regular | None = None,
) -> Placement:
    """Lay a pattern of about `n_tiles` tiles on the flattening and trim it to the outline.

    Parameters
    ----------
    flattening : Flattening
    n_tiles : int
    angle : float, optional
        Direction of the lattice in radians from the main direction of the outline; by default the one of
        :func:`directions` whose trimmed lattice covers the outline best.
    tolerance : float
        Relative difference of the number of tiles that is good enough.
    regular : Regular, optional
        The pattern; by default rotating squares.

    Raises
    ------
    UnusableError
        Where no sheet of at least four tiles fits.
    """
    regular = regular or Regular.of(quad_cell())
    main = main_direction(flattening.outline)
    angles = [angle] if angle is not None else list(np.radians(directions(regular)))
    best, best_score = None, -np.inf
    for candidate in angles:
        for offset in (0.0, 0.5):
            found = _trimmed(flattening, regular, n_tiles, main, candidate, offset, tolerance)
            if found is None:
                continue
            far = abs(found.n_tiles - n_tiles) > 2 * tolerance * n_tiles + 4
            score = found.overlap - far
            if score > best_score + CLOSE:
                best, best_score = found, score
    if best is None or best.n_tiles > 2 * n_tiles + 4:
        room = "none of at least four" if best is None else f"one of {best.n_tiles} at least"
        raise UnusableError(
            f"{flattening.surface.name}: expected room for a sheet of about {n_tiles} tiles, found {room}; "
            "the outline is too narrow for tiles of that size: ask for more tiles (--tiles), or take a wider part"
        )
    return best


def directions(regular: Regular) -> tuple[float, float, float, float]:
    """Return the directions of a lattice that are tried, in degrees: quarters of its rotational symmetry.

    Examples
    --------
    >>> directions(Regular.of(quad_cell()))
    (0.0, 45.0, 22.5, 67.5)
    """
    period = 360.0 / regular.symmetry
    return 0.0, 0.5 * period, 0.25 * period, 0.75 * period


def _trimmed(
    flattening: Flattening,
    regular: Regular,
    n_tiles: int,
    main: float,
    angle: float,
    offset: float,
    tolerance: float,
) -> Placement | None:
    """One direction and offset: the spacing is changed until the number of tiles fits."""
    outline, motion = flattening.outline, regular.motion
    center = np.asarray(outline.centroid.coords[0])
    turn = main + angle
    frame = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    shape = regular.lattice
    local = (np.asarray(outline.exterior.coords) - center) @ frame @ np.linalg.inv(shape)
    share = regular.shares
    per_cell = len(share)
    # the side of a square that has the area of a tile
    spacing = np.sqrt(outline.area / n_tiles)
    best: Placement | None = None
    for attempt in range(14):
        side = np.sqrt(per_cell) * spacing
        start = np.full(2, offset / np.sqrt(per_cell))
        low = np.floor(local.min(axis=0) / side - start).astype(int) - 1
        high = np.ceil(local.max(axis=0) / side - start).astype(int) + 1
        if per_cell * np.prod((high - low).astype(float)) > max(MOST_SQUARES * n_tiles, 1e4):
            return best
        matrix = side * frame @ shape.T
        origin = matrix @ (low + start) + center
        box = np.ones((*(high - low), per_cell), bool)
        corners, tiles = regular.contracted(np.argwhere(box))
        fraction = overlap_fractions(outline.simplify(FINE * spacing), corners @ matrix.T + origin, tiles)
        fraction = fraction.reshape(box.shape)
        mask = sound_tiles(fraction > 0.5, motion.adjacency)
        count = int(mask.sum())
        if count >= 4:
            area = share * side**2
            inside = float((fraction * mask @ area).sum())
            overlap = inside / (outline.area + float((mask @ area).sum()) - inside)
            found = Placement(matrix, origin, mask, angle, overlap)
            if best is None or abs(count - n_tiles) < abs(best.n_tiles - n_tiles):
                best = found
            if abs(count - n_tiles) <= tolerance * n_tiles:
                return found
        change = np.sqrt(max(count, 0.25 * n_tiles) / n_tiles)
        # damped later on, since the count jumps by whole rows
        spacing *= change if attempt < 6 else change ** (0.7 if attempt % 2 else 0.4)
    return best


def rectangle_placement(
    flattening: Flattening,
    columns: int,
    rows: int,
    regular: Regular | None = None,
    most_unequal: float = MOST_UNEQUAL,
) -> Placement:
    """Lay columns x rows unit cells on a flattening to a rectangle [0, width] x [0, height].

    The rectangle round the deployed pattern is stretched to that of the flattening where their proportions differ by
    no more than `most_unequal`, else it keeps its proportions and lies in the middle; 1 is a similarity.
    """
    regular = regular or Regular.of(quad_cell())
    mask = rectangle_mask(regular.motion.cell, regular.motion.adjacency, columns, rows)
    first, extent = regular.box(mask)
    size = np.ptp(flattening.uv, axis=0)
    low = flattening.uv.min(axis=0)
    scale = size / extent
    if scale.max() > most_unequal * scale.min():
        scale = np.full(2, scale.min())
    inset = INSET * np.diag(regular.lattice) / extent
    scale = scale * (1 - (inset.max() if most_unequal == 1 else inset))
    origin = low + 0.5 * (size - scale * extent) - scale * first
    overlap = float(np.prod(scale * extent) / np.prod(size))
    return Placement(np.diag(scale) @ regular.lattice.T, origin, mask, 0.0, overlap, (columns, rows))


def similar_placement(flattening: Flattening, columns: int, rows: int, regular: Regular) -> Placement:
    """Lay columns x rows unit cells undistorted over the middle of a flattening, on as much area as it has."""
    placed = rectangle_placement(flattening, columns, rows, regular, most_unequal=1.0)
    low, high = flattening.uv.min(axis=0), flattening.uv.max(axis=0)
    first, extent = regular.box(placed.mask)
    scale = float(np.sqrt(flattening.outline.area / np.prod(extent)))
    origin = 0.5 * (low + high) - scale * (first + 0.5 * extent)
    shape = shapely.box(*(origin + scale * first), *(origin + scale * (first + extent)))
    overlap = shape.intersection(flattening.outline).area / shape.union(flattening.outline).area
    return replace(placed, matrix=scale * regular.lattice.T, origin=origin, overlap=float(overlap))
