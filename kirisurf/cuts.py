"""The cut pattern: the lines that a cutter follows in the flat sheet, each slit once.

A slit runs from hinge to hinge, or from the rim to a hinge. At a hinge it stops short, so that a ligament
of the hinge width remains between its tip and the slit (or the rim) across it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from kirisurf.arrays import checked, frozen
from kirisurf.errors import ParameterError
from kirisurf.tessellation import Tessellation

_AUTOMATIC_WIDTH = 0.04  # of the median tile edge: holds paper and thin sheet, and leaves the tiles rigid
_LONGEST_TIP = 0.5  # a hinge may take at most this part of the slit's last edge


@dataclass(frozen=True, eq=False)
class Cuts:
    """The lines of a flat sheet.

    Attributes
    ----------
    slits : tuple of (k, 2) arrays
        One open polyline for every slit, shortened at its hinges, in the units of the points.
    hinges : (m, 2)
        Middle of the ligament at every hinge end of a slit.
    outline : (o, 2)
        Outer contour, counter-clockwise, not closed by a repeated point.
    hinge_width : float
        Length by which every hinge end of a slit is shortened, in the units of the points.
    """

    slits: tuple[np.ndarray, ...]
    hinges: Float[np.ndarray, "m 2"]
    outline: Float[np.ndarray, "o 2"]
    hinge_width: float


def cuts(tessellation: Tessellation, contracted: np.ndarray, hinge_width: float | None = None) -> Cuts:
    """Return the cut lines of a contracted sheet.

    Parameters
    ----------
    tessellation : Tessellation
    contracted : (n, 2)
        Contracted points; the copies of a welded vertex are averaged.
    hinge_width : float, optional
        In the units of the points; by default 4 % of the median tile edge, less where slits are short.

    Raises
    ------
    ParameterError
        Where the hinges would be longer than half of the last edge of a slit.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> len(cuts(pattern, pattern.contracted).slits)
    15
    """
    points = _welded_points(tessellation, checked(contracted, "contracted points", (tessellation.n_vertices, 2)))
    edges = tessellation.weld[tessellation.edge_pairs[:, 0]]
    ends, groups = _slit_ends(tessellation), _slit_groups(tessellation)
    tips = np.array([edge for edge, _ in ends], np.int64)
    lengths = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    width = _checked_width(hinge_width, tessellation, points, lengths[tips])

    at_end = {(edge, vertex) for edge, vertex in ends}
    slits, hinges = [], []
    for group in groups:
        for path, used in _paths(edges, group):
            line = points[path].copy()
            for edge, vertex, tip, inner in ((used[0], path[0], 0, 1), (used[-1], path[-1], -1, -2)):
                if (edge, vertex) in at_end:
                    direction = points[path[inner]] - points[vertex]
                    direction /= np.linalg.norm(direction)
                    line[tip] = points[vertex] + width * direction
                    hinges.append(points[vertex] + 0.5 * width * direction)
            slits.append(frozen(line))
    return Cuts(tuple(slits), frozen(np.array(hinges).reshape(-1, 2)), frozen(_outline(tessellation, points)), width)


def _welded_points(tessellation: Tessellation, contracted: np.ndarray) -> np.ndarray:
    """Mean (w, 2) of the copies of every welded vertex."""
    weld, n = tessellation.weld, tessellation.n_welded
    count = np.bincount(weld, minlength=n)[:, None]
    return np.stack([np.bincount(weld, contracted[:, axis], n) for axis in range(2)], axis=1) / count


def _slit_of_side(tessellation: Tessellation) -> dict[tuple[int, int], int]:
    """Slit edge of every directed tile side that is one of its two copies."""
    sides = {}
    for k, ((a, b), (c, d)) in enumerate(tessellation.edge_pairs.tolist()):
        sides[a, b] = sides[d, c] = k
    return sides


def _slit_ends(tessellation: Tessellation) -> list[tuple[int, int]]:
    """(slit edge, welded vertex) of every hinge that a slit runs into."""
    sides = _slit_of_side(tessellation)
    closing = tessellation.hinges[tessellation.slit_ends].tolist()
    return [(sides[before, hinge], int(tessellation.weld[hinge])) for before, hinge, *_ in closing]


def _slit_groups(tessellation: Tessellation) -> list[np.ndarray]:
    """Slit edges that bound one hole or one notch, (g,) int each, in order of their smallest edge.

    Following the boundary of the deployed sheet from one side to the next never leaves a hole; where both
    sides are copies of slit edges, the two edges belong to one cut.
    """
    sides = _slit_of_side(tessellation)
    n = len(tessellation.edge_pairs)
    corners = tessellation.corners
    alone = corners[np.bincount(corners[:, 1], minlength=tessellation.n_vertices)[corners[:, 1]] == 1]
    links = [
        (sides[a, b], sides[b, c])
        for a, b, c in np.concatenate([tessellation.hinges[:, :3], alone]).tolist()
        if (a, b) in sides and (b, c) in sides
    ]
    pairs = np.array(links, np.int64).reshape(-1, 2)
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    count, labels = connected_components(graph, directed=False)
    groups = [np.flatnonzero(labels == label) for label in range(count)]
    return sorted(groups, key=lambda group: int(group[0]))


def _paths(edges: np.ndarray, group: np.ndarray) -> list[tuple[list[int], list[int]]]:
    """Cover the tree of slit edges by paths from leaf to leaf, each edge once: (vertices, edges) of each."""
    around: dict[int, list[tuple[int, int]]] = {}
    for k in group.tolist():
        a, b = edges[k].tolist()
        around.setdefault(a, []).append((k, b))
        around.setdefault(b, []).append((k, a))
    free, paths = set(group.tolist()), []
    while free:
        degree = {v: sum(k in free for k, _ in near) for v, near in around.items()}
        starts = [v for v, d in degree.items() if d % 2 == 1] or [v for v, d in degree.items() if d]
        here = min(starts)
        path, used = [here], []
        while True:
            following = [(k, v) for k, v in around[here] if k in free]
            if not following:
                break
            edge, here = following[0]
            free.discard(edge)
            path.append(here)
            used.append(edge)
        paths.append((path, used))
    return paths


def _outline(tessellation: Tessellation, points: np.ndarray) -> np.ndarray:
    loop = tessellation.weld[tessellation.outline]
    return points[loop[loop != np.roll(loop, 1)]]


def _checked_width(
    width: float | None, tessellation: Tessellation, points: np.ndarray, tip_lengths: np.ndarray
) -> float:
    tiles = tessellation.tiles
    edge = points[tessellation.weld[tiles.successors]] - points[tessellation.weld[tiles.indices]]
    median = float(np.median(np.linalg.norm(edge, axis=1)))
    longest = _LONGEST_TIP * float(tip_lengths.min()) if len(tip_lengths) else np.inf
    if width is None:
        return min(_AUTOMATIC_WIDTH * median, 0.5 * longest)
    if not np.isfinite(width) or not 0 < width <= longest:
        raise ParameterError(
            f"--hinge-width: expected more than 0 and at most {longest:.6g} (half of the shortest last edge of a slit; "
            f"the median tile edge is {median:.6g}), got {width:.6g}"
        )
    return float(width)
