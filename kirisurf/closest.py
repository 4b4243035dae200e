"""Closest points of a target: libigl's tree, continuous normals, curvature, and the rim of open surfaces."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import igl
import numpy as np
from jaxtyping import Float

from kirisurf.gate import check_native
from kirisurf.projection import Projection
from kirisurf.shape_operator import vertex_shape_operators
from kirisurf.surface import Surface


@runtime_checkable
class ClosestPointMap(Protocol):
    """Anything that projects points on a target."""

    def project(self, points: np.ndarray) -> Projection:
        """Return the closest points of the target for points (n, 3)."""
        ...


class ClosestPoints:
    """Closest points on the triangles of a surface; the tree is built once.

    Parameters
    ----------
    surface : Surface
        Consistently oriented and manifold.

    Raises
    ------
    UnusableError
        Where the arrays are not fit for native code (see :mod:`kirisurf.gate`).
    """

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        self._vertices, self._faces = check_native(surface.vertices, surface.faces, surface.name)
        self._tree = igl.AABB()
        self._tree.init(self._vertices, self._faces)
        self._shape = vertex_shape_operators(surface)
        self._rim = np.ascontiguousarray(surface.boundary_edges, dtype=np.int64)
        self._on_boundary = np.zeros(len(self._vertices), bool)
        self._on_boundary[self._rim.ravel()] = True
        self._boundary_opposite = _boundary_sides(self._faces, self._rim)
        self._rim_tree = igl.AABB()
        if len(self._rim):
            self._rim_tree.init(self._vertices, self._rim)
            self._conormals = _vertex_conormals(surface)

    def locate(self, points: Float[np.ndarray, "n 3"]) -> tuple[np.ndarray, np.ndarray]:
        """Return the face (n,) of every closest point and its barycentric coordinates (n, 3) there."""
        query = np.ascontiguousarray(points, dtype=np.float64)
        if not np.isfinite(query).all():
            raise FloatingPointError("closest points: expected finite query points")
        if not len(query):
            return np.zeros(0, np.int64), np.zeros((0, 3))
        _, faces, closest = self._tree.squared_distance(self._vertices, self._faces, query)
        faces = np.asarray(faces, np.int64).ravel()
        corners = self._vertices[self._faces[faces]]
        return faces, barycentric(closest.reshape(-1, 3), corners)

    def project(self, points: Float[np.ndarray, "n 3"]) -> Projection:
        """Return closest points with normals, shape operators and rim data.

        Normals and shape operators interpolate those of the vertices; where the surface is known by a
        formula (`surface.smooth`), points, normals and shape operators are those of the formula.
        """
        query = np.ascontiguousarray(points, dtype=np.float64)
        faces, weights = self.locate(query)
        corner = self._faces[faces]
        closest = np.einsum("nk,nki->ni", weights, self._vertices[corner])
        on_rim = ((weights < 1e-9) & self._boundary_opposite[faces]).any(axis=1)
        on_rim |= ((weights > 1 - 1e-9) & self._on_boundary[corner]).any(axis=1)
        rim_points, rim_conormals = self._project_on_rim(query)
        if self.surface.smooth is not None:
            closest, normals, shape = self.surface.smooth.project(query)
        else:
            normals = np.einsum("nk,nki->ni", weights, self.surface.normals[corner])
            length = np.linalg.norm(normals, axis=1, keepdims=True)
            # Across the edge of a fold the normals of the vertices may cancel.
            usable = length > 1e-9
            normals = np.where(usable, normals / np.where(usable, length, 1.0), self.surface.face_normals[faces])
            shape = np.einsum("nk,nkij->nij", weights, self._shape[corner])
            tangent = np.eye(3) - normals[:, :, None] * normals[:, None, :]
            shape = tangent @ shape @ tangent
        return Projection(
            points=closest,
            distances=np.linalg.norm(query - closest, axis=1),
            normals=normals,
            shape_operators=shape,
            faces=faces,
            on_rim=on_rim,
            rim_points=rim_points,
            rim_conormals=rim_conormals,
        )

    def distances(self, points: Float[np.ndarray, "n 3"]) -> np.ndarray:
        """Return the distance (n,) to the triangles, whatever formula the surface carries."""
        query = np.ascontiguousarray(points, dtype=np.float64)
        if not len(query):
            return np.zeros(0)
        squared, _, _ = self._tree.squared_distance(self._vertices, self._faces, query)
        return np.sqrt(np.asarray(squared, np.float64).ravel())

    def _project_on_rim(self, query: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if not len(self._rim) or not len(query):
            return np.zeros_like(query), np.zeros_like(query)
        _, edges, closest = self._rim_tree.squared_distance(self._vertices, self._rim, query)
        ends = self._rim[np.asarray(edges, np.int64).ravel()]
        a, b = self._vertices[ends[:, 0]], self._vertices[ends[:, 1]]
        along = b - a
        t = np.clip(np.einsum("ni,ni->n", closest - a, along) / np.einsum("ni,ni->n", along, along), 0, 1)
        conormals = (1 - t[:, None]) * self._conormals[ends[:, 0]] + t[:, None] * self._conormals[ends[:, 1]]
        return closest, conormals / np.maximum(np.linalg.norm(conormals, axis=1, keepdims=True), 1e-300)


def barycentric(points: Float[np.ndarray, "n 3"], corners: Float[np.ndarray, "n 3 3"]) -> Float[np.ndarray, "n 3"]:
    """Return barycentric coordinates of points in the planes of triangles, clipped to the triangles."""
    u, v, w = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    uu, uv, vv = (np.einsum("ni,ni->n", a, b) for a, b in ((u, u), (u, v), (v, v)))
    wu, wv = np.einsum("ni,ni->n", w, u), np.einsum("ni,ni->n", w, v)
    area = np.maximum(uu * vv - uv * uv, 1e-300)
    second, third = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    weights = np.clip(np.stack([1 - second - third, second, third], axis=1), 0, 1)
    return weights / weights.sum(axis=1, keepdims=True)


def _boundary_sides(faces: np.ndarray, rim: np.ndarray) -> np.ndarray:
    """For every face (f, 3): is the side opposite to corner k on the rim?"""
    n = int(faces.max()) + 1
    key = np.sort(np.sort(rim, axis=1) @ np.array([n, 1]))
    if not len(key):
        return np.zeros(faces.shape, bool)
    sides = np.sort(np.stack([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]], axis=1), axis=2) @ np.array([n, 1])
    place = np.minimum(np.searchsorted(key, sides), len(key) - 1)
    return key[place] == sides


def _vertex_conormals(surface: Surface) -> np.ndarray:
    """Outward unit conormals (v, 3) at rim vertices: the mean of the two rim edges', zero elsewhere."""
    a, b = surface.boundary_edges[:, 0], surface.boundary_edges[:, 1]
    along = surface.vertices[b] - surface.vertices[a]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    total = np.zeros_like(surface.vertices)
    for end in (a, b):
        np.add.at(total, end, np.cross(along, surface.normals[end]))
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return total / np.where(length > 0, length, 1.0)
