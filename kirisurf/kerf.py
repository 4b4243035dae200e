"""Kerf compensation: where the middle of a cut runs so that what remains has the size that was drawn.

A cutter takes away half a kerf on either side of its path and a round of the same radius beyond the path's
end. So the outline is followed half a kerf outside the sheet, a designed opening half a kerf inside the
opening, and a slit stops earlier, so that its ligament keeps its width. The middle line of a slit stays where
it is: both tiles lose half a kerf there, and no path could avoid it.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from shapely import MultiPolygon, Polygon

from kirisurf.contours import signed_area
from kirisurf.errors import ParameterError

_MITRE_LIMIT = 5.0  # of half a kerf: how far the path may run past a sharp corner
_LEAST_SINE = 0.1  # a slit that meets a line at less than 6 degrees is treated as if it did at 6
Ray = tuple[str, np.ndarray]


def clearance(direction: np.ndarray, rays: Iterable[Ray], kerf: float) -> float:
    """Return the length by which a slit must stop earlier for its ligament to keep its width.

    Half a kerf for the round end of the slit itself; where it faces a line at the angle a, (k / 2) / sin a,
    as the distance of its tip to that line grows with sin a only; twice that where the line is itself cut
    within the sheet (the outline's cut lies outside). Two tips that face each other at the angle a lose half
    a kerf each: (k / 2) / sin(a / 2).

    Parameters
    ----------
    direction : (2,)
        Unit vector from the hinge along the slit.
    rays : iterable of (kind, (2,) unit vector)
        All other lines from the hinge: slit (cut through), rim, or tip (of another slit that ends here).
    kerf : float
    """
    half, longest = 0.5 * kerf, 0.5 * kerf
    for kind, ray in rays:
        cosine = float(np.clip(direction @ ray, -1.0, 1.0))
        if kind == "tip":
            needed = half / max(np.sqrt(0.5 * (1.0 - cosine)), _LEAST_SINE)
        else:
            sine = 1.0 if cosine <= 0 else max(np.sqrt(1.0 - cosine**2), _LEAST_SINE)
            needed = (2 if kind == "slit" else 1) * half / sine
        longest = max(longest, float(needed))
    return longest


def compensated_contours(
    outline: np.ndarray, openings: Iterable[np.ndarray], kerf: float
) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Return outline and openings as the cutter follows them, half a kerf away from the sheet.

    Parameters
    ----------
    outline : (o, 2)
    openings : iterable of (k, 2)
    kerf : float
        In the units of the points; with 0 the contours come back as they are.

    Raises
    ------
    ParameterError
        Where an opening is narrower than the kerf.
    """
    openings = tuple(openings)
    if not kerf:
        return outline, openings
    outer = Polygon(outline).buffer(0.5 * kerf, join_style="mitre", mitre_limit=_MITRE_LIMIT)
    if isinstance(outer, MultiPolygon):
        outer = max(outer.geoms, key=lambda part: part.area)
    found = [_corners(ring) for ring in outer.interiors]
    for opening in openings:
        outward = 0.5 if signed_area(opening) > 0 else -0.5
        left = Polygon(opening).buffer(outward * kerf, join_style="mitre", mitre_limit=_MITRE_LIMIT)
        if left.is_empty:
            raise ParameterError(f"--kerf: expected less than the width of the designed openings, got {kerf:.6g}")
        parts = left.geoms if isinstance(left, MultiPolygon) else [left]
        found += [_corners(part.exterior)[:: int(2 * outward)] for part in parts]
    return _corners(outer.exterior), tuple(found)


def _corners(ring: object) -> np.ndarray:
    """Corners (k, 2) of a ring, counter-clockwise, from the lowest of the leftmost on."""
    corners = np.asarray(ring.coords)[:-1]  # type: ignore[attr-defined]
    if not ring.is_ccw:  # type: ignore[attr-defined]
        corners = corners[::-1]
    return np.roll(corners, -int(np.lexsort((corners[:, 1], corners[:, 0]))[0]), axis=0)
