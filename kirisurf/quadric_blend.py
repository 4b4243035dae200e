"""The smooth surface that a mesh stands for: quadrics at its vertices, blended over its triangles."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.closest import ClosestPoints
from kirisurf.shape_operator import vertex_shape_operators
from kirisurf.surface import Surface

MOST_STEPS = 20


class QuadricBlend:
    """The zero set of f(x) = sum over the corners k of a triangle of w_k (n_k.(x - v_k) - 1/2 (x - v_k).S_k(x - v_k)).

    The triangle is the one nearest to x, w are the barycentric coordinates of the point of it nearest to x,
    and v, n, S are the positions, normals and shape operators of its corners. The surface passes through
    the vertices of the mesh; it is continuous, and smooth within every triangle.

    Parameters
    ----------
    surface : Surface
        A consistently oriented, manifold mesh.
    """

    formula = "quadrics at the vertices of the mesh, blended over its triangles"

    def __init__(self, surface: Surface) -> None:
        mesh = Surface(surface.vertices, surface.faces, surface.name)
        self._closest = ClosestPoints(mesh)
        self._mesh = mesh
        self._shape = vertex_shape_operators(mesh)
        corners = mesh.vertices[mesh.faces]
        opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
        # gradient of a barycentric coordinate: normal x opposite side / twice the area
        turned = np.cross(mesh.face_normals[:, None], opposite)
        self._weight_gradients = turned / (2 * mesh.face_areas)[:, None, None]

    def project(
        self, points: Float[np.ndarray, "n 3"]
    ) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3 3"]]:
        """Move points along the gradient to the blend of their triangle; return foot, normal, shape operator.

        The weights stay those of the point that is asked for: where the answer is the point itself, it lies
        on the surface.
        """
        faces, weights = self._closest.locate(points)
        corner = self._mesh.faces[faces]
        at, normals, shape = self._mesh.vertices[corner], self._mesh.normals[corner], self._shape[corner]
        bend = np.einsum("nk,nkij->nij", weights, shape)
        foot = np.array(points, dtype=np.float64)
        slope = np.zeros_like(foot)
        for _ in range(MOST_STEPS):
            away = foot[:, None] - at
            bent = np.einsum("nkij,nkj->nki", shape, away)
            value = np.einsum("nk,nki,nki->n", weights, away, normals - 0.5 * bent)
            slope = np.einsum("nk,nki->ni", weights, normals - bent)
            squared = np.maximum(np.einsum("ni,ni->n", slope, slope), 1e-300)
            step = (value / squared)[:, None] * slope
            foot = foot - step
            if np.abs(step).max(initial=0.0) <= 1e-15 * self._mesh.diagonal:
                break
        # the weights change along the surface too: with their gradients the normal is that of f itself
        away = foot[:, None] - at
        bent = np.einsum("nkij,nkj->nki", shape, away)
        quadrics = np.einsum("nki,nki->nk", away, normals - 0.5 * bent)
        slope = slope + np.einsum("nk,nki->ni", quadrics, self._weight_gradients[faces])
        length = np.sqrt(np.maximum(np.einsum("ni,ni->n", slope, slope), 1e-300))
        unit = slope / length[:, None]
        tangent = np.eye(3) - unit[:, :, None] * unit[:, None, :]
        return foot, unit, tangent @ (bend / length[:, None, None]) @ tangent
