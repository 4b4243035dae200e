"""Contraction: the rigid tiles of a deployed sheet laid flat and closed."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.linalg import splu

from kirisurf.arrays import group_means
from kirisurf.errors import UnusableError
from kirisurf.states import Contracted
from kirisurf.tessellation import Tessellation


def contract(
    tessellation: Tessellation,
    points: Float[np.ndarray, "n 3"],
    max_steps: int = 300,
    like: Float[np.ndarray, "n 2"] | None = None,
) -> Contracted:
    """Lay the tiles of a deployed sheet flat so that welded copies coincide.

    A spanning tree of tiles gives the start: each tile is placed by the slit edge it shares with the one
    before. Then

        minimize  sum over tiles and their vertices |x_w - (R_t p + c_t)|^2

    over welded positions x, rotations R and translations c (alternating: rotations in closed form, then one
    sparse solve), so that a closure error is spread instead of piling up at the end of the tree. What is
    returned is each tile's own rigid place, averaged over the tiles of a hinge; `gap` is what remains open.

    Parameters
    ----------
    tessellation : Tessellation
    points : (n, 3)
        Deployed vertices.
    max_steps : int
        Rounds of the alternation; it stops earlier where nothing moves.
    like : (n, 2), optional
        Points on which the sheet is laid by a rotation and a shift; by default the standard layout, about its middle.

    Raises
    ------
    UnusableError
        Where the tiles are not connected through slit edges.
    """
    flat = flat_tiles(tessellation, points)
    weld, indices = tessellation.weld, tessellation.tiles.indices
    owner = tessellation.tiles.owners
    placed = _spanning_tree_layout(tessellation, flat)
    t, w = tessellation.n_tiles, tessellation.n_welded
    corners = weld[indices]
    sizes = np.bincount(owner, minlength=t).astype(float)
    middles = group_means(flat, owner, t)
    centered = flat - middles[owner]
    # eliminating translations leaves the Laplacian of the graph tile - welded vertex
    incidence = coo_matrix((np.ones(len(corners)), (owner, corners)), shape=(t, w)).tocsr()
    degree = np.asarray(incidence.sum(axis=0)).ravel()
    laplacian = csr_matrix(coo_matrix((degree, (np.arange(w), np.arange(w))), shape=(w, w)))
    laplacian = laplacian - incidence.T @ incidence.multiply(1.0 / sizes[:, None])
    free = np.arange(1, w)
    factor = splu(laplacian[free][:, free].tocsc())
    welded = group_means(placed, corners, w)
    for _ in range(max_steps):
        turned = _turned(centered, welded[corners], owner, t)
        right = np.stack([np.bincount(corners, turned[:, i], w) for i in range(2)], axis=1)
        new = np.zeros((w, 2))
        new[free] = factor.solve(right[free])
        new += welded[0] - new[0]
        moved = np.abs(new - welded).max()
        welded = new
        if moved <= 1e-14 * np.ptp(welded):
            break
    turned = _turned(centered, welded[corners], owner, t)
    rigid = turned + group_means(welded[corners], owner, t)[owner]
    vertices = group_means(rigid, indices, tessellation.n_vertices)
    aligned = _aligned(vertices, tessellation.contracted if like is None else like, like is not None)
    copies = group_means(aligned, weld, w)
    return Contracted(points=aligned, gap=np.linalg.norm(aligned - copies[weld], axis=1))


def flat_tiles(tessellation: Tessellation, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "s 2"]:
    """Coordinates of every tile corner in its own tile's best plane, seen from the front, (s, 2)."""
    result = np.zeros((len(tessellation.tiles.indices), 2))
    for _, (which, loops) in tessellation.tiles.by_size().items():
        corner = points[loops]
        centered = corner - corner.mean(axis=1, keepdims=True)
        newell = 0.5 * np.cross(centered, np.roll(centered, -1, axis=1)).sum(axis=1)
        normal = newell / np.linalg.norm(newell, axis=1, keepdims=True)
        first = centered[:, 1] - centered[:, 0]
        first -= np.einsum("ti,ti->t", first, normal)[:, None] * normal
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        second = np.cross(normal, first)
        local = np.stack([np.einsum("tki,ti->tk", centered, axis) for axis in (first, second)], axis=2)
        place = tessellation.tiles.offsets[which][:, None] + np.arange(loops.shape[1])
        result[place] = local
    return result


def _spanning_tree_layout(tessellation: Tessellation, flat: np.ndarray) -> np.ndarray:
    """Place tiles one after the other along shared slit edges, (s, 2)."""
    pairs, t = _shared_edges(tessellation)
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(t, t)).tocsr()
    graph = graph + graph.T
    # starting in the middle keeps the tree shallow
    order, before = breadth_first_order(graph, int(np.argmax(_depth_score(tessellation))), directed=False)
    if len(order) < t:
        raise UnusableError(f"tessellation: expected one connected sheet, got {t - len(order)} tiles apart from it")
    edge = {(int(a), int(b)): (int(i), int(j)) for a, b, i, j in pairs}
    edge.update({(b, a): (j, i) for (a, b), (i, j) in list(edge.items())})
    offsets = tessellation.tiles.offsets
    z = flat[:, 0] + 1j * flat[:, 1]
    placed = np.zeros_like(z)
    first = int(order[0])
    placed[offsets[first] : offsets[first + 1]] = z[offsets[first] : offsets[first + 1]]
    following = _following(tessellation)
    for tile in order[1:].tolist():
        parent = int(before[tile])
        i, j = edge[(parent, tile)]
        # corner i of the parent starts its copy of the edge, corner j of the tile starts the opposite copy
        a, b = placed[i], placed[following[i]]
        c, d = z[following[j]], z[j]
        turn = (b - a) / (d - c)
        part = slice(offsets[tile], offsets[tile + 1])
        placed[part] = 0.5 * (a + b) + turn / abs(turn) * (z[part] - 0.5 * (c + d))
    return np.stack([placed.real, placed.imag], axis=1)


def _shared_edges(tessellation: Tessellation) -> tuple[np.ndarray, int]:
    """Rows (tile, other tile, corner at the start of its edge, of the other's edge) for every slit edge."""
    start, end = tessellation.tiles.indices, tessellation.tiles.successors
    n = tessellation.n_vertices
    position = {int(k): i for i, k in enumerate(start * n + end)}
    pairs = tessellation.edge_pairs
    first = [position[int(k)] for k in pairs[:, 0, 0] * n + pairs[:, 0, 1]]
    second = [position[int(k)] for k in pairs[:, 1, 1] * n + pairs[:, 1, 0]]
    owner = tessellation.tiles.owners
    rows = np.stack([owner[first], owner[second], first, second], axis=1) if len(pairs) else np.zeros((0, 4), np.int64)
    return rows, tessellation.n_tiles


def _following(tessellation: Tessellation) -> np.ndarray:
    position = np.arange(len(tessellation.tiles.indices)) + 1
    position[tessellation.tiles.offsets[1:] - 1] = tessellation.tiles.offsets[:-1]
    return position


def _depth_score(tessellation: Tessellation) -> np.ndarray:
    """Closeness of every tile to the middle of the standard contracted layout."""
    middle = group_means(
        tessellation.contracted[tessellation.tiles.indices], tessellation.tiles.owners, tessellation.n_tiles
    )
    return -np.round(np.linalg.norm(middle - middle.mean(axis=0), axis=1), 9)


def _turned(centered: np.ndarray, goal: np.ndarray, owner: np.ndarray, t: int) -> np.ndarray:
    """Tiles about their middles, turned to match `goal` best, (s, 2)."""
    z, g = centered[:, 0] + 1j * centered[:, 1], goal[:, 0] + 1j * goal[:, 1]
    product = np.conj(z) * g
    turn = np.bincount(owner, product.real, t) + 1j * np.bincount(owner, product.imag, t)
    turn /= np.abs(turn)
    result = turn[owner] * z
    return np.stack([result.real, result.imag], axis=1)


def _aligned(points: np.ndarray, standard: np.ndarray, in_place: bool) -> np.ndarray:
    """Turn a layout like the standard one (slits along the axes) and move it onto it, or to the first quadrant."""
    centered, goal = points - points.mean(axis=0), standard - standard.mean(axis=0)
    z, g = centered[:, 0] + 1j * centered[:, 1], goal[:, 0] + 1j * goal[:, 1]
    turn = (np.conj(z) * g).sum()
    z = z * (turn / abs(turn))
    turned = np.stack([z.real, z.imag], axis=1)
    return turned + standard.mean(axis=0) if in_place else turned - turned.min(axis=0)
