"""A round origin near a target that lies far from zero, so that map coordinates cost no digits.

At 1e6 diagonals from zero the rounding of a coordinate is 1e-10 of the diagonal: more than a certificate
of 1e-9 of a tile edge allows. Such a target is moved before anything is computed, and its files stay moved.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.surface import SmoothSurface, Surface

_FAR = 100.0  # diagonals, see the interface of the run folder


def round_origin(surface: Surface) -> Float[np.ndarray, " 3"]:
    """Return the origin (3,) to move a surface to: zero, but near the surface where that is far away.

    Only coordinates with few digits are used: multiples of a power of ten of about the diagonal.

    Examples
    --------
    >>> far = Surface.from_arrays([[5e5, 2e6, 0], [5e5 + 3, 2e6, 0], [5e5, 2e6 + 4, 0]], [[0, 1, 2]])
    >>> round_origin(far).tolist()
    [500000.0, 2000000.0, 0.0]
    """
    if not len(surface.vertices) or not surface.diagonal > 0:
        return frozen(np.zeros(3))
    center = 0.5 * (surface.vertices.min(axis=0) + surface.vertices.max(axis=0))
    if not np.linalg.norm(center) > _FAR * surface.diagonal:
        return frozen(np.zeros(3))
    digits = -math.ceil(math.log10(surface.diagonal))
    return frozen([round(float(value), digits) + 0.0 for value in center])


def moved(surface: Surface, origin: np.ndarray) -> Surface:
    """Return the surface in the frame with the given origin (3,)."""
    if not np.any(origin):
        return surface
    smooth = None if surface.smooth is None else _Moved(surface.smooth, frozen(origin), surface.smooth.formula)
    outline = None if surface.outline is None else surface.outline.moved(-np.asarray(origin)[:2])
    return replace(surface, vertices=frozen(surface.vertices - origin), smooth=smooth, outline=outline)


@dataclass(frozen=True, eq=False)
class _Moved:
    smooth: SmoothSurface
    origin: np.ndarray
    formula: str

    def project(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        places, normals, operators = self.smooth.project(points + self.origin)
        return places - self.origin, normals, operators
