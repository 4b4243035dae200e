"""Collisions: tiles, as thick as the sheet is, that reach into each other, also those that hinge.

A tile is its polygon extruded by half of the thickness to either side. Tiles that share a hinge always overlap
there as soon as they fold against each other, which is what the hinge's material is bent by: for such a pair the
corners are cut back, along a line across the corner at the distance of one thickness from the hinge. A fold of up to
120 degrees about an axis through the hinge pinches within that distance, (h / 2) / cos(fold / 2); what reaches
further is a collision. In the plane tiles lie side by side, and the thickness has no part in it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from analysis import polygons
from analysis.convex_parts import ConvexParts
from analysis.hinged_tiles import hinged_tiles
from analysis.plates import Plates, depths
from kirisurf.arrays import checked, frozen
from kirisurf.errors import ParameterError
from kirisurf.loops import Loops

TOUCH = 1e-6
"""Depth over the tile edge up to which tiles touch and do not collide."""

THICKEST = 0.5
"""Largest thickness over the tile edge for which a tile is a plate."""

WIDEST = np.radians(120.0)
"""Hinge corners wider than this are divided where there is thickness: a cut across them would take too much."""


@dataclass(frozen=True, eq=False)
class Collisions:
    """The tiles that collide in one state.

    Attributes
    ----------
    pairs : (x, 2)
        Tile numbers, the smaller first, in ascending order.
    depths : (x,)
        Length of the shortest shift, within the plane of one of the two, that parts them, over the tile edge. Of
        tiles that are not convex, the largest over their convex parts, which is a lower bound.
    """

    pairs: Int[np.ndarray, "x 2"]
    depths: Float[np.ndarray, " x"]

    @property
    def count(self) -> int:
        """Number of pairs that collide."""
        return len(self.pairs)

    @property
    def deepest(self) -> float:
        """Largest depth over the tile edge; 0 where no tiles collide."""
        return float(self.depths.max(initial=0.0))


@dataclass(frozen=True, eq=False)
class Collider:
    """Tiles made ready to be tested for collisions in any number of states.

    Attributes
    ----------
    tiles : Loops
    parts : ConvexParts
    hinged : (m, 3)
        Two tiles, the smaller first, and a vertex that they share.
    edge_length : float, units
        Median tile edge.
    dimension : int
        Of the points.
    thickness, slit_width : float, units
    touch : float
        Over the edge length.
    """

    tiles: Loops
    parts: ConvexParts
    hinged: Int[np.ndarray, "m 3"]
    edge_length: float
    dimension: int
    thickness: float
    slit_width: float
    touch: float

    @classmethod
    def of(
        cls, points: ArrayLike, tiles: Loops, thickness: float = 0.0, slit_width: float = 0.0, touch: float = TOUCH
    ) -> Collider:
        """Make tiles ready, with the shapes that they have in one state.

        Parameters
        ----------
        points : (n, 2) or (n, 3), units
        tiles : Loops
        thickness : float, units
            Of the sheet, from 0 to half of the median tile edge.
        slit_width : float, units
            Width of the cut, from 0: tiles that overlap by no more have room for it.
        touch : float
            Depth over the edge length up to which tiles only touch.

        Raises
        ------
        ParameterError
            Where a length is out of its range.
        UnusableError
            Where the points have another shape, are not finite, or a tile crosses itself.
        """
        n = int(tiles.indices.max(initial=-1)) + 1
        dimension = np.shape(points)[1] if np.ndim(points) == 2 else 0
        space = _in_space(checked(points, "points", (max(n, len(np.asarray(points))), 2 if dimension == 2 else 3)))
        edge_length = float(np.median(polygons.edge_lengths(space, tiles)))
        if not 0 <= thickness <= THICKEST * edge_length:
            raise ParameterError(
                f"thickness: expected a number from 0 to {THICKEST * edge_length:.6g} (half of the median tile edge), "
                f"got {thickness:.6g}"
            )
        if not (0 <= slit_width < np.inf):
            raise ParameterError(f"slit width: expected a number from 0, got {slit_width:.6g}")
        thickness = float(thickness) if dimension == 3 else 0.0
        hinged = hinged_tiles(tiles, len(space))
        parts = ConvexParts.of(space, tiles, np.unique(hinged[:, 2]), WIDEST if thickness else np.pi)
        return cls(tiles, parts, hinged, edge_length, dimension, thickness, float(slit_width), float(touch))

    def collisions(self, points: ArrayLike) -> Collisions:
        """Return the tiles that collide in a state.

        Parameters
        ----------
        points : (n, 2) or (n, 3), units

        Raises
        ------
        UnusableError
            Where the points have another shape than those that the tiles were made ready with, or are not finite.
        """
        array = np.asarray(points, float)
        n = int(self.tiles.indices.max(initial=-1)) + 1
        space = _in_space(checked(array, "points", (max(n, len(array)), self.dimension)))
        normals = polygons.normals(space, self.tiles)
        near = self._near(space)
        rows, owners = self._part_pairs(space, near)
        least = self.touch * self.edge_length + self.slit_width
        found = np.full(len(near), -np.inf)
        np.maximum.at(found, owners, self._depths(space, normals, rows, near[owners], least))
        deep = found > least
        return Collisions(frozen(near[deep], np.int64), frozen((found[deep] - self.slit_width) / self.edge_length))

    def _near(self, points: np.ndarray) -> np.ndarray:
        """Pairs of tiles (p, 2) whose bounding balls meet, in ascending order."""
        corner = points[self.tiles.indices]
        starts = self.tiles.offsets[:-1]
        center = np.add.reduceat(corner, starts, axis=0) / self.tiles.sizes[:, None]
        radius = np.maximum.reduceat(np.linalg.norm(corner - center[self.tiles.owners], axis=1), starts)
        radius = np.hypot(radius, 0.5 * self.thickness)
        pairs = cKDTree(center).query_pairs(2 * float(radius.max()), output_type="ndarray").reshape(-1, 2)
        apart = np.linalg.norm(center[pairs[:, 0]] - center[pairs[:, 1]], axis=1)
        pairs = np.sort(pairs[apart < radius[pairs].sum(axis=1)], axis=1)
        return pairs[np.lexsort(pairs.T[::-1])]

    def _part_pairs(self, points: np.ndarray, pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs of parts (r, 2) of pairs of tiles, where the balls round them meet, and the pair of each."""
        first = self.parts.first
        count = np.diff(first)[pairs]
        total = count.prod(axis=1)
        owners = np.repeat(np.arange(len(pairs)), total)
        place = np.arange(len(owners)) - np.repeat(np.cumsum(total) - total, total)
        i, j = np.divmod(place, count[owners, 1])
        rows = np.stack([first[pairs[owners, 0]] + i, first[pairs[owners, 1]] + j], axis=1)
        corner = points[self.parts.corners]
        middle = 0.5 * (corner.min(axis=1) + corner.max(axis=1))
        radius = np.hypot(np.linalg.norm(corner - middle[:, None], axis=2).max(axis=1), 0.5 * self.thickness)
        meet = np.linalg.norm(middle[rows[:, 0]] - middle[rows[:, 1]], axis=1) < radius[rows].sum(axis=1)
        return rows[meet], owners[meet]

    def _depths(
        self, points: np.ndarray, normals: np.ndarray, rows: np.ndarray, tiles: np.ndarray, least: float
    ) -> np.ndarray:
        """Depth (r,) of pairs of parts; hinged ones, where there is thickness, with their corners cut back."""
        shared = np.full(len(rows), -1)
        if self.thickness:
            n = len(self.tiles)
            key = self.hinged[:, 0] * n + self.hinged[:, 1]
            wanted = tiles[:, 0] * n + tiles[:, 1]
            place = np.minimum(np.searchsorted(key, wanted), max(len(key) - 1, 0))
            shared = np.where(key[place] == wanted, self.hinged[place, 2], -1) if len(key) else shared
        result = np.empty(len(rows))
        for at, is_hinged in ((np.flatnonzero(shared < 0), False), (np.flatnonzero(shared >= 0), True)):
            one, two = (self._plates(points, normals, part, shared[at], is_hinged) for part in rows[at].T)
            result[at] = np.where(one[1] & two[1], depths(one[0], two[0], self.edge_length, least), -np.inf)
        return result

    def _plates(
        self, points: np.ndarray, normals: np.ndarray, part: np.ndarray, vertex: np.ndarray, is_hinged: bool
    ) -> tuple[Plates, np.ndarray]:
        """Plates of parts, cut back at vertices where they hinge there, and whether anything is left of them."""
        plates = Plates.of(points[self.parts.corners[part]], normals[self.parts.tiles[part]], self.thickness)
        if not is_hinged:
            return plates, np.ones(len(part), bool)
        inward, has_corner = self._bisectors(points, part, vertex)
        # a part without that corner is far from the cut
        left, remains = plates.cut(points[vertex], inward, np.where(has_corner, self.thickness, -1.0))
        return left, remains

    def _bisectors(self, points: np.ndarray, part: np.ndarray, vertex: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unit vectors (r, 3) that halve the corners of parts at vertices, and whether they have such a corner."""
        loops = self.parts.corners[part]
        place = (loops == vertex[:, None]).argmax(axis=1)
        has_corner = loops[np.arange(len(part)), place] == vertex
        here = points[vertex]
        rows = np.arange(len(part))
        size = (loops != loops[:, -1:]).argmin(axis=1) + 1  # the last corner is repeated
        after = points[loops[rows, (place + 1) % size]] - here
        before = points[loops[rows, (place - 1) % size]] - here
        inward = polygons.unit(polygons.unit(after) + polygons.unit(before))
        inward[~has_corner] = 0.0
        return inward, has_corner


def collisions(
    points: ArrayLike, tiles: Loops, thickness: float = 0.0, slit_width: float = 0.0, touch: float = TOUCH
) -> Collisions:
    """Return the tiles that collide in one state; arguments and errors as in :meth:`Collider.of`.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> collisions(pattern.deployed, pattern.tiles).count
    0
    """
    return Collider.of(points, tiles, thickness, slit_width, touch).collisions(points)


def _in_space(points: np.ndarray) -> np.ndarray:
    """Points about their middle, where differences are exact; those of the plane at height 0."""
    middle = points - points.mean(axis=0)
    return np.pad(middle, ((0, 0), (0, 1))) if middle.shape[1] == 2 else middle
