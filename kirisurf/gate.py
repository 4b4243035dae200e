"""The gate before native code: what libigl may see, checked in one place.

libigl ends the process on empty arrays, indices out of range, isolated vertices and collinear faces;
no `except` catches that. Every array of a user's passes :func:`check_native` first.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float, Int

from kirisurf.arrays import checked
from kirisurf.errors import UnusableError

LARGEST_SIZE = 1e60
SMALLEST_SIZE = 1e-60
"""Sizes (units) between which fourth powers of lengths neither overflow nor underflow."""

FARTHEST = 1e12
"""Diagonals from the origin beyond which coordinates hold less than four digits of the surface."""


def check_native(
    vertices: Float[np.ndarray, "v 3"], faces: Int[np.ndarray, "f 3"], name: str = "surface"
) -> tuple[Float[np.ndarray, "v 3"], Int[np.ndarray, "f 3"]]:
    """Return frozen, contiguous float64 and int64 arrays that native code can be given.

    Parameters
    ----------
    vertices : (v, 3), any unit
    faces : (f, 3)
    name : str
        What the arrays are, for the message.

    Raises
    ------
    UnusableError
        Where there is no face, a number is not finite or beyond the range of double squares, an index
        is out of range or repeated within a face, a vertex belongs to no face, or a face has no area.

    Examples
    --------
    >>> import numpy as np
    >>> corners, triangle = check_native(np.eye(3), np.array([[0, 1, 2]]))
    >>> triangle.dtype
    dtype('int64')
    """
    v = checked(vertices, f"vertices of {name}", (None, 3))
    f = checked(faces, f"faces of {name}", (None, 3), np.int64)
    if not len(f):
        raise UnusableError(f"{name}: expected at least one face, got none")
    check_indices(f, len(v), name)
    check_size(v, name)
    repeated = (f == np.roll(f, 1, axis=1)).any(axis=1)
    if repeated.any():
        k = int(np.flatnonzero(repeated)[0])
        raise UnusableError(f"{name}: expected three different vertices per face, got {f[k].tolist()} in face {k}")
    unused = np.bincount(f.ravel(), minlength=len(v)) == 0
    if unused.any():
        k = int(np.flatnonzero(unused)[0])
        raise UnusableError(
            f"{name}: expected every vertex in a face, got {int(unused.sum())} vertices in none, vertex {k} first"
        )
    flat = flat_faces(v, f)
    if flat.any():
        k = int(np.flatnonzero(flat)[0])
        raise UnusableError(f"{name}: expected faces with an area, got {int(flat.sum())} without, face {k} first")
    return v, f


def check_indices(faces: Int[np.ndarray, "..."], n_vertices: int, name: str) -> None:
    """Raise UnusableError where an index is negative or not below `n_vertices`."""
    if faces.size and (faces.min() < 0 or faces.max() >= n_vertices):
        wrong = int(faces.min()) if faces.min() < 0 else int(faces.max())
        raise UnusableError(f"{name}: expected vertex indices from 0 to {n_vertices - 1}, got {wrong}")


def check_size(vertices: Float[np.ndarray, "v 3"], name: str) -> None:
    """Raise UnusableError where squares of lengths would overflow, underflow or hold no digits.

    Needs finite numbers and at least one vertex.
    """
    farthest = float(np.abs(vertices).max())
    if farthest > LARGEST_SIZE:
        raise UnusableError(
            f"{name}: expected coordinates up to {LARGEST_SIZE:g}, got {farthest:g}: squared lengths would overflow. "
            "Scale the surface, or choose a larger unit"
        )
    size = float(np.ptp(vertices, axis=0).max())
    if size == 0:
        raise UnusableError(f"{name}: expected a surface with an extent, got all vertices in one place")
    if size < SMALLEST_SIZE:
        raise UnusableError(
            f"{name}: expected a surface larger than {SMALLEST_SIZE:g} units, got {size:g}: "
            "squared lengths would underflow. Scale the surface, or choose a smaller unit"
        )
    if farthest > FARTHEST * size:
        raise UnusableError(
            f"{name}: expected a surface within {FARTHEST:g} times its size of the origin, got {farthest / size:.1e}: "
            "its coordinates hold too few digits. Move it to the origin where it was made"
        )


def flat_faces(vertices: Float[np.ndarray, "v 3"], faces: Int[np.ndarray, "f 3"]) -> Bool[np.ndarray, " f"]:
    """Return True for every face whose height is within the rounding of its coordinates.

    The height is twice the area over the longest side, with the surface scaled to a unit box; the
    bound is 8 units of rounding of the largest coordinate. Slivers far thinner than any tile pass.
    """
    if not len(faces):
        return np.zeros(0, bool)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = float((high - low).max())
    if not size > 0:
        return np.ones(len(faces), bool)
    scaled = (vertices - low) / size
    rounding = 8 * np.finfo(float).eps * max(1.0, float(np.abs(vertices).max()) / size)
    a, b, c = scaled[faces[:, 0]], scaled[faces[:, 1]], scaled[faces[:, 2]]
    u, v = b - a, c - a
    longest = np.sqrt(np.max([(u**2).sum(axis=1), (v**2).sum(axis=1), ((c - b) ** 2).sum(axis=1)], axis=0))
    double_area = np.linalg.norm(np.cross(u, v), axis=1)
    return ~(double_area > rounding * longest)
