"""Connectivity of triangle arrays: edges, pieces, fans, orientation and the rim, all without loops over faces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree


@dataclass(frozen=True, eq=False)
class Edges:
    """Undirected edges of a face array; side 3 f + k of face f runs from its corner k to the next.

    Attributes
    ----------
    ends : (e, 2)
        Vertices, the lower first.
    of_side : (3f,)
        Edge of every side.
    is_forward : (3f,) bool
        True where the side runs from the lower vertex to the higher.
    face_count : (e,)
        Number of sides on every edge.
    """

    ends: Int[np.ndarray, "e 2"]
    of_side: Int[np.ndarray, " s"]
    is_forward: Bool[np.ndarray, " s"]
    face_count: Int[np.ndarray, " e"]

    @classmethod
    def of(cls, faces: Int[np.ndarray, "f 3"], n_vertices: int) -> Edges:
        """Collect the edges of all faces."""
        start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
        low, high = np.minimum(start, end), np.maximum(start, end)
        keys, of_side, count = np.unique(low * max(n_vertices, 1) + high, return_inverse=True, return_counts=True)
        ends = np.stack([keys // max(n_vertices, 1), keys % max(n_vertices, 1)], axis=1)
        return cls(ends, of_side, start < end, count)

    @property
    def pairs(self) -> np.ndarray:
        """Sides (k, 2) that share an edge: both of an edge of two faces, neighbors in a row for one of more."""
        order = np.argsort(self.of_side, kind="stable")
        same = self.of_side[order[1:]] == self.of_side[order[:-1]]
        return np.stack([order[:-1][same], order[1:][same]], axis=1)


def pieces_of_faces(faces: Int[np.ndarray, "f 3"], n: int) -> Int[np.ndarray, " f"]:
    """Number of the connected piece of every face, joined by shared vertices (n of them), (f,)."""
    if not len(faces):
        return np.zeros(0, np.int64)
    rows = np.concatenate([faces[:, 0], faces[:, 1]])
    columns = np.concatenate([faces[:, 1], faces[:, 2]])
    label = _components(rows, columns, n)
    _, pieces = np.unique(label[faces[:, 0]], return_inverse=True)
    return pieces.astype(np.int64)


def fans_per_vertex(faces: Int[np.ndarray, "f 3"], edges: Edges, n: int) -> Int[np.ndarray, " n"]:
    """Count the fans of faces round every vertex, (n,): corners joined where their faces share an edge there."""
    _, one = np.unique(_fan_of_corner(faces, edges), return_index=True)
    return np.bincount(faces.ravel()[one], minlength=n)


def separated_fans(faces: Int[np.ndarray, "f 3"], n: int) -> tuple[Int[np.ndarray, "f 3"], Int[np.ndarray, " m"]]:
    """Give every fan of faces a vertex of its own.

    Returns
    -------
    faces : (f, 3)
        Indices of the new vertices.
    origins : (m,)
        The old vertex (of n) that each new one is a copy of, in rising order.
    """
    fan = _fan_of_corner(faces, Edges.of(faces, n))
    _, one, fan = np.unique(fan, return_index=True, return_inverse=True)
    origins = faces.ravel()[one]
    order = np.argsort(origins, kind="stable")
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return rank[fan].reshape(-1, 3), origins[order]


def _fan_of_corner(faces: np.ndarray, edges: Edges) -> np.ndarray:
    """Number of the fan that every corner belongs to, (3f,)."""
    if not len(faces):
        return np.zeros(0, np.int64)
    first, second = edges.pairs.T
    start = faces.ravel()
    following = np.arange(faces.size).reshape(-1, 3)[:, [1, 2, 0]].ravel()  # corner at the end of a side
    # Join the corners of the two faces at each end of the shared edge.
    same_way = start[first] == start[second]
    there_start = np.where(same_way, second, following[second])
    there_end = np.where(same_way, following[second], second)
    rows, columns = np.concatenate([first, following[first]]), np.concatenate([there_start, there_end])
    return _components(rows, columns, faces.size)


def orientation(edges: Edges, n_faces: int) -> tuple[bool, Bool[np.ndarray, " f"]]:
    """Decide orientability on the double cover: each face as it is and turned over, joined where they agree.

    Returns
    -------
    is_orientable : bool
    flipped : (f,) bool
        Faces to turn over for a consistent orientation, the fewer of each piece; none where there is none.
    """
    if not n_faces:
        return True, np.zeros(0, bool)
    first, second = edges.pairs.T
    two_faces = edges.face_count[edges.of_side[first]] == 2
    first, second = first[two_faces], second[two_faces]
    agree = edges.is_forward[first] != edges.is_forward[second]
    f, g = first // 3, second // 3
    rows = np.concatenate([f, f + n_faces])
    columns = np.concatenate([np.where(agree, g, g + n_faces), np.where(agree, g + n_faces, g)])
    label = _components(rows, columns, 2 * n_faces)
    as_is, turned = label[:n_faces], label[n_faces:]
    if (as_is == turned).any():
        return False, np.zeros(n_faces, bool)
    # The two sheets of a piece are mirror images: keep the one that turns over fewer faces.
    kept = np.bincount(as_is, minlength=label.max() + 1)
    flipped = (kept[turned] > kept[as_is]) | ((kept[turned] == kept[as_is]) & (turned < as_is))
    return True, flipped


def boundary_loop_sizes(boundary: Int[np.ndarray, "b 2"]) -> tuple[int, ...]:
    """Number of edges of every connected part of the boundary, most first."""
    if not len(boundary):
        return ()
    vertices, compact = np.unique(boundary, return_inverse=True)
    rows, columns = compact.reshape(-1, 2).T
    label = _components(rows, columns, len(vertices))
    return tuple(int(k) for k in np.sort(np.bincount(label[rows]))[::-1])


def aspects(vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "f 3"]) -> Float[np.ndarray, " f"]:
    """Longest side over height of every face, (f,); infinite without area."""
    if not len(faces):
        return np.zeros(0)
    low = vertices.min(axis=0)
    size = float(np.ptp(vertices, axis=0).max()) or 1.0
    p = ((vertices - low) / size)[faces]
    longest = ((np.roll(p, -1, axis=1) - p) ** 2).sum(axis=2).max(axis=1)
    double_area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)
    return np.divide(longest, double_area, out=np.full(len(faces), np.inf), where=double_area > 0)


def crack_vertices(vertices: Float[np.ndarray, "n 3"], boundary: Int[np.ndarray, "b 2"]) -> int:
    """Count boundary vertices on the inside of another boundary edge (within 1e-6 of its length)."""
    if not len(boundary):
        return 0
    rim = np.unique(boundary)
    a, b = vertices[boundary[:, 0]], vertices[boundary[:, 1]]
    length = np.linalg.norm(b - a, axis=1)
    near = cKDTree(vertices[rim]).query_ball_point((a + b) / 2, 0.5 * length, return_length=False)
    edge = np.repeat(np.arange(len(boundary)), [len(found) for found in near])
    vertex = rim[np.array([k for found in near for k in found], dtype=np.int64)]
    other = (vertex != boundary[edge, 0]) & (vertex != boundary[edge, 1])
    edge, vertex = edge[other], vertex[other]
    along = (b - a)[edge] / np.where(length > 0, length, 1.0)[edge, None]
    offset = vertices[vertex] - a[edge]
    at = np.einsum("ij,ij->i", offset, along)
    away = np.linalg.norm(offset - at[:, None] * along, axis=1)
    tolerance = 1e-6 * length[edge]
    return len(np.unique(vertex[(away < tolerance) & (at > tolerance) & (at < length[edge] - tolerance)]))


def _components(rows: np.ndarray, columns: np.ndarray, n: int) -> np.ndarray:
    graph = coo_matrix((np.ones(len(rows), np.int8), (rows, columns)), shape=(n, n))
    return connected_components(graph, directed=False)[1].astype(np.int64)
