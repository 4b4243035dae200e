"""Bicubic Bezier patches over the holes of a deployed sheet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from analysis import polygons
from analysis.bernstein import difference_matrix, tensor_rows
from analysis.bezier import BezierPatch
from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation

SMOOTHING = 1e-3
"""Weight of the third differences of the control net against the vertices (both squared)."""

SMOOTHING_OF_MANY = 1e-5
"""The same where a hole has at least 16 vertices round it, as many as control points: they determine the cubic part
themselves. Where they do not lie symmetric about the hole's center (octagons and squares, 18-gons and triangles), a
weight of 1e-3 would leave an error of first order in the curvature there; this one is of second order, for 1.1 to 1.6
times the noise."""

FEWEST = 8
"""Vertices that a patch needs: six determine a quadratic, two more average. A hole among four triangles has eight."""

LARGEST_CONDITION = 50.0
"""Condition number of the six quadratic monomials at a hole's vertices above which they do not determine its
curvature; a regular hole has about 5."""


@dataclass(frozen=True, eq=False)
class HolePatches:
    """The patches of all holes with the holes' places in them.

    Attributes
    ----------
    patches : BezierPatch
    corners : Loops
        Holes with their own numbering: loop h lists rows of `parameters`.
    parameters : (s, 2)
        (u, v) of every hole corner.
    centers : (g, 2)
        (u, v) of the mean of the hole's corners.
    ill_conditioned : (g,) bool
        The vertices do not determine the curvature: too few, nearly on a conic, or a tile stands across.
    residuals : (g,), units
        Largest distance of a surrounding vertex to its point of the patch.
    """

    patches: BezierPatch
    corners: Loops
    parameters: Float[np.ndarray, "s 2"]
    centers: Float[np.ndarray, "g 2"]
    ill_conditioned: Bool[np.ndarray, " g"]
    residuals: Float[np.ndarray, " g"]

    def sample(self, n: int) -> Float[np.ndarray, "g k m 3"]:
        """Return a grid of points of every patch over its hole, units.

        Where every hole has four corners, point (i, j) is S at the bilinear blend of the corners q_0 ... q_3 in
        parameters, (1-s)(1-t) q_0 + s(1-t) q_1 + st q_2 + (1-s)t q_3 with s = i/(n-1), t = j/(n-1). Else it is S
        at (1-s) c + s q(j), from the hole's center c to the point q(j) of its polygon, which starts and ends at q_0
        and meets every corner.

        Parameters
        ----------
        n : int
            Points along every side, or from the center to the rim.

        Returns
        -------
        (g, n, m, 3)
            m = n for quadrilaterals. NaN where the curvature is not determined.

        Raises
        ------
        ParameterError
            Where n is below 2.
        """
        if n < 2:
            raise ParameterError(f"sample: expected at least 2 points along every side, got {n}")
        sizes = self.corners.sizes
        most = int(sizes.max(initial=4))
        m = n if (sizes == 4).all() else 2 * most + 1
        places = np.full((len(self.patches), n, m, 2), np.nan)
        s = np.linspace(0.0, 1.0, n)[:, None]
        for size, (which, rows) in self.corners.by_size().items():
            corner = self.parameters[rows]
            if m == n and size == 4:
                weights = np.stack([(1 - s) * (1 - s.T), s * (1 - s.T), s * s.T, (1 - s) * s.T])
                places[which] = np.einsum("cij,gcd->gijd", weights, corner)
            else:
                rim = np.einsum("jc,gcd->gjd", _round_trip(size, m), corner)
                center = self.centers[which, None, None]
                places[which] = center + s[:, :, None] * (rim[:, None] - center)
        flat = places.reshape(len(places), n * m, 2)
        points = self.patches.evaluate(flat[..., 0], flat[..., 1]).reshape(len(places), n, m, 3)
        return np.where(self.ill_conditioned[:, None, None, None], np.nan, points)


def fit_patches(
    points: Float[np.ndarray, "n d"],
    parameters: Float[np.ndarray, "n 2"],
    loops: Loops,
    smoothing: float | None = None,
) -> Float[np.ndarray, "g 4 4 d"]:
    """Return the control nets of least-squares patches.

    Minimizes, for every loop of points x_k at (u_k, v_k),

        sum_k |S(u_k, v_k) - x_k|^2 + w sum |third differences of the net, pure and mixed|^2,

    so that a surface that is quadratic in (u, v) is returned as it is, and the cubic part is as small as
    the points allow.

    Parameters
    ----------
    points : (n, d), units
    parameters : (n, 2)
        In [0, 1]^2.
    loops : Loops
        Numbers of the points of every patch.
    smoothing : float, optional
        w; by default `SMOOTHING`, and `SMOOTHING_OF_MANY` for loops of at least 16 points.
    """
    differences = _third_differences()
    nets = np.zeros((len(loops), 16, points.shape[1]))
    for size, (which, indices) in loops.by_size().items():
        weight = (SMOOTHING_OF_MANY if size >= 16 else SMOOTHING) if smoothing is None else smoothing
        penalty = np.sqrt(weight) * differences
        rows = tensor_rows(parameters[indices, 0], parameters[indices, 1])
        system = np.concatenate([rows, np.broadcast_to(penalty, (len(which), *penalty.shape))], axis=1)
        # the pseudo-inverse also answers where points coincide; such holes are flagged elsewhere
        nets[which] = np.linalg.pinv(system)[:, :, : indices.shape[1]] @ points[indices]
    return nets.reshape(len(loops), 4, 4, points.shape[1])


def hole_patches(points: Float[np.ndarray, "n 3"], tessellation: Tessellation) -> HolePatches:
    """Return the patch of every closed hole, through the vertices of the tiles round it.

    Parameters are the positions in the vertices' best plane, scaled to [0, 1]^2 alike in both directions;
    normals of the patch are on the tiles' front side. The axes in the plane follow from the positions alone
    (the direction of sum z^4 with z = x + iy), so that the patch does not depend on any numbering.
    """
    around = surrounding_vertices(tessellation)
    g = len(around)
    owners = around.owners
    counts = np.maximum(around.sizes, 1)
    local = points[around.indices]
    center = np.stack([np.bincount(owners, local[:, i], g) for i in range(3)], axis=1) / counts[:, None]
    local = local - center[owners]

    fronts = polygons.area_vectors(points, tessellation.tiles)
    ring = tessellation.hole_tiles
    front = np.stack([np.bincount(ring.owners, fronts[ring.indices, i], g) for i in range(3)], axis=1)
    covariance = np.zeros((g, 3, 3))
    np.add.at(covariance, owners, local[:, :, None] * local[:, None, :])
    normal = np.linalg.eigh(covariance)[1][:, :, 0]
    normal *= np.where(np.einsum("gi,gi->g", normal, front) < 0, -1.0, 1.0)[:, None]
    # a tile that stands across the plane, or faces backwards, leaves no graph over the plane
    steepest = np.ones(g)
    tile_normal = polygons.unit(fronts)[ring.indices]
    np.minimum.at(steepest, ring.owners, np.einsum("ri,ri->r", tile_normal, normal[ring.owners]))

    first, second = polygons.frames(normal)
    z = np.einsum("si,si->s", local, first[owners]) + 1j * np.einsum("si,si->s", local, second[owners])
    fourth = np.bincount(owners, (z**4).real, g) + 1j * np.bincount(owners, (z**4).imag, g)
    turn = np.exp(-0.25j * np.angle(fourth))
    z = z * turn[owners]
    size = np.zeros(g)
    np.maximum.at(size, owners, np.maximum(np.abs(z.real), np.abs(z.imag)))
    size = np.where(size > 0, size, 1.0)
    parameters = 0.5 + np.stack([z.real, z.imag], axis=1) / (2 * size[owners, None])

    rows = Loops(around.offsets, np.arange(len(owners)))
    nets = fit_patches(local, parameters, rows)
    residual = np.zeros(g)
    for which, indices in rows.by_size().values():
        uv = parameters[indices]
        fitted = tensor_rows(uv[..., 0], uv[..., 1]) @ nets[which].reshape(-1, 16, 3)
        residual[which] = np.linalg.norm(fitted - local[indices], axis=2).max(axis=1)

    place = _positions(around, tessellation.holes, len(points))
    holes = tessellation.holes
    corners = parameters[place]
    middle = np.stack([np.bincount(holes.owners, corners[:, i], g) for i in range(2)], axis=1)
    return HolePatches(
        patches=BezierPatch(nets + center[:, None, None]),
        corners=Loops(holes.offsets, np.arange(len(place))),
        parameters=corners,
        centers=middle / np.maximum(holes.sizes, 1)[:, None],
        ill_conditioned=(around.sizes < FEWEST) | (conditions(parameters, rows) > LARGEST_CONDITION) | (steepest < 0.2),
        residuals=residual,
    )


def surrounding_vertices(tessellation: Tessellation) -> Loops:
    """Return the vertices of the tiles round every hole, each once (12 round a quad hole)."""
    tiles, ring = tessellation.tiles, tessellation.hole_tiles
    sizes = tiles.sizes[ring.indices]
    hole = np.repeat(ring.owners, sizes)
    local = np.arange(len(hole)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    vertex = tiles.indices[np.repeat(tiles.offsets[ring.indices], sizes) + local]
    key = np.unique(hole * tessellation.n_vertices + vertex)
    hole, vertex = np.divmod(key, max(tessellation.n_vertices, 1))
    counts = np.bincount(hole, minlength=len(ring))
    return Loops(np.r_[0, np.cumsum(counts)].astype(np.int64), vertex.astype(np.int64))


def conditions(parameters: Float[np.ndarray, "s 2"], loops: Loops) -> Float[np.ndarray, " g"]:
    """Return the condition number of the six quadratic monomials at the points of every loop."""
    result = np.full(len(loops), np.inf)
    for size, (which, indices) in loops.by_size().items():
        if size >= 6:
            x, y = 2 * parameters[indices, 0] - 1, 2 * parameters[indices, 1] - 1
            monomials = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=2)
            values = np.linalg.svd(monomials, compute_uv=False)
            result[which] = values[:, 0] / np.maximum(values[:, -1], 1e-300)
    return result


def _round_trip(size: int, m: int) -> np.ndarray:
    """Weights (m, size) of a polygon's corners in m > size points along it, from corner 0 through all and back."""
    first = np.arange(size + 1) * (m - 1) // size
    side = np.minimum(np.searchsorted(first, np.arange(m), side="right") - 1, size - 1)
    along = (np.arange(m) - first[side]) / (first[side + 1] - first[side])
    weights = np.zeros((m, size))
    np.add.at(weights, (np.arange(m), side), 1 - along)
    np.add.at(weights, (np.arange(m), (side + 1) % size), along)
    return weights


def _third_differences() -> np.ndarray:
    """All third differences of a 4x4 net, pure and mixed, weighted as in |third derivative|^2."""
    rows = []
    for order in range(4):
        weight = np.sqrt((1.0, 3.0, 3.0, 1.0)[order])
        rows.append(weight * np.kron(difference_matrix(4, order), difference_matrix(4, 3 - order)))
    return np.concatenate(rows)


def _positions(around: Loops, holes: Loops, n: int) -> np.ndarray:
    """Where the vertices of every hole stand in the sorted list of its surrounding vertices."""
    return np.searchsorted(around.owners * n + around.indices, holes.owners * n + holes.indices)
