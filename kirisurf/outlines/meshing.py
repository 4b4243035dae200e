"""The inside of an outline as a flat surface of well-shaped triangles."""

from __future__ import annotations

import math

import numpy as np
import shapely
from jaxtyping import Float, Int
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay, QhullError, cKDTree

from kirisurf.errors import ParameterError, UnusableError
from kirisurf.outlines.outline import Outline
from kirisurf.surface import Surface

DEFAULT_PARTS = 80
"""Edges along the diagonal of an outline, by default."""

_MOST_VERTICES = 2_000_000
_SMOOTHING_STEPS = 8
_MOST_HALVES = 100_000
"""Vertices of the rim from which on an outline counts as too narrow for its size."""

_ROUNDS = 40
"""Rounds of halving edges of the rim; each halves only those that Delaunay's triangles cut."""

_CLEARANCE = 0.6
"""Edges between the rim and the first inner vertex, at least."""

_RIM_TURN = 0.35
"""Radians that the curve turns along one edge of the rim, at most."""


def planar_surface(outline: Outline, edge: float | None = None) -> Surface:
    """Triangulate the inside of an outline: z = 0, normals upwards.

    The vertices of the rim lie on the curve and on every corner; they come first, in order. Where the outline
    is narrower than an edge, or turns within one, edges of the rim are shorter.

    Parameters
    ----------
    outline : Outline
    edge : float, optional
        Length of the edges, in the outline's unit; by default 1/80 of its diagonal.

    Raises
    ------
    ParameterError
        Where the edge is not positive, or so short that the mesh would be huge.
    UnusableError
        Where the outline is too narrow somewhere to be triangulated.

    Examples
    --------
    >>> from kirisurf.outlines.named import outline
    >>> surface = planar_surface(outline("disc"), edge=0.1)
    >>> bool(np.allclose(surface.normals, (0, 0, 1)))
    True
    """
    wanted = outline.diagonal / DEFAULT_PARTS if edge is None else float(edge)
    least = math.sqrt(outline.area / _MOST_VERTICES)
    if not (wanted > least and math.isfinite(wanted)):
        raise ParameterError(f"edge: expected more than {least:.3g}, got {wanted:g}")
    parameters = _rim_parameters(outline, wanted)
    rim = outline.curve.points(parameters)
    inner = _lattice(outline, rim, wanted)
    for _ in range(_SMOOTHING_STEPS):
        inner = _smoothed(rim, inner)
    places, faces, n_rim = _conforming(outline, parameters, inner)
    used = np.unique(np.concatenate([np.arange(n_rim), faces.ravel()]))
    renumbered = np.full(len(places), -1)
    renumbered[used] = np.arange(len(used))
    vertices = np.concatenate([places[used], np.zeros((len(used), 1))], axis=1)
    return Surface.from_arrays(vertices, renumbered[faces], outline.name)


def _rim_parameters(outline: Outline, edge: float) -> Float[np.ndarray, " b"]:
    # Of the whole curve, increasing: even along every side, and more where it turns fast.
    parts = []
    for offset, side in zip(outline.offsets[:-1], outline.sides, strict=True):
        least = 6 if outline.is_smooth else 2
        u = side.evenly(max(least, math.ceil(side.length / edge)))
        while len(u) < _MOST_HALVES:
            pieces, s = side.located(u)
            s = np.where(pieces + s >= side.n_pieces, 1.0, s)
            tangents = side.tangents(pieces, s)
            turns = np.arccos(np.clip((tangents[:-1] * tangents[1:]).sum(axis=1), -1.0, 1.0))
            # A kink between two straight pieces cannot be cut finer.
            sharp = (turns > _RIM_TURN) & (np.diff(u) > 1e-3)
            if not sharp.any():
                break
            u = np.sort(np.concatenate([u, 0.5 * (u[:-1] + u[1:])[sharp]]))
        parts.append(u[:-1] + offset)
    return np.concatenate(parts)


def _lattice(outline: Outline, rim: np.ndarray, edge: float) -> Float[np.ndarray, "i 2"]:
    low, high = outline.box
    center, half = 0.5 * (low + high), 0.5 * (high - low)
    height = edge * math.sqrt(0.75)
    n, m = math.ceil(half[0] / edge) + 1, math.ceil(half[1] / height) + 1
    column, row = np.meshgrid(np.arange(-n, n + 1), np.arange(-m, m + 1))
    places = center + np.stack([edge * (column + 0.5 * (row % 2)), height * row], axis=-1).reshape(-1, 2)
    polygon = shapely.Polygon(rim) if len(rim) > 2 else outline.polygon
    shapely.prepare(polygon)
    places = places[shapely.contains_xy(polygon, places)]
    away, _ = cKDTree(outline.polyline(edge / 8)).query(places)
    return places[away > _CLEARANCE * edge]


def _smoothed(rim: np.ndarray, inner: np.ndarray) -> np.ndarray:
    # Every inner vertex moves to the centroid of the triangles round it, where its star does not leave the inside.
    if not len(inner):
        return inner
    places = np.concatenate([rim, inner])
    faces = _inside(_delaunay(places), len(rim))
    corners = places[faces]
    area = _double_areas(corners)
    total, weight = np.zeros_like(places), np.zeros(len(places))
    for k in range(3):
        np.add.at(total, faces[:, k], area[:, None] * corners.mean(axis=1))
        np.add.at(weight, faces[:, k], area)
    moved = total[len(rim) :] / np.where(weight[len(rim) :] > 0, weight[len(rim) :], 1.0)[:, None]
    return moved[weight[len(rim) :] > 0]


def _conforming(
    outline: Outline, parameters: np.ndarray, inner: np.ndarray
) -> tuple[Float[np.ndarray, "v 2"], Int[np.ndarray, "f 3"], int]:
    # Edges of the rim that no triangle has are halved on the curve until all are there.
    last = float(outline.curve.n_pieces)
    most = max(_MOST_HALVES, 20 * len(parameters))
    for _ in range(_ROUNDS):
        rim = outline.curve.points(parameters)
        n = len(rim)
        places = np.concatenate([rim, inner])
        simplices = _delaunay(places)
        edges = simplices[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        keys = np.unique(np.sort(edges, axis=1) @ np.array([len(places), 1]))
        here = np.stack([np.arange(n), (np.arange(n) + 1) % n], axis=1)
        missing = ~np.isin(np.sort(here, axis=1) @ np.array([len(places), 1]), keys)
        if not missing.any():
            faces = _inside(simplices, n)
            if len(faces) and _double_areas(places[faces]).min() > 0:
                return places, faces, n
            break
        ends = np.append(parameters[1:], last + parameters[0])
        halves = 0.5 * (parameters + ends)[missing]
        parameters = np.sort(np.concatenate([parameters, np.where(halves >= last, halves - last, halves)]))
        if len(parameters) > most:
            break
    raise UnusableError(
        f"{outline.name}: expected an outline that triangles fill, got one that is too narrow somewhere: "
        "ask for shorter edges, or widen its narrowest part"
    )


def _delaunay(places: np.ndarray) -> Int[np.ndarray, "f 3"]:
    try:
        return Delaunay(places - places.mean(axis=0)).simplices.astype(np.int64)
    except QhullError:
        raise UnusableError("outline: expected points round an area, got all on one line") from None


def _inside(faces: np.ndarray, n_rim: int) -> Int[np.ndarray, "f 3"]:
    # Faces that reach one another without crossing the rim are on one side of it: the inside is on the left of
    # its edges. No coordinates, so that rounding has no say about slivers at straight sides.
    directed = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    owner = np.repeat(np.arange(len(faces)), 3)
    a, b = directed.T
    on_rim = (a < n_rim) & (b < n_rim)
    left = on_rim & (b == (a + 1) % n_rim)
    right = on_rim & (a == (b + 1) % n_rim)
    inner = ~(left | right)
    keys = np.sort(directed[inner], axis=1) @ np.array([int(faces.max()) + 1, 1])
    order = np.argsort(keys, kind="stable")
    same = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    one, two = owner[inner][order[same]], owner[inner][order[same + 1]]
    n = len(faces)
    _, label = connected_components(coo_matrix((np.ones(len(one)), (one, two)), shape=(n, n)), directed=False)
    votes = np.bincount(label[owner[left]], minlength=n) - np.bincount(label[owner[right]], minlength=n)
    return faces[votes[label] > 0]


def _double_areas(corners: np.ndarray) -> np.ndarray:
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
