"""Removing faces without area, without tearing the surface.

A needle (two corners in one place) can simply go. A cap (one corner on the opposite side) cannot: its
neighbor across that side would no longer meet the other two. There the shared side is flipped.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from kirisurf.gate import flat_faces

_ROUNDS = 30


def without_flat_faces(
    vertices: Float[np.ndarray, "v 3"], faces: Int[np.ndarray, "f 3"]
) -> tuple[Int[np.ndarray, "g 3"], int]:
    """Return the faces that have an area, caps flipped with their neighbors, and the number of flat ones found."""
    faces = np.array(faces)
    repeated = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    found = int(repeated.sum())
    faces = faces[~repeated]
    flat = flat_faces(vertices, faces)
    found += int(flat.sum())
    for _ in range(_ROUNDS):
        if not flat.any() or not _flip_caps(vertices, faces, flat):
            break
        flat = flat_faces(vertices, faces)
    return faces[~flat], found


def _flip_caps(vertices: np.ndarray, faces: np.ndarray, flat: np.ndarray) -> bool:
    """Flip, in place, the longest side of every flat face whose neighbor there has an area; True where any was."""
    n = len(vertices)
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.minimum(start, end) * n + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    caps = np.flatnonzero(flat)
    corners = vertices[faces[caps]]
    longest = np.argmax(((np.roll(corners, -1, axis=1) - corners) ** 2).sum(axis=2), axis=1)
    touched: set[int] = set()
    changed = False
    for cap, k in zip(caps.tolist(), longest.tolist(), strict=True):
        side = 3 * cap + k
        low, high = np.searchsorted(ordered, key[side]), np.searchsorted(ordered, key[side], side="right")
        sides = order[low:high]
        if len(sides) != 2:
            continue
        other = int(sides[0] if sides[1] == side else sides[1])
        neighbor = other // 3
        if flat[neighbor] or cap in touched or neighbor in touched:
            continue
        a, b, apex = faces[cap, k], faces[cap, (k + 1) % 3], faces[cap, (k + 2) % 3]
        c, d, far = (faces[neighbor, (other % 3 + j) % 3] for j in range(3))
        new = min(apex, far) * n + max(apex, far)
        at = np.searchsorted(ordered, new)
        if apex == far or (at < len(ordered) and ordered[at] == new) or {a, b} != {c, d}:
            continue
        # The neighbor runs c -> d: it becomes the two triangles on either side of the line apex - far.
        faces[neighbor] = (c, apex, far)
        faces[cap] = (apex, d, far)
        touched |= {cap, neighbor}
        changed = True
    return changed
