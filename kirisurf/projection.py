"""What a closest-point query returns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int


@dataclass(frozen=True, eq=False)
class Projection:
    """Closest points of a target for n query points.

    Attributes
    ----------
    points : (n, 3)
        Closest points on the target.
    distances : (n,)
        Euclidean distance to them.
    normals : (n, 3)
        Continuous unit normals there (interpolated vertex normals, or analytic).
    shape_operators : (n, 3, 3)
        Symmetric, S n = 0: the target is p + t + 1/2 (t.S t) n near p.
    faces : (n,)
        Mesh face of the closest point on the mesh.
    on_rim : (n,) bool
        True where the closest point lies on the rim of an open surface.
    rim_points, rim_conormals : (n, 3)
        Closest point of the rim and the outward unit conormal there (tangent to the surface, normal to
        the rim).
    """

    points: Float[np.ndarray, "n 3"]
    distances: Float[np.ndarray, " n"]
    normals: Float[np.ndarray, "n 3"]
    shape_operators: Float[np.ndarray, "n 3 3"]
    faces: Int[np.ndarray, " n"]
    on_rim: Bool[np.ndarray, " n"]
    rim_points: Float[np.ndarray, "n 3"]
    rim_conormals: Float[np.ndarray, "n 3"]
