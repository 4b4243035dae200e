"""Integrals over what triangles cover on a target."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.closest import ClosestPoints

# degree 2 on a triangle: three points, equal weights
_POINTS = np.full((3, 3), 1 / 6) + np.eye(3) / 2


def integrate_covered(
    triangles: Float[np.ndarray, "m 3 3"], fronts: Float[np.ndarray, "m 3"], closest: ClosestPoints
) -> Float[np.ndarray, "3 m"]:
    """Return area, integrated K and integrated |K| of the closest-point images of triangles on a target.

    At a point x = p + d n(p), with m the unit normal of the triangle and H, K the curvatures at p, the area changes by
    the factor (m . n) / (1 - 2 d H + d^2 K), which is exact for a smooth target (Steiner). Integrated by three points
    each. What projects on the rim of an open target covers nothing.

    Parameters
    ----------
    triangles : (m, 3, 3), units
        Corners.
    fronts : (m, 3)
        A normal on the front of the sheet: triangles that face backwards count as negative.
    closest : ClosestPoints

    Returns
    -------
    (3, m)
        Areas in squared units, integrals of K and of |K| in radians.
    """
    if not len(triangles):
        return np.zeros((3, 0))
    a, b, c = np.moveaxis(triangles, 1, 0)
    vectors = 0.5 * np.cross(b - a, c - a)
    points = np.einsum("qk,mki->mqi", _POINTS, triangles)
    found = closest.project(points.reshape(-1, 3))
    normals = found.normals.reshape(points.shape)
    toward = np.where(np.einsum("mi,mqi->m", fronts, normals) < 0, -1.0, 1.0)[:, None]
    apart = points.reshape(-1, 3) - found.points
    distance = np.einsum("ni,ni->n", apart, found.normals).reshape(points.shape[:2])
    trace, gaussian = (values.reshape(distance.shape) for values in _invariants(found.shape_operators))
    spread = 1 - distance * trace + distance**2 * gaussian
    # beyond a focal point the closest-point map folds, and is none: the area there is that of the triangle
    factor = toward * np.einsum("mi,mqi->mq", vectors, normals) / np.where(spread > 0.1, spread, 1.0)
    factor = np.where(found.on_rim.reshape(distance.shape), 0.0, factor)
    return np.stack([(factor * value).sum(axis=1) for value in (1.0, gaussian, np.abs(gaussian))]) / 3


def integrate_target(closest: ClosestPoints) -> Float[np.ndarray, " 3"]:
    """Return area, integrated K and integrated |K| of a whole target: every face has the mean K of its corners."""
    surface = closest.surface
    curvature = _invariants(closest.project(surface.vertices).shape_operators)[1][surface.faces].mean(axis=1)
    return surface.face_areas @ np.stack([np.ones_like(curvature), curvature, np.abs(curvature)], axis=1)


def _invariants(operators: Float[np.ndarray, "n 3 3"]) -> tuple[np.ndarray, np.ndarray]:
    """Trace and sum of the principal minors: 2 H and K of a shape operator."""
    trace = np.einsum("nii->n", operators)
    return trace, (trace**2 - np.einsum("nij,nji->n", operators, operators)) / 2
