"""The flat cut pattern as triangles with six nodes: tiles that hang together by their ligaments and nowhere else.

Every slit is a cut without width. Its two sides have nodes of their own, at the same places, but for the ligament at
each of its hinge ends, which both tiles share. A mesh of each tile alone, with the sides divided alike from either
tile, is therefore all there is to make.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from kirisurf.arrays import checked, frozen
from kirisurf.contours import welded_points
from kirisurf.cuts import cuts
from kirisurf.elastic.grading import Grading
from kirisurf.elastic.polygon_mesh import polygon_mesh
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.tessellation import Tessellation

GROWTH = 0.5
"""Growth of the elements with the distance from a ligament."""

_LONGEST, _LONGEST_OF_TWO = 0.5, 0.4  # of a slit edge that a ligament may take, as in `kirisurf.cuts`
_COARSEST = 0.25  # of the median tile edge


@dataclass(frozen=True, eq=False)
class SheetMesh:
    """Triangles of six nodes over a flat sheet.

    Attributes
    ----------
    nodes : (n, 2), units
    triangles : (m, 6)
        Three corners, counter-clockwise, then the middles of the sides 1-2, 2-3, 3-1.
    tiles : (m,)
        Tile of every triangle.
    vertices : (v,)
        Node of every vertex of the tessellation.
    hinges : (k, 2)
        Vertex at which a ligament stands, and the node at the tip of the slit.
    ligaments : tuple of (l,) arrays
        Nodes of every ligament, from the hinge to the tip.
    widths : (k,), units
        Widths of the ligaments.
    bare : int
        Number of hinges without a ligament: their tiles share one node, and turn about it freely.
    """

    nodes: Float[np.ndarray, "n 2"]
    triangles: Int[np.ndarray, "m 6"]
    tiles: Int[np.ndarray, " m"]
    vertices: Int[np.ndarray, " v"]
    hinges: Int[np.ndarray, "k 2"]
    ligaments: tuple[np.ndarray, ...]
    widths: Float[np.ndarray, " k"]
    bare: int = 0

    @property
    def areas(self) -> Float[np.ndarray, " m"]:
        """Areas of the triangles, negative for one that is turned over."""
        a, b, c = self.nodes[self.triangles[:, :3]].swapaxes(0, 1)
        u, v = b - a, c - a
        return 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])

    @property
    def smallest_angle(self) -> float:
        """Smallest angle of any triangle, in radians."""
        corner = self.nodes[self.triangles[:, :3]]
        ahead = np.roll(corner, -1, axis=1) - corner
        back = np.roll(corner, 1, axis=1) - corner
        sine = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
        return float(np.arctan2(sine, (ahead * back).sum(axis=2)).min())


def sheet_mesh(
    tessellation: Tessellation,
    contracted: Float[np.ndarray, "v 2"],
    hinge_width: float | None = None,
    refinement: int = 4,
) -> SheetMesh:
    """Mesh a contracted sheet.

    Parameters
    ----------
    tessellation : Tessellation
        Tiles of any number of corners, convex or not.
    contracted : (v, 2), units
    hinge_width : float, optional
        Length of the ligaments along the slits, as in :func:`kirisurf.cuts.cuts`.
    refinement : int
        Number of elements across a ligament; those at the tip of the slit are half as large.

    Raises
    ------
    ParameterError
        Where the hinge width or the refinement is out of range.
    UnusableError
        Where a tile cannot be meshed.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(1, 1)
    >>> mesh = sheet_mesh(pattern, pattern.contracted, 0.05)
    >>> len(mesh.hinges), round(float(mesh.areas.sum()), 9)
    (4, 1.0)
    """
    if not 1 <= refinement <= 64:
        raise ParameterError(f"refinement: expected a number from 1 to 64, got {refinement}")
    flat = checked(contracted, "contracted points", (tessellation.n_vertices, 2))
    width = cuts(tessellation, flat, hinge_width).hinge_width
    places = welded_points(tessellation, flat)
    sides = _Sides(tessellation, places, width, refinement)
    triangles, owners = [], []
    for k, tile in enumerate(tessellation.tiles):
        loop = sides.loop(k)
        try:
            inside, three = polygon_mesh(np.array(sides.points)[loop], sides.grading)
        except UnusableError as problem:
            raise UnusableError(f"tile {k} of {len(tile)} corners: {problem}") from None
        number = np.r_[loop, len(sides.points) + np.arange(len(inside) - len(loop))]
        sides.points.extend(inside[len(loop) :])
        triangles.append(number[three])
        owners.append(np.full(len(three), k))
    nodes, six = _quadratic(np.array(sides.points), np.concatenate(triangles))
    return SheetMesh(
        frozen(nodes),
        frozen(six, np.int64),
        frozen(np.concatenate(owners), np.int64),
        frozen(np.arange(tessellation.n_vertices), np.int64),
        frozen(np.array(sides.hinges, np.int64).reshape(-1, 2), np.int64),
        tuple(frozen(nodes_, np.int64) for nodes_ in sides.ligaments),
        frozen(np.array(sides.widths, float)),
        len(np.setdiff1d(tessellation.hinges[:, 1], [vertex for vertex, _ in sides.hinges])),
    )


class _Sides:
    """The divided sides of all tiles; `points` begins with the vertices and grows.

    A side's nodes are those of its slit edge where a ligament stands, and its own elsewhere.
    """

    def __init__(self, tessellation: Tessellation, places: np.ndarray, width: float, refinement: int) -> None:
        weld = tessellation.weld
        self.tiles, self.points = tessellation.tiles, list(places[weld])
        self.hinges: list[tuple[int, int]] = []
        self.ligaments: list[np.ndarray] = []
        self.widths: list[float] = []
        # directed side of a tile -> (slit edge, whether it runs against the edge's direction)
        self._slits = {}
        self._backs = np.zeros((len(tessellation.edge_pairs), 2))
        fine, finest = [np.zeros((0, 2))], [np.zeros(0)]
        for k, ((a, b), (c, d)) in enumerate(tessellation.edge_pairs.tolist()):
            self._slits[a, b], self._slits[d, c] = (k, False), (k, True)
            start, end = places[weld[a]], places[weld[b]]
            length = float(np.linalg.norm(end - start))
            most = _LONGEST_OF_TWO if a == c and b == d else _LONGEST
            for side, (one, other, at, to) in enumerate(((a, c, start, end), (b, d, end, start))):
                if one == other:
                    back = min(width, most * length)
                    self._backs[k, side] = back
                    way = np.linspace(0.0, back / length, refinement + 1)
                    fine.append(at + way[:, None] * (to - at))
                    finest.append(back / refinement * np.r_[np.ones(refinement), 0.5])
        edge = places[weld[self.tiles.successors]] - places[weld[self.tiles.indices]]
        median = float(np.median(np.linalg.norm(edge, axis=1)))
        self.grading = Grading(np.concatenate(fine), np.concatenate(finest), GROWTH, _COARSEST * median)
        self._shared: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        for k, pair in enumerate(tessellation.edge_pairs):
            self._shared[k] = self._slit_nodes(k, pair)

    def loop(self, k: int) -> np.ndarray:
        """Nodes round a tile, counter-clockwise from its first vertex on."""
        tile = self.tiles[k].tolist()
        found: list[int] = []
        for a, b in zip(tile, [*tile[1:], tile[0]], strict=True):
            found.append(a)
            if (a, b) not in self._slits:
                found.extend(self._added(self._divided(a, b)))
                continue
            slit, against = self._slits[a, b]
            places, numbers = self._shared[slit]
            # what is not of a ligament is this side's own
            own = np.where(numbers < 0, -1, numbers)
            free = own < 0
            own[free] = self._added(places[free])
            found.extend((own[::-1] if against else own).tolist())
        return np.array(found, np.int64)

    def _slit_nodes(self, k: int, pair: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places (i, 2) of the inner nodes of a slit edge, and their numbers (i,): -1 where it is cut."""
        (a, b), _ = pair.tolist()
        start, end = self.points[a], self.points[b]
        length = float(np.linalg.norm(end - start))
        tips = [float(back) / length for back in self._backs[k]]
        stops = [0.0, *([tips[0]] if tips[0] else []), *([1 - tips[1]] if tips[1] else []), 1.0]
        ways, joined = [], []
        for begin, stop in pairwise(stops):
            one, two = start + begin * (end - start), start + stop * (end - start)
            inner = begin + (stop - begin) * self.grading.divided(one, two)
            is_ligament = (tips[0] > 0 and begin == 0.0) or (tips[1] > 0 and stop == 1.0)
            ways += inner.tolist()
            joined += [is_ligament] * len(inner)
            if stop < 1.0:
                ways.append(stop)
                joined.append(True)
        places = start + np.array(ways)[:, None] * (end - start)
        numbers = np.full(len(ways), -1)
        shared = np.array(joined, bool)
        numbers[shared] = self._added(places[shared])
        for side, vertex in enumerate((a, b)):
            if tips[side]:
                near = np.array(ways) if side == 0 else 1 - np.array(ways)
                order = np.argsort(near)
                chosen = order[near[order] <= tips[side] + 1e-9]
                self.hinges.append((vertex, int(numbers[chosen[-1]])))
                self.ligaments.append(np.r_[vertex, numbers[chosen]])
                self.widths.append(tips[side] * length)
        return places, numbers

    def _divided(self, a: int, b: int) -> np.ndarray:
        start, end = self.points[a], self.points[b]
        return start + self.grading.divided(start, end)[:, None] * (end - start)

    def _added(self, places: np.ndarray) -> list[int]:
        first = len(self.points)
        self.points.extend(places)
        return list(range(first, first + len(places)))


def _quadratic(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Add a node in the middle of every side; sides of two triangles with the same ends are one side."""
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    ends, number = np.unique(sides, axis=0, return_inverse=True)
    middles = points[ends].mean(axis=1)
    return np.concatenate([points, middles]), np.hstack([triangles, len(points) + number.reshape(-1, 3)])
