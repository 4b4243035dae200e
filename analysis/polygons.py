"""Polygons in space: normals, corner angles, areas, edges, triangles, vectorized by polygon size."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from kirisurf.loops import Loops


def newell(polygons: Float[np.ndarray, "g k 3"]) -> Float[np.ndarray, "g 3"]:
    """Return the area vectors of closed polygons: 1/2 sum p_i x p_(i+1), the area times the unit normal.

    Parameters
    ----------
    polygons : (g, k, 3), units

    Returns
    -------
    (g, 3), squared units
    """
    relative = polygons - polygons[:, :1]
    return 0.5 * np.cross(relative, np.roll(relative, -1, axis=1)).sum(axis=1)


def unit(vectors: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
    """Return vectors divided by their length; zero vectors stay zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)


def normals(points: Float[np.ndarray, "n 3"], loops: Loops) -> Float[np.ndarray, "t 3"]:
    """Return the unit normal of every loop (Newell), zero for a loop without area."""
    return unit(area_vectors(points, loops))


def area_vectors(points: Float[np.ndarray, "n 3"], loops: Loops) -> Float[np.ndarray, "t 3"]:
    """Return the area vector of every loop, squared units."""
    result = np.zeros((len(loops), 3))
    for which, indices in loops.by_size().values():
        result[which] = newell(points[indices])
    return result


def corner_angles(points: Float[np.ndarray, "n 3"], loops: Loops) -> Float[np.ndarray, " s"]:
    """Return the interior angle at every corner, in the order of `loops.indices`, in [0, 2 pi).

    The angle at p with successor q and predecessor r is atan2(n.(u x v), u.v) mod 2 pi with u = q - p,
    v = r - p and n the polygon's unit normal, so that reflex corners count as what they are.
    """
    result = np.zeros(len(loops.indices))
    for which, indices in loops.by_size().values():
        polygon = points[indices]
        u = np.roll(polygon, -1, axis=1) - polygon
        v = np.roll(polygon, 1, axis=1) - polygon
        n = unit(newell(polygon))
        sine = np.einsum("gi,gki->gk", n, np.cross(u, v))
        angle = np.arctan2(sine, np.einsum("gki,gki->gk", u, v))
        place = loops.offsets[which, None] + np.arange(indices.shape[1])
        result[place] = np.mod(angle, 2 * np.pi)
    return result


def angles_in_space(
    points: Float[np.ndarray, "n 3"], loops: Loops, fronts: Float[np.ndarray, "s 3"]
) -> Float[np.ndarray, " s"]:
    """Return the angle between the two sides at every corner, in the order of `loops.indices`, also of skew polygons.

    With u, v the sides to the next and from the previous corner, it is the angle between u and v, counted from u to v
    about `fronts`: between -pi/4, where the sides cross a little, and 7 pi/4, where the corner is reflex.

    Parameters
    ----------
    points : (n, 3), units
    loops : Loops
    fronts : (s, 3)
        A normal at every corner; only the side matters to which it points.
    """
    here = points[loops.indices]
    u, v = points[loops.successors] - here, here[before(loops)] - here
    cross = np.cross(u, v)
    side = np.where(np.einsum("si,si->s", cross, fronts) < 0, -1.0, 1.0)
    angle = side * np.arctan2(np.linalg.norm(cross, axis=1), np.einsum("si,si->s", u, v))
    return np.where(angle < -np.pi / 4, angle + 2 * np.pi, angle)


def before(loops: Loops) -> Int[np.ndarray, " s"]:
    """Return the position in `loops.indices` of the entry before every entry of its loop."""
    position = np.arange(len(loops.indices)) - 1
    full = loops.sizes > 0
    position[loops.offsets[:-1][full]] = loops.offsets[1:][full] - 1
    return position


def edge_lengths(points: Float[np.ndarray, "n d"], loops: Loops) -> Float[np.ndarray, " s"]:
    """Return the length of the edge that starts at every entry of `loops.indices`, in units."""
    return np.linalg.norm(points[loops.successors] - points[loops.indices], axis=1)


def triangles(points: Float[np.ndarray, "n 3"], loops: Loops) -> tuple[Int[np.ndarray, "m 3"], Int[np.ndarray, " m"]]:
    """Cut every loop into triangles of its own vertices.

    Convex polygons are cut into a fan; a polygon with a reflex corner is cut ear by ear, so that no
    triangle lies outside it.

    Returns
    -------
    triangles : (m, 3) int
    owners : (m,) int
        Loop that every triangle belongs to.
    """
    angle = corner_angles(points, loops)
    reflex = np.zeros(len(loops), bool)
    np.logical_or.at(reflex, loops.owners, angle > np.pi * (1 + 1e-12))
    pieces, owners = [np.zeros((0, 3), np.int64)], [np.zeros(0, np.int64)]
    for size, (which, indices) in loops.by_size().items():
        convex = ~reflex[which]
        for k in range(1, size - 1):
            pieces.append(indices[convex][:, [0, k, k + 1]])
            owners.append(which[convex])
        for number, loop in zip(which[~convex], indices[~convex], strict=True):
            ears = _ears(points[loop])
            pieces.append(loop[ears])
            owners.append(np.full(len(ears), number))
    return np.concatenate(pieces), np.concatenate(owners)


def _ears(polygon: np.ndarray) -> np.ndarray:
    """Cut one polygon (k, 3) into k - 2 triangles by removing ears, best-shaped ear first."""
    flat = flattened(polygon)
    left = list(range(len(flat)))
    found = []
    while len(left) > 3:
        best, quality = 0, -np.inf
        for i in range(len(left)):
            a, b, c = flat[left[i - 1]], flat[left[i]], flat[left[(i + 1) % len(left)]]
            others = flat[[j for j in left if j not in (left[i - 1], left[i], left[(i + 1) % len(left)])]]
            area = _cross2(b - a, c - a)
            inside = (
                (_cross2(b - a, others - a) > 0) & (_cross2(c - b, others - b) > 0) & (_cross2(a - c, others - c) > 0)
            )
            longest = max(((b - a) ** 2).sum(), ((c - b) ** 2).sum(), ((a - c) ** 2).sum())
            value = area / max(longest, 1e-300) - 10.0 * inside.any()
            if value > quality:
                best, quality = i, value
        found.append([left[best - 1], left[best], left[(best + 1) % len(left)]])
        left.pop(best)
    return np.array([*found, left])


def flattened(polygon: Float[np.ndarray, "k 3"]) -> Float[np.ndarray, "k 2"]:
    """Return a polygon's coordinates in its own plane, counter-clockwise about its Newell normal."""
    first, second = frames(unit(newell(polygon[None])))
    relative = polygon - polygon.mean(axis=0)
    return np.stack([relative @ first[0], relative @ second[0]], axis=1)


def frames(n: Float[np.ndarray, "g 3"]) -> tuple[Float[np.ndarray, "g 3"], Float[np.ndarray, "g 3"]]:
    """Return two unit vectors (g, 3) that form a right-handed frame with each unit normal."""
    axis = np.eye(3)[np.abs(n).argmin(axis=1)]
    first = unit(np.cross(n, axis))
    return first, np.cross(n, first)


def _cross2(a: np.ndarray, b: np.ndarray) -> np.ndarray | np.floating:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
