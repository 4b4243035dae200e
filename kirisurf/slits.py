"""Slits as paths: which slit edges are cut in one stroke, and where a stroke ends at a hinge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from kirisurf.tessellation import Tessellation

_Node = tuple[int, int]  # welded vertex, and the slit edge that ends in a hinge there (-1: no hinge)


@dataclass(frozen=True)
class SlitPath:
    """One stroke of the cutter, before its hinges are left standing.

    Attributes
    ----------
    vertices : tuple of int
        Welded vertices.
    starts_at_hinge, ends_at_hinge : bool
        Elsewhere the path ends at the rim, or in the middle of another stroke of the same slit.
    """

    vertices: tuple[int, ...]
    starts_at_hinge: bool
    ends_at_hinge: bool


def slit_paths(tessellation: Tessellation) -> list[SlitPath]:
    """Cover all slits by paths, each slit edge once; a path never runs through a hinge."""
    edges = tessellation.weld[tessellation.edge_pairs[:, 0]]
    at_hinge = set(_hinge_ends(tessellation))
    paths = []
    for group in _slit_groups(tessellation):
        nodes = {
            int(k): tuple((int(v), int(k) if (int(k), int(v)) in at_hinge else -1) for v in edges[k]) for k in group
        }
        for path in _paths(nodes):
            paths.append(SlitPath(tuple(v for v, _ in path), path[0][1] >= 0, path[-1][1] >= 0))
    return paths


def _slit_of_side(tessellation: Tessellation) -> dict[tuple[int, int], int]:
    """Slit edge of every directed tile side that is one of its two copies."""
    sides = {}
    for k, ((a, b), (c, d)) in enumerate(tessellation.edge_pairs.tolist()):
        sides[a, b] = sides[d, c] = k
    return sides


def _hinge_ends(tessellation: Tessellation) -> list[tuple[int, int]]:
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


def _paths(nodes: dict[int, tuple[_Node, ...]]) -> list[list[_Node]]:
    """Cover the tree of slit edges {edge: its two nodes} by paths from leaf to leaf."""
    around: dict[_Node, list[tuple[int, _Node]]] = {}
    for k, (a, b) in nodes.items():
        around.setdefault(a, []).append((k, b))
        around.setdefault(b, []).append((k, a))
    free, paths = set(nodes), []
    while free:
        degree = {v: sum(k in free for k, _ in near) for v, near in around.items()}
        starts = [v for v, d in degree.items() if d % 2 == 1] or [v for v, d in degree.items() if d]
        here = min(starts)
        path = [here]
        while following := [(k, v) for k, v in around[here] if k in free]:
            edge, here = following[0]
            free.discard(edge)
            path.append(here)
        paths.append(path)
    return paths
