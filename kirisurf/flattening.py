"""Conformal flattening of a disk: where on the target a flat pattern comes to lie, and at what stretch.

Why not LSCM by default: libigl's LSCM has no free-boundary form and scales parts of a large outline far
apart. The map used here keeps the length of the boundary (log scale zero there), which makes the spread of
the scale factor over the surface the smallest that a conformal map can have (Chebyshev's principle); since
a kirigami sheet stretches by a bounded factor only, that spread is what decides whether it can be made.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import igl
import numpy as np
import shapely
from jaxtyping import Float, Int
from scipy.sparse import csc_matrix, csr_matrix, diags, spmatrix
from scipy.sparse.linalg import splu, spsolve

from kirisurf.closest import barycentric
from kirisurf.errors import UnusableError
from kirisurf.gate import check_native
from kirisurf.surface import Surface


@dataclass(frozen=True, eq=False)
class Flattening:
    """A one-to-one map of a surface to the plane.

    Attributes
    ----------
    surface : Surface
    uv : (v, 2)
        Flat position of every vertex, in the units of the surface.
    log_scale : (v,)
        Logarithm of length on the surface over length in the plane.
    kind : str
        How it was made.
    n_repaired : int
        Number of overturned faces that were smoothed away.
    """

    surface: Surface
    uv: Float[np.ndarray, "v 2"]
    log_scale: Float[np.ndarray, " v"]
    kind: str
    n_repaired: int = 0

    @cached_property
    def outline(self) -> shapely.Polygon:
        """Flat outline."""
        return shapely.Polygon(self.uv[self.surface.boundary_loops[0]])

    @cached_property
    def _tree(self) -> tuple[np.ndarray, np.ndarray, igl.AABB]:
        flat = np.ascontiguousarray(np.column_stack([self.uv, np.zeros(len(self.uv))]))
        faces = np.ascontiguousarray(self.surface.faces)
        tree = igl.AABB()
        tree.init(flat, faces)
        return flat, faces, tree

    def locate(
        self, points: Float[np.ndarray, "n 2"]
    ) -> tuple[Int[np.ndarray, " n"], Float[np.ndarray, "n 3"], np.ndarray]:
        """Return face (n,), barycentric coordinates (n, 3) and flat offset (n, 2) of points from the flat mesh."""
        flat, faces, tree = self._tree
        query = np.ascontiguousarray(np.column_stack([points, np.zeros(len(points))]))
        _, face, closest = tree.squared_distance(flat, faces, query)
        face = np.asarray(face, np.int64).ravel()
        return face, barycentric(closest, flat[faces[face]]), points - closest[:, :2]

    def lift(self, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 3"]:
        """Map flat points to the surface; points beyond the outline follow the tangent plane at the rim."""
        face, weights, offset = self.locate(points)
        corner = self.surface.faces[face]
        corners = self.surface.vertices[corner]
        lifted = np.einsum("nk,nki->ni", weights, corners)
        outside = np.linalg.norm(offset, axis=1) > 0
        if outside.any():
            flat = self.uv[corner[outside]]
            solid = corners[outside]
            jacobian = np.stack([solid[:, 1] - solid[:, 0], solid[:, 2] - solid[:, 0]], axis=2) @ np.linalg.inv(
                np.stack([flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]], axis=2)
            )
            lifted[outside] += np.einsum("nij,nj->ni", jacobian, offset[outside])
        return lifted

    def interpolate(self, values: Float[np.ndarray, " v"], points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " n"]:
        """Return values given at the vertices at flat points (n,)."""
        face, weights, _ = self.locate(points)
        return np.einsum("nk,nk->n", weights, values[self.surface.faces[face]])


def signed_areas(uv: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Signed areas (f,) of flat triangles."""
    a, b, c = (uv[faces[:, k]] for k in range(3))
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def flatten(surface: Surface) -> Flattening:
    """Flatten a disk conformally with unit scale on its boundary.

    Solves the discrete Yamabe equation L u = -K (u = 0 on the boundary, L the cotangent Laplacian of the
    intrinsic Delaunay triangulation, K the angle defect), lays out the boundary with the curvature
    k + L u, and extends it harmonically (after Sawhney and Crane, "Boundary First Flattening", 2017).

    Raises
    ------
    UnusableError
        Where no one-to-one flattening was found.
    """
    vertices, faces = check_native(surface.vertices, surface.faces, surface.name)
    size = surface.diagonal
    unit = (vertices - vertices.mean(axis=0)) / size
    laplacian = -csc_matrix(igl.intrinsic_delaunay_cotmatrix(unit, faces)[0])
    loop = np.asarray(surface.boundary_loops[0])
    inner = np.setdiff1d(np.arange(len(unit)), loop)
    defect = _angle_defects(unit, faces, loop)
    interior = laplacian[inner][:, inner]
    solve = positive_solver(interior)
    log_scale = np.zeros(len(unit))
    log_scale[inner] = solve(-defect[inner])
    turning = defect[loop] + (laplacian @ log_scale)[loop]
    length = np.linalg.norm(unit[np.roll(loop, -1)] - unit[loop], axis=1)
    curve = _closed_curve(length, turning)
    uv = np.zeros((len(unit), 2))
    uv[loop] = curve
    coupling = laplacian[inner][:, loop]
    for axis in range(2):
        uv[inner, axis] = solve(-(coupling @ curve[:, axis]))
    return checked_flattening(surface, uv * size, "conformal")


def positive_solver(matrix: spmatrix) -> Callable[[np.ndarray], np.ndarray]:
    """Return what solves with a sparse symmetric positive definite matrix, which may be empty."""
    if not matrix.shape[0]:
        return np.copy
    # a symmetric order: half the time of the default for such matrices
    return splu(csc_matrix(matrix), "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}).solve


def checked_flattening(surface: Surface, uv: np.ndarray, kind: str) -> Flattening:
    """Return the flattening with these flat positions (v, 2), overturned faces smoothed away.

    Raises
    ------
    UnusableError
        Where the outline crosses itself or faces remain overturned.
    """
    outline = shapely.Polygon(uv[surface.boundary_loops[0]])
    if not outline.is_valid:
        raise UnusableError(
            f"{surface.name}: expected a surface that can be laid flat in one piece, got one whose flattened outline "
            f"crosses itself ({shapely.is_valid_reason(outline)}). Take a smaller part of it, or cut it open."
        )
    flipped = signed_areas(uv, surface.faces) <= 0
    repaired = int(flipped.sum())
    if repaired:
        uv = _untangled(surface, uv)
    left = int((signed_areas(uv, surface.faces) <= 0).sum())
    if left:
        raise UnusableError(
            f"{surface.name}: expected a surface that flattens one to one, got {left} overturned faces that smoothing "
            "did not repair. Remesh it (--remesh) or take a smoother part."
        )
    return Flattening(surface, uv, _face_log_scale(surface, uv), kind, repaired)


def _untangled(surface: Surface, uv: np.ndarray) -> np.ndarray:
    """Move the inner vertices round overturned faces to the mean of their neighbors, in growing patches.

    Such a map of a patch onto a convex part of the plane is one to one (Tutte 1963).
    """
    faces, n = surface.faces, len(uv)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    graph = csr_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(n, n))
    graph = ((graph + graph.T) > 0).astype(float)
    laplacian = csr_matrix(diags(np.asarray(graph.sum(axis=1)).ravel()) - graph)
    rim = np.zeros(n, bool)
    rim[surface.boundary_loops[0]] = True
    for width in range(9):
        flipped = signed_areas(uv, faces) <= 0
        if not flipped.any():
            break
        chosen = np.zeros(n)
        chosen[faces[flipped].ravel()] = 1
        for _ in range(width):
            chosen = graph @ chosen + chosen
        free = np.flatnonzero((chosen > 0) & ~rim)
        if not len(free):
            continue
        fixed = np.setdiff1d(np.arange(n), free)
        rows = laplacian[free]
        right = -(rows[:, fixed] @ uv[fixed])
        uv = uv.copy()
        uv[free] = spsolve(csc_matrix(rows[:, free]), right).reshape(-1, 2)
    return uv


def _angle_defects(vertices: np.ndarray, faces: np.ndarray, loop: np.ndarray) -> np.ndarray:
    """2 pi (inside) or pi (on the boundary) minus the sum of the corner angles, (v,)."""
    total = np.zeros(len(vertices))
    corners = vertices[faces]
    for k in range(3):
        u = corners[:, (k + 1) % 3] - corners[:, k]
        w = corners[:, (k + 2) % 3] - corners[:, k]
        np.add.at(total, faces[:, k], np.arctan2(np.linalg.norm(np.cross(u, w), axis=1), np.einsum("ij,ij->i", u, w)))
    defect = 2 * np.pi - total
    defect[loop] -= np.pi
    return defect


def _closed_curve(length: np.ndarray, turning: np.ndarray) -> np.ndarray:
    """Lay out a closed curve from edge lengths (b,) and turning angles (b,) at the edges' starts.

    The lengths are changed as little as possible (least squares weighted by 1 / length) to close it.
    """
    direction = np.cumsum(turning)
    tangent = np.stack([np.cos(direction), np.sin(direction)], axis=1)
    weighted = tangent * length[:, None]
    correction = weighted @ np.linalg.solve(tangent.T @ weighted, length @ tangent)
    steps = tangent * (length - correction)[:, None]
    return np.cumsum(np.vstack([np.zeros((1, 2)), steps[:-1]]), axis=0)


def _face_log_scale(surface: Surface, uv: np.ndarray) -> np.ndarray:
    """Half the logarithm of the area ratio of the faces round every vertex, (v,)."""
    flat, solid = np.zeros(len(uv)), np.zeros(len(uv))
    areas = np.abs(signed_areas(uv, surface.faces))
    for k in range(3):
        np.add.at(flat, surface.faces[:, k], areas)
        np.add.at(solid, surface.faces[:, k], surface.face_areas)
    return 0.5 * np.log(np.maximum(solid, 1e-300) / np.maximum(flat, 1e-300))
