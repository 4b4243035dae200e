"""The fronts of a sparse Cholesky factorization: a tree of dense pieces, found from the pattern alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pymetis
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee

_WIDTH = 3  # unknowns of a vertex
_FRONT_SECONDS = 100e-6  # what a front costs however small it is: calls, views, some fifty additions of slices
_PIVOT_RATE = 25e9  # flops a second of dpotrf and dtrsm on fronts of this size
_UPDATE_RATE = 42e9  # the same of dsyrk
_ADD_SECONDS = 1.5e-9  # adding one entry of an update matrix into the front above
_STORE_SECONDS = 1e-9  # clearing and writing one entry of the factor


@dataclass(frozen=True)
class Fronts:
    """Dense pieces of a factor, children before parents, in vertices.

    Attributes
    ----------
    order
        (n,) vertex that stands at each position of the elimination order.
    starts
        (f + 1,) front i eliminates the positions starts[i] up to starts[i + 1].
    rows
        Per front, the sorted positions below its pivots that it updates.
    parents
        (f,) front that takes the update of front i, or -1.
    """

    order: np.ndarray
    starts: np.ndarray
    rows: list[np.ndarray]
    parents: np.ndarray


def find_fronts(n: int, rows: np.ndarray, columns: np.ndarray) -> Fronts:
    """Return the fronts of a symmetric pattern.

    Parameters
    ----------
    n
        Number of vertices.
    rows, columns
        (p,) vertices of the entries, of both halves; the diagonal may be among them.
    """
    off = rows != columns
    graph = csr_matrix((np.ones(int(off.sum()), dtype=np.int8), (rows[off], columns[off])), shape=(n, n))
    order = _nested_dissection(graph)
    below, parents = _column_structures(graph, order)
    pivots, children, roots = _amalgamate(below, parents)
    return _number(graph, order, below, pivots, children, roots)


def _nested_dissection(graph: csr_matrix) -> np.ndarray:
    if graph.nnz == 0:  # METIS wants an edge
        return np.arange(graph.shape[0])
    adjacency = pymetis.CSRAdjacency(graph.indptr.tolist(), graph.indices.tolist())
    return np.asarray(pymetis.nested_dissection(adjacency)[0], dtype=np.int64)


def _column_structures(graph: csr_matrix, order: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
    """Return the sorted rows below the diagonal of each column of the factor, and the elimination tree."""
    n = len(order)
    position = np.argsort(order)
    entries = graph.tocoo()
    row, column = position[entries.row], position[entries.col]
    lower = row > column
    key = np.sort(column[lower] * n + row[lower])
    row, first = key % n, np.searchsorted(key, n * np.arange(n + 1)).tolist()
    below: list[np.ndarray] = []
    children: list[list[int]] = [[] for _ in range(n)]
    parents = np.full(n, -1, dtype=np.int64)
    for j in range(n):
        structure = row[first[j] : first[j + 1]]
        if children[j]:
            structure = np.concatenate([structure, *(below[child][1:] for child in children[j])])
            structure.sort()
            if len(structure):
                fresh = np.empty(len(structure), dtype=bool)
                fresh[0] = True
                np.not_equal(structure[1:], structure[:-1], out=fresh[1:])
                structure = structure[fresh]
        below.append(structure)
        if len(structure):
            parents[j] = structure[0]
            children[structure[0]].append(j)
    return below, parents


def _seconds(pivots: int, rows: int) -> float:
    """Return what a front of so many vertices costs; its absolute value matters less than its shape."""
    k, m = _WIDTH * pivots, _WIDTH * rows
    flops = (k * k * k / 3 + k * k * m) / _PIVOT_RATE + k * m * m / _UPDATE_RATE
    return _FRONT_SECONDS + flops + _ADD_SECONDS * m * m + _STORE_SECONDS * k * (k + m)


def _amalgamate(
    below: list[np.ndarray], parents: np.ndarray
) -> tuple[dict[int, list[int]], dict[int, list[int]], list[int]]:
    """Merge columns into fronts wherever the larger front is the cheaper one.

    A child may join its parent whether or not the structures agree: the zeros between them are then
    stored and computed. Fundamental supernodes are the case in which that costs nothing.
    """
    n = len(below)
    pivots = {j: [j] for j in range(n)}
    children: dict[int, list[int]] = {j: [] for j in range(n)}
    for j, parent in enumerate(parents.tolist()):
        if parent >= 0:
            children[parent].append(j)
    seconds = {}
    for j in range(n):
        rows = len(below[j])
        seconds[j] = _seconds(1, rows)
        kept = []
        for child in sorted(children[j], key=lambda c: (-len(below[c]), c)):
            merged = _seconds(len(pivots[j]) + len(pivots[child]), rows)
            if merged <= seconds[j] + seconds[child]:
                seconds[j] = merged
                pivots[j] = pivots.pop(child) + pivots[j]
                kept += children.pop(child)
            else:
                kept.append(child)
        children[j] = kept
    return pivots, children, np.flatnonzero(parents < 0).tolist()


def _number(
    graph: csr_matrix,
    order: np.ndarray,
    below: list[np.ndarray],
    pivots: dict[int, list[int]],
    children: dict[int, list[int]],
    roots: list[int],
) -> Fronts:
    """Number the fronts in postorder, and the pivots of each such that rows come in runs."""
    # Children with large updates first: fewer of them wait on the stack at a time.
    post: list[int] = []
    stack = list(roots)
    while stack:
        front = stack.pop()
        post.append(front)
        stack += sorted(children[front], key=lambda c: (len(below[c]), c), reverse=True)
    post.reverse()
    # Any order of the pivots of a front fills the same. Along the separator is the order in which those
    # below, each next to a piece of it, touch an interval, and their updates are added by slices.
    moved = []
    for front in post:
        members = np.asarray(pivots[front])
        if len(members) > 2 and children[front]:
            vertices = order[members]
            inside = graph[vertices][:, vertices].tocsr()
            members = members[reverse_cuthill_mckee(inside, symmetric_mode=True)]
        moved.append(members)
    new_from_old = np.argsort(np.concatenate(moved))
    index = {front: i for i, front in enumerate(post)}
    parents = np.full(len(post), -1, dtype=np.int64)
    for front in post:
        for child in children[front]:
            parents[index[child]] = index[front]
    return Fronts(
        order=order[np.concatenate(moved)],
        starts=np.concatenate([[0], np.cumsum([len(members) for members in moved])]),
        rows=[np.sort(new_from_old[below[front]]) for front in post],
        parents=parents,
    )
