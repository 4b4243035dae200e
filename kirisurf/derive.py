"""Everything that follows from tiles and welding: slits, rings, holes, hinges, the outline.

The derivation is purely topological but for two things read from the contracted layout: the cyclic order of
the tiles that share a vertex, and which closed curve of the rim is the outside (counter-clockwise) and which
is an opening that stays in the contracted sheet (clockwise).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from kirisurf.arrays import frozen
from kirisurf.errors import UnusableError
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation


def derive_tessellation(
    deployed: np.ndarray,
    contracted: np.ndarray,
    tiles: Loops,
    weld: np.ndarray,
    cells: np.ndarray | None = None,
    name: str = "quad",
) -> Tessellation:
    """Build a tessellation from its tiles and the welding of its vertices.

    Parameters
    ----------
    deployed, contracted : (n, 2)
        Standard layouts.
    tiles : Loops
        Counter-clockwise vertex loops.
    weld : (n,) int
        Contracted vertex of every vertex; any labels.
    cells : (t, 3) int, optional
        Unit cell (column, row) and number within the cell of every tile; by default all in one cell.

    Raises
    ------
    UnusableError
        Where three or more tiles meet along one contracted edge, or two with the same direction.
    """
    weld = np.unique(np.asarray(weld, dtype=np.int64), return_inverse=True)[1].ravel()
    start, end = tiles.indices, tiles.successors
    twin = _twins(weld[start], weld[end], int(weld.max()) + 1 if len(weld) else 0)
    corners = np.stack([_predecessors(tiles), start, end], axis=1)
    following = _next_around(corners, np.asarray(contracted))
    # position of the half-edge start -> end equals the position of the corner at `start`
    at_end = _successor_positions(tiles)
    succ = following[at_end]

    rim = twin < 0
    slit_half = np.flatnonzero(~rim & (np.arange(len(twin)) < twin))
    pairs = np.stack(
        [
            np.stack([start[slit_half], end[slit_half]], axis=1),
            np.stack([end[twin[slit_half]], start[twin[slit_half]]], axis=1),
        ],
        axis=1,
    )
    hinged = np.flatnonzero(following != np.arange(len(following)))
    other = following[hinged]
    first, second = corners[hinged], corners[other]
    hinges = np.stack([first[:, 0], first[:, 1], second[:, 2], second[:, 0], first[:, 2]], axis=1)

    holes, hole_tiles, openings, outlines = _trace(succ, start, end, rim, tiles.owners, np.asarray(contracted))
    rings, ring_vertices = _rings(weld, start, end, rim)
    outline = max(outlines, key=len) if outlines else np.zeros(0, np.int64)
    cells = np.stack([np.zeros(len(tiles)), np.zeros(len(tiles)), np.arange(len(tiles))], 1) if cells is None else cells
    return Tessellation(
        deployed=frozen(deployed),
        contracted=frozen(contracted),
        weld=frozen(weld, np.int64),
        tiles=tiles,
        cells=frozen(cells, np.int64),
        edge_pairs=frozen(pairs, np.int64),
        corners=frozen(corners, np.int64),
        rings=rings,
        ring_vertices=frozen(ring_vertices, np.int64),
        holes=holes,
        hole_tiles=hole_tiles,
        openings=openings,
        hinges=frozen(hinges, np.int64),
        slit_ends=frozen(weld[hinges[:, 0]] == weld[hinges[:, 2]], np.bool_),
        outline=frozen(outline, np.int64),
        sides=_sides(outline, np.asarray(contracted)),
        name=name,
    )


def n_outer_loops(tessellation: Tessellation) -> int:
    """Number of closed boundary curves of the contracted sheet.

    1 for a disk, more where it is pinched, in pieces, or pierced; openings that stay on contraction count too.
    """
    weld = tessellation.weld
    start, end = tessellation.tiles.indices, tessellation.tiles.successors
    rim = _twins(weld[start], weld[end], tessellation.n_welded) < 0
    following = _next_around(tessellation.corners, tessellation.contracted)
    succ = following[_successor_positions(tessellation.tiles)]
    contracted = tessellation.contracted
    openings, outlines = _trace(succ, start, end, rim, tessellation.tiles.owners, contracted)[2:]
    return int((openings.sizes > 0).sum()) + len(outlines)


def _twins(a: np.ndarray, b: np.ndarray, n: int) -> np.ndarray:
    """Position of the opposite contracted half-edge of every half-edge, -1 on the rim."""
    forward, backward = a * n + b, b * n + a
    order = np.argsort(forward, kind="stable")
    ordered = forward[order]
    if (ordered[1:] == ordered[:-1]).any():
        raise UnusableError(
            "tessellation: expected at most two tiles along a contracted edge, in opposite directions; "
            "got more, or tiles of opposite orientation"
        )
    place = np.searchsorted(ordered, backward)
    place = np.minimum(place, max(len(ordered) - 1, 0))
    return np.where(ordered[place] == backward, order[place], -1) if len(ordered) else np.zeros(0, np.int64)


def _predecessors(tiles: Loops) -> np.ndarray:
    previous = np.empty_like(tiles.indices)
    previous[_successor_positions(tiles)] = tiles.indices
    return previous


def _successor_positions(tiles: Loops) -> np.ndarray:
    position = np.arange(len(tiles.indices)) + 1
    position[tiles.offsets[1:] - 1] = tiles.offsets[:-1]
    return position


def _next_around(corners: np.ndarray, contracted: np.ndarray) -> np.ndarray:
    """Corner that follows every corner counter-clockwise about its vertex (itself where it is alone)."""
    direction = contracted[corners[:, 2]] - contracted[corners[:, 1]]
    angle = np.arctan2(direction[:, 1], direction[:, 0])
    order = np.lexsort((angle, corners[:, 1]))
    vertex = corners[order, 1]
    first = np.flatnonzero(np.r_[True, vertex[1:] != vertex[:-1]])
    last = np.r_[first[1:] - 1, len(order) - 1]
    successor = np.r_[order[1:], order[:1]]
    successor[last] = order[first]
    result = np.empty(len(corners), np.int64)
    result[order] = successor
    return result


def _trace(
    succ: np.ndarray, start: np.ndarray, end: np.ndarray, rim: np.ndarray, owners: np.ndarray, contracted: np.ndarray
) -> tuple[Loops, Loops, Loops, list[np.ndarray]]:
    """Follow the boundary of the deployed sheet: holes, the tiles and the open sides round them, outer curves."""
    seen = np.zeros(len(succ), bool)
    following = succ.tolist()
    holes, around, openings, outlines = [], [], [], []
    for first in range(len(following)):
        if seen[first]:
            continue
        path, here = [], first
        while not seen[here]:
            seen[here] = True
            path.append(here)
            here = following[here]
        loop = np.array(path)
        if rim[loop].any() and _area(contracted[start[loop]]) >= 0:
            # only the ends of rim edges: the inner vertex of a notch is skipped, which fills the notch
            ends = np.stack([start[loop], end[loop]], axis=1)[rim[loop]].ravel()
            keep = ends != np.roll(ends, 1)
            outlines.append(ends[keep])
        else:
            loop = loop[::-1]
            holes.append(start[loop])
            openings.append(loop[rim[loop]])
            tiles = owners[loop]
            around.append(tiles[np.sort(np.unique(tiles, return_index=True)[1])])
    return Loops.from_lists(holes), Loops.from_lists(around), Loops.from_lists(openings), outlines


def _area(corners: np.ndarray) -> float:
    """Signed area of a polygon: what slits enclose cancels."""
    p = corners - corners[0]
    q = np.roll(p, -1, axis=0)
    return float(0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())


def _rings(weld: np.ndarray, start: np.ndarray, end: np.ndarray, rim: np.ndarray) -> tuple[Loops, np.ndarray]:
    """Corners round every interior contracted vertex."""
    at = weld[start]
    on_rim = np.zeros(int(weld.max()) + 1 if len(weld) else 0, bool)
    on_rim[at[rim]] = True
    on_rim[weld[end[rim]]] = True
    inner = np.flatnonzero(~on_rim[at])
    order = inner[np.argsort(at[inner], kind="stable")]
    vertices, counts = np.unique(at[order], return_counts=True)
    return Loops(frozen(np.r_[0, np.cumsum(counts)], np.int64), frozen(order, np.int64)), vertices


def _sides(outline: np.ndarray, contracted: np.ndarray) -> Mapping[str, np.ndarray]:
    """Sides of the contracted outline: four for a rectangle along the axes, else the outline as a whole."""
    if not len(outline):
        return {}
    xy = contracted[outline]
    low, high = xy.min(axis=0), xy.max(axis=0)
    near = 1e-9 * float((high - low).max())
    found = {
        "bottom": np.abs(xy[:, 1] - low[1]) <= near,
        "right": np.abs(xy[:, 0] - high[0]) <= near,
        "top": np.abs(xy[:, 1] - high[1]) <= near,
        "left": np.abs(xy[:, 0] - low[0]) <= near,
    }
    if not np.logical_or.reduce(list(found.values())).all():
        return {"outline": frozen(outline, np.int64)}
    return {name: frozen(outline[which], np.int64) for name, which in found.items()}
