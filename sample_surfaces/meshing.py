"""Well-shaped triangle meshes of plane outlines and of a spherical cap: points and faces, nothing random."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import Delaunay, cKDTree

from sample_surfaces.outlines import Outline, outline_points

_SMOOTHING_STEPS = 12


def grid_mesh(low: Float[np.ndarray, "2"], high: Float[np.ndarray, "2"], cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Return places (v, 2) and faces (f, 3) of a rectangle, `cells` squares along its longer side.

    The diagonals alternate like the colors of a chessboard, so that neither direction is preferred.
    """
    size = high - low
    columns, rows = (max(2, round(float(cells * side / size.max()))) for side in size)
    axes = np.linspace(low[0], high[0], columns + 1), np.linspace(low[1], high[1], rows + 1)
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij"))
    a, b = i * (rows + 1) + j, (i + 1) * (rows + 1) + j
    c, d = b + 1, a + 1
    even = ((i + j) % 2 == 0)[:, None]
    first = np.where(even, np.stack([a, b, c], axis=1), np.stack([a, b, d], axis=1))
    second = np.where(even, np.stack([a, c, d], axis=1), np.stack([b, c, d], axis=1))
    return places, np.stack([first, second], axis=1).reshape(-1, 3)


def outline_mesh(outline: Outline, edge: float) -> tuple[Float[np.ndarray, "v 2"], Int[np.ndarray, "f 3"]]:
    """Return places (v, 2) and faces (f, 3) of the inside of an outline, edges about `edge` long.

    A triangular lattice clipped to the outline, joined to points of the outline by Delaunay's
    triangulation and relaxed: every inner place moves to the centroid of the triangles round it. The
    outline's own points come first and stay where they are.
    """
    rim = outline_points(outline, edge)
    inner = _lattice(rim, edge)
    inner = inner[_inside(inner, rim)]
    near, _ = cKDTree(outline_points(outline, edge / 16)).query(inner)
    inner = inner[near > 0.6 * edge]
    places = np.concatenate([rim, inner])
    for _ in range(_SMOOTHING_STEPS):
        faces, areas = _triangulated(places, rim, edge)
        total, weight = np.zeros_like(places), np.zeros(len(places))
        centroids = places[faces].mean(axis=1)
        for k in range(3):
            np.add.at(total, faces[:, k], areas[:, None] * centroids)
            np.add.at(weight, faces[:, k], areas)
        places[len(rim) :] = total[len(rim) :] / weight[len(rim) :, None]
    return places, _triangulated(places, rim, edge)[0]


def cap_mesh(rings: int, half_angle: float) -> tuple[Float[np.ndarray, "v 3"], Int[np.ndarray, "f 3"]]:
    """Return points (v, 3) of the unit sphere's cap round its lowest point, and faces (f, 3) seen from inside.

    Ring k of `rings` lies at the polar angle k / rings * half_angle (radians) and holds 6 k vertices.
    """
    points = [np.array([[0.0, 0.0, -1.0]])]
    for k in range(1, rings + 1):
        polar = half_angle * k / rings
        azimuth = 2 * np.pi * np.arange(6 * k) / (6 * k)
        ring = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth)], axis=1)
        points.append(np.column_stack([ring, np.full(6 * k, -np.cos(polar))]))
    faces = []
    for k in range(1, rings + 1):
        inner, outer = 1 + 3 * (k - 1) * (k - 2) if k > 1 else 0, 1 + 3 * k * (k - 1)
        n_inner = max(1, 6 * (k - 1))
        for side in range(6):
            for m in range(k):
                a, b = outer + side * k + m, outer + (side * k + m + 1) % (6 * k)
                c = inner + (side * (k - 1) + m) % n_inner
                faces.append((c, a, b))
                if m < k - 1:
                    faces.append((c, b, inner + (side * (k - 1) + m + 1) % n_inner))
    return np.concatenate(points), np.array(faces, dtype=np.int64)


def _lattice(rim: np.ndarray, edge: float) -> np.ndarray:
    # Equilateral, symmetric about the middle of the outline's box.
    low, high = rim.min(axis=0), rim.max(axis=0)
    center, half = 0.5 * (low + high), 0.5 * (high - low)
    height = edge * np.sqrt(0.75)
    n, m = (int(np.ceil(half[k] / (edge, height)[k])) + 1 for k in range(2))
    column, row = np.meshgrid(np.arange(-n, n + 1), np.arange(-m, m + 1))
    return center + np.stack([edge * (column + 0.5 * (row % 2)), height * row], axis=-1).reshape(-1, 2)


def _inside(places: np.ndarray, rim: np.ndarray) -> np.ndarray:
    # Even-odd rule: a ray to the right crosses the outline an odd number of times.
    a, b = rim, np.roll(rim, -1, axis=0)
    x, y = places[:, :1], places[:, 1:]
    spans = (a[:, 1] > y) != (b[:, 1] > y)
    rise = np.where(a[:, 1] == b[:, 1], 1.0, b[:, 1] - a[:, 1])
    crossing = a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    return (spans & (x < crossing)).sum(axis=1) % 2 == 1


def _triangulated(places: np.ndarray, rim: np.ndarray, edge: float) -> tuple[np.ndarray, np.ndarray]:
    # Faces inside the outline, and their areas; in the plane, Delaunay's are counter-clockwise already.
    faces = Delaunay(places).simplices.astype(np.int64)
    a, b, c = (places[faces[:, k]] for k in range(3))
    double = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    # Slivers along a straight side are neither inside nor outside; only area tells.
    kept = double > 1e-3 * edge**2
    outer = kept & (faces < len(rim)).all(axis=1)
    kept[outer] = _inside(places[faces[outer]].mean(axis=1), rim)
    return faces[kept], 0.5 * double[kept]
