"""Polygons into triangles: a fan where that is right, cut ears where the polygon is concave."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from kirisurf.errors import UnusableError
from kirisurf.loops import Loops

_ROUNDING = 1e-10
"""Share of a polygon's area below which a triangle counts as none: straight corners stay straight when moved."""

_MOST_WORK = 3e7
"""Squared corners, summed over the polygons that ears are cut from, which their time follows: some seconds."""


def triangulated(vertices: Float[np.ndarray, "n 3"], loops: Loops) -> tuple[Int[np.ndarray, "f 3"], int]:
    """Cut polygons into triangles of the same orientation and the same vertices.

    A polygon becomes the fan of its first corner where all of the fan's triangles look the way of the
    polygon's Newell normal, else ears are cut in its mean plane. The choice does not depend on lengths,
    so that moving or scaling a surface never changes its triangles.

    Parameters
    ----------
    vertices : (n, 3), any unit
    loops : Loops
        Polygons; those with fewer than three corners give no triangle.

    Returns
    -------
    faces : (f, 3)
        In the order of the polygons.
    n_crossed : int
        Number of polygons that no triangulation fits (their sides cross); they became fans.

    Raises
    ------
    UnusableError
        Where concave polygons have so many corners that cutting them would take long.
    """
    pieces: list[np.ndarray] = []
    owners: list[np.ndarray] = []
    crossed, work = 0, 0.0
    for size, (which, corners) in loops.by_size().items():
        if size < 3:
            continue
        apex = np.broadcast_to(corners[:, :1], (len(corners), size - 2))
        fan = np.stack([apex, corners[:, 1:-1], corners[:, 2:]], axis=2)
        if size > 3:
            concave = np.flatnonzero(~_fan_fits(vertices, corners, fan))
            work += float(size) ** 2 * len(concave)
            if work > _MOST_WORK:
                raise UnusableError(
                    f"expected triangles, or polygons of some hundred corners, got {len(concave)} that are "
                    f"concave and have {size} corners: export the surface as triangles"
                )
            for row in concave:
                ears = cut_ears(vertices[corners[row]])
                if ears is None:
                    crossed += 1
                else:
                    fan[row] = corners[row][ears]
        pieces.append(fan.reshape(-1, 3))
        owners.append(np.repeat(which, size - 2))
    if not pieces:
        return np.zeros((0, 3), np.int64), 0
    order = np.argsort(np.concatenate(owners), kind="stable")
    return np.concatenate(pieces)[order], crossed


def _fan_fits(vertices: np.ndarray, corners: np.ndarray, fan: np.ndarray) -> np.ndarray:
    """Return True for every polygon whose fan's triangles all look the way of its Newell normal, (g,)."""
    p = vertices[fan] - vertices[corners[:, 0]][:, None, None, :]
    scale = np.abs(p).max(axis=(1, 2, 3), keepdims=True)
    p = p / np.where(scale > 0, scale, 1.0)
    cross = np.cross(p[:, :, 1] - p[:, :, 0], p[:, :, 2] - p[:, :, 0])
    normal = cross.sum(axis=1)  # the sum over any fan is the Newell normal
    return (np.einsum("gfi,gi->gf", cross, normal) > _ROUNDING * (normal**2).sum(axis=1)[:, None]).all(axis=1)


def cut_ears(points: Float[np.ndarray, "k 3"]) -> Int[np.ndarray, "k_minus_2 3"] | None:
    """Triangulate one polygon by cutting ears in its mean plane.

    Returns
    -------
    (k - 2, 3) corner numbers, or None where no ear is left before the end (the sides cross, or the
    polygon has no area).
    """
    p = points - points.mean(axis=0)
    p = p / (np.abs(p).max() or 1.0)
    following = np.roll(p, -1, axis=0)
    normal = np.cross(p, following).sum(axis=0)
    length = np.linalg.norm(normal)
    if not length > 1e-14:
        return None
    normal /= length
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    flat = np.stack([p @ first, p @ np.cross(normal, first)], axis=1)

    left = list(range(len(p)))
    triangles: list[tuple[int, int, int]] = []
    at = 0
    misses = 0
    while len(left) > 3:
        before, here, after = left[at - 1], left[at], left[(at + 1) % len(left)]
        if _is_ear(flat, before, here, after, left):
            triangles.append((before, here, after))
            del left[at]
            at %= len(left)
            misses = 0
        else:
            at = (at + 1) % len(left)
            misses += 1
            if misses > len(left):
                return None
    triangles.append((left[0], left[1], left[2]))
    return np.array(triangles, dtype=np.int64)


def _is_ear(flat: np.ndarray, before: int, here: int, after: int, left: list[int]) -> bool:
    a, b, c = flat[before], flat[here], flat[after]
    if not _side(a, b, c) > _ROUNDING:
        return False
    others = flat[[k for k in left if k not in (before, here, after)]]
    # A corner in the same place (where a polygon touches itself, as at a bridge to a hole) is in nobody's way.
    others = others[~((others == a) | (others == b) | (others == c)).all(axis=1)]
    sides = (_side(a, b, others), _side(b, c, others), _side(c, a, others))
    return not np.all([side >= -_ROUNDING for side in sides], axis=0).any()


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray | np.float64:
    """Twice the signed area of a, b and p: positive where p lies on the left of a -> b."""
    return (b[0] - a[0]) * (p[..., 1] - a[1]) - (b[1] - a[1]) * (p[..., 0] - a[0])
