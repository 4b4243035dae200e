"""A bijective map of a disk-shaped target to the plane, in which areas on the target can be cut."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import shapely
from jaxtyping import Float, Int
from scipy.sparse import coo_matrix, diags_array, eye_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from kirisurf.surface import Surface


class DiskEmbedding:
    """The mean-value embedding of a disk in the unit circle.

    Every inner vertex is a convex combination of its neighbors and the rim lies on a circle, so that no
    face flips (Tutte; Floater, "Mean value coordinates", 2003). How much a face is covered is measured as
    a fraction of its area, which does not depend on the map.

    Attributes
    ----------
    points : (v, 2)
        Vertices in the unit disk, faces counter-clockwise.
    """

    points: Float[np.ndarray, "v 2"]

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        self.points = _mean_value_embedding(surface)

    def place(self, faces: Int[np.ndarray, " n"], weights: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 2"]:
        """Return where points given by face and barycentric coordinates lie in the disk."""
        return np.einsum("nk,nki->ni", weights, self.points[self.surface.faces[faces]])

    def enclosed_fraction(self, segments: Float[np.ndarray, "m 2 2"]) -> float:
        """Return the area of the target that closed curves enclose, over the target's area.

        Parameters
        ----------
        segments : (m, 2, 2)
            Directed segments of the curves in the disk. Enclosed is where they wind round at least once in
            the direction in which they wind round most of their inside.
        """
        segments = segments[np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1) > 1e-14]
        region = _enclosed_region(segments)
        if region.is_empty:
            return 0.0
        shapely.prepare(region)
        corners = self.points[self.surface.faces]
        cut = np.unique(self._tree.query(shapely.linestrings(segments), predicate="intersects")[1])
        fraction = shapely.contains_xy(region, corners.mean(axis=1)).astype(float)
        fraction[cut] = self._cut_fractions(cut, segments, region)
        areas = self.surface.face_areas
        return float((areas * fraction).sum() / areas.sum())

    @cached_property
    def _tree(self) -> shapely.STRtree:
        return shapely.STRtree(shapely.polygons(self.points[self.surface.faces]))

    def _cut_fractions(self, cut: np.ndarray, segments: np.ndarray, region: shapely.Geometry) -> np.ndarray:
        """Enclosed fraction of every cut face: the faces' sides and the curves are noded into cells at once."""
        faces = self.surface.faces[cut]
        sides = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
        cells = _cells(np.concatenate([self.points[sides], segments]))
        inner = shapely.point_on_surface(cells)
        inside = shapely.contains_xy(region, shapely.get_x(inner), shapely.get_y(inner))
        found, face = self._tree.query(inner, predicate="intersects")
        place = np.searchsorted(cut, face)
        valid = (place < len(cut)) & (cut[np.minimum(place, len(cut) - 1)] == face)
        cell, place = found[valid], place[valid]
        area = shapely.area(cells)[cell]
        total = np.bincount(place, area, len(cut))
        enclosed = np.bincount(place, area * inside[cell], len(cut))
        return enclosed / np.where(total > 0, total, 1.0)


def is_disk(surface: Surface) -> bool:
    """Return whether a surface is one consistently oriented disk: connected, one rim, no handle, no loose vertex."""
    faces = surface.faces
    n = len(surface.vertices)
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    key = edges[:, 0] * n + edges[:, 1]
    if not len(faces) or len(np.unique(key)) < len(key) or len(np.unique(faces)) < n:
        return False
    graph = coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(n, n))
    rim = surface.boundary_edges
    n_edges = (len(edges) + len(rim)) // 2
    one_rim = len(np.unique(rim[:, 0])) == len(rim) and len(surface.boundary_loops) == 1
    return bool(connected_components(graph, directed=False)[0] == 1 and one_rim and n - n_edges + len(faces) == 1)


def _mean_value_embedding(surface: Surface) -> np.ndarray:
    vertices, faces = surface.vertices, surface.faces
    n = len(vertices)
    rim = surface.boundary_loops[0]
    steps = np.linalg.norm(vertices[np.roll(rim, -1)] - vertices[rim], axis=1)
    around = 2 * np.pi * np.r_[0.0, np.cumsum(steps)[:-1]] / steps.sum()

    rows, columns, values = [], [], []
    for k in range(3):
        a, b, c = faces[:, k], faces[:, (k + 1) % 3], faces[:, (k + 2) % 3]
        u, v = vertices[b] - vertices[a], vertices[c] - vertices[a]
        length_u, length_v = np.linalg.norm(u, axis=1), np.linalg.norm(v, axis=1)
        # tan(angle / 2) = sine / (1 + cosine), both times the lengths
        sine = np.linalg.norm(np.cross(u, v), axis=1)
        half = sine / np.maximum(length_u * length_v + np.einsum("fi,fi->f", u, v), 1e-12 * length_u * length_v)
        half = np.maximum(half, 1e-9)
        rows += [a, a]
        columns += [b, c]
        values += [half / np.maximum(length_u, 1e-300), half / np.maximum(length_v, 1e-300)]
    place = (np.concatenate(rows), np.concatenate(columns))
    weights = coo_matrix((np.concatenate(values), place), shape=(n, n)).tocsr()
    inner = np.ones(n, bool)
    inner[rim] = False
    points = np.zeros((n, 2))
    points[rim] = np.stack([np.cos(around), np.sin(around)], axis=1)
    if inner.any():
        total = np.asarray(weights.sum(axis=1)).ravel()
        own = (diags_array(1 / total).tocsr() @ weights)[inner]
        system = eye_array(int(inner.sum()), format="csc") - own[:, inner].tocsc()
        right = own[:, ~inner] @ points[~inner]
        # a dominant diagonal needs no pivoting, which would destroy the order
        factors = splu(system, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        points[inner] = factors.solve(np.ascontiguousarray(right))
    return points


def _cells(segments: np.ndarray) -> np.ndarray:
    """The bounded cells of an arrangement of segments, as polygons."""
    # a grid finer than anything that counts here: segments on each other up to rounding are noded safely
    noded = shapely.union_all(shapely.linestrings(segments), grid_size=1e-12)
    return shapely.get_parts(shapely.polygonize([noded]))


def _enclosed_region(segments: np.ndarray) -> shapely.Geometry:
    """The union of the cells round which the directed segments wind, in their main direction."""
    cells = _cells(segments)
    if not len(cells):
        return shapely.Polygon()
    inner = shapely.point_on_surface(cells)
    points = np.stack([shapely.get_x(inner), shapely.get_y(inner)], axis=1)
    winding = np.zeros(len(points))
    for chunk in np.array_split(np.arange(len(points)), max(1, len(points) * len(segments) // 2_000_000)):
        u = segments[None, :, 0] - points[chunk, None]
        v = segments[None, :, 1] - points[chunk, None]
        sine = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
        winding[chunk] = np.arctan2(sine, (u * v).sum(axis=2)).sum(axis=1)
    winding = np.rint(winding / (2 * np.pi))
    main = np.sign((shapely.area(cells) * winding).sum())
    return shapely.union_all(cells[winding * main > 0])
