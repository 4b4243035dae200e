"""Whether a closed curve is simple: it must not cross or touch itself."""

from __future__ import annotations

import re

import numpy as np
import shapely
from jaxtyping import Float

from kirisurf.errors import UnusableError


def require_simple(points: Float[np.ndarray, "m 2"], name: str) -> None:
    """Raise where the closed polyline through points (m, 2) crosses or touches itself.

    Raises
    ------
    UnusableError
        Names the place.
    """
    if len(points) < 3:
        raise UnusableError(f"{name}: expected a curve round an area, got {len(points)} points")
    low = points.min(axis=0)
    size = float(np.ptp(points, axis=0).max())
    if not size > 0:
        raise UnusableError(f"{name}: expected a curve round an area, got all points in one place")
    ring = shapely.LinearRing((points - low) / size)
    if ring.is_simple:
        return
    # The reason's text holds the place: "Self-intersection[0.5 0.25]".
    reason = shapely.is_valid_reason(shapely.Polygon(ring))
    found = re.search(r"\[(\S+) (\S+)\]", reason)
    where = ""
    if found:
        x, y = low + size * np.array([float(found[1]), float(found[2])])
        where = f" at ({x:.6g}, {y:.6g})"
    raise UnusableError(f"{name}: expected a curve that does not cross itself, got one that does{where}")
