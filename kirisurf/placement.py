"""Placement: where a pattern's contracted lattice lies in the plane of a flattening, and how large it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Bool, Float

from kirisurf.errors import UnusableError
from kirisurf.flattening import Flattening
from kirisurf.trimming import overlap_fractions, sound_mask

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
    """An affine map from the contracted lattice of a quad pattern to a flattening.

    Attributes
    ----------
    matrix : (2, 2)
        Image of one contracted unit (two tiles).
    origin : (2,)
        Image of the contracted origin.
    mask : (columns, rows, 4) bool
        Tiles of the pattern.
    angle : float
        Direction of the lattice in the plane, in radians, from the long side of the outline.
    overlap : float
        Area common to lattice and outline over the area of both.
    """

    matrix: Float[np.ndarray, "2 2"]
    origin: Float[np.ndarray, " 2"]
    mask: Bool[np.ndarray, "columns rows 4"]
    angle: float
    overlap: float

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
    flattening: Flattening, n_tiles: int, angle: float | None = None, tolerance: float = 0.03
) -> Placement:
    """Lay a square lattice of about `n_tiles` tiles on the flattening and trim it to the outline.

    Parameters
    ----------
    flattening : Flattening
    n_tiles : int
    angle : float, optional
        Direction of the lattice in radians from the main direction of the outline; by default the one of
        0, 45, 22.5 and 67.5 degrees whose trimmed lattice covers the outline best.
    tolerance : float
        Relative difference of the number of tiles that is good enough.

    Raises
    ------
    UnusableError
        Where no sheet of at least four tiles fits.
    """
    main = main_direction(flattening.outline)
    angles = [angle] if angle is not None else list(np.radians([0.0, 45.0, 22.5, 67.5]))
    best, best_score = None, -np.inf
    for candidate in angles:
        for offset in (0.0, 0.5):
            found = _trimmed(flattening, n_tiles, main, candidate, offset, tolerance)
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


def _trimmed(
    flattening: Flattening, n_tiles: int, main: float, angle: float, offset: float, tolerance: float
) -> Placement | None:
    """One direction and offset: the spacing is changed until the number of tiles fits."""
    outline = flattening.outline
    center = np.asarray(outline.centroid.coords[0])
    turn = main + angle
    frame = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    local = (np.asarray(outline.exterior.coords) - center) @ frame
    spacing = np.sqrt(outline.area / n_tiles)
    best: Placement | None = None
    for attempt in range(14):
        low = 2 * (np.floor((local.min(axis=0) / spacing - offset) / 2).astype(int) - 1)
        high = 2 * (np.ceil((local.max(axis=0) / spacing - offset) / 2).astype(int) + 1)
        if np.prod((high - low).astype(float)) > max(MOST_SQUARES * n_tiles, 1e4):
            return best
        i, j = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]), indexing="ij")
        corner = (np.stack([i, j], axis=-1) + offset)[..., None, :] + np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
        squares = (corner * spacing @ frame.T + center).reshape(-1, 4, 2)
        fraction = overlap_fractions(outline.simplify(FINE * spacing), squares)
        mask = sound_mask((fraction > 0.5).reshape(i.shape))
        count = int(mask.sum())
        if count >= 4:
            inside = fraction[mask.ravel()].sum() * spacing**2
            overlap = inside / (outline.area + count * spacing**2 - inside)
            tiles = np.stack([mask[0::2, 0::2], mask[1::2, 0::2], mask[0::2, 1::2], mask[1::2, 1::2]], axis=-1)
            origin = frame @ ((low + offset) * spacing) + center
            found = Placement(2 * spacing * frame, origin, tiles, angle, float(overlap))
            if best is None or abs(count - n_tiles) < abs(best.n_tiles - n_tiles):
                best = found
            if abs(count - n_tiles) <= tolerance * n_tiles:
                return found
        change = np.sqrt(max(count, 0.25 * n_tiles) / n_tiles)
        # damped later on, since the count jumps by whole rows
        spacing *= change if attempt < 6 else change ** (0.7 if attempt % 2 else 0.4)
    return best


def rectangle_placement(flattening: Flattening, columns: int, rows: int) -> Placement:
    """Lay columns x rows unit cells on a flattening to a rectangle [0, width] x [0, height].

    The lattice is stretched to the rectangle where their proportions differ by less than `MOST_UNEQUAL`, else
    it keeps its proportions and lies in the middle.
    """
    size = np.ptp(flattening.uv, axis=0)
    low = flattening.uv.min(axis=0)
    scale = size / np.array([columns, rows])
    if scale.max() > MOST_UNEQUAL * scale.min():
        scale = np.full(2, scale.min())
    scale = scale * (1 - INSET / np.array([columns, rows]))
    origin = low + 0.5 * (size - scale * np.array([columns, rows]))
    overlap = float(np.prod(scale * [columns, rows]) / np.prod(size))
    return Placement(np.diag(scale), origin, np.ones((columns, rows, 4), bool), 0.0, overlap)
