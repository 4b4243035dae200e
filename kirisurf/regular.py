"""The regular pattern: a motion in one state, as the ruler by which sheets are placed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

from kirisurf.arrays import frozen
from kirisurf.loops import Loops
from kirisurf.motion import Motion, motion_of
from kirisurf.turns import arms as arms_of
from kirisurf.unit_cell import UnitCell

SAME = 1e-6
"""Distance up to which places in a pattern are equal; the contracted cell has area 1."""


@dataclass(frozen=True, eq=False)
class Regular:
    """A motion in one state, at the size at which its cell has area 1.

    Attributes
    ----------
    motion : Motion
    way : float
        The state, see :class:`kirisurf.motion.Motion`.
    """

    motion: Motion
    way: float

    @classmethod
    def of(cls, cell: UnitCell, way: float = 0.5) -> Regular:
        """Return the regular pattern of a cell."""
        return cls(motion_of(cell), way)

    @cached_property
    def lattice(self) -> Float[np.ndarray, "2 2"]:
        """Translations to the next column and the next row (rows of the matrix), of area 1."""
        shifts = self.motion.lattice(np.array([self.way]))[0]
        return frozen(shifts / np.sqrt(abs(np.linalg.det(shifts))))

    @cached_property
    def shares(self) -> Float[np.ndarray, " k"]:
        """Share of every tile in the area of the cell; what stays open is shared out with them."""
        corner = self.motion.cell.contracted
        areas = np.array([_area(corner[tile]) for tile in self.motion.cell.tiles])
        return frozen(areas / areas.sum())

    def box(self, mask: Bool[np.ndarray, "columns rows k"]) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
        """Return the lower left corner and the size of the upright rectangle round the tiles of a mask."""
        cells = np.argwhere(mask)
        corners = self.motion.corners(cells, np.full(len(cells), self.way), self.lattice)
        return corners.min(axis=0), np.ptp(corners, axis=0)

    def contracted(self, cells: Int[np.ndarray, "t 3"]) -> tuple[Float[np.ndarray, "s 2"], Loops]:
        """Return the corners of contracted tiles (column, row, number), in columns and rows, and their loops."""
        cell = self.motion.cell
        corner = cell.contracted[cell.tiles.indices] @ np.linalg.inv(cell.contracted_shifts)
        sizes = cell.tiles.sizes[cells[:, 2]]
        offsets = np.r_[0, np.cumsum(sizes)]
        owner = np.repeat(np.arange(len(cells)), sizes)
        local = cell.tiles.offsets[cells[:, 2]][owner] + np.arange(offsets[-1]) - offsets[owner]
        loops = Loops(frozen(offsets, np.int64), frozen(np.arange(offsets[-1]), np.int64))
        return corner[local] + cells[owner, :2], loops

    @cached_property
    def halves(self) -> tuple[tuple[int, int, int, tuple[int, int, int]], ...]:
        """Where the tiles of two by two cells lie among tiles of twice the size on the same origin.

        Each with column and row (0 or 1), number, and (column, row, number) of the larger one that its middle is in;
        those whose middle is in an opening are left out.
        """
        around = np.array([(c, r, k) for c in (-1, 0, 1) for r in (-1, 0, 1) for k in range(len(self.shares))])
        corners, loops = self.contracted(around)
        large = np.array([shapely.Polygon(2 * corners[loop]) for loop in loops])
        found = []
        for column, row, tile in np.argwhere(np.ones((2, 2, len(self.shares)), bool)).tolist():
            middle = self.contracted(np.array([[column, row, tile]]))[0].mean(axis=0)
            inside = np.flatnonzero(shapely.intersects_xy(large, *middle))
            if len(inside):
                c, r, k = around[inside[0]].tolist()
                found.append((column, row, tile, (c, r, k)))
        return tuple(found)

    @cached_property
    def symmetry(self) -> int:
        """How many rotations about one point bring the places of equal tiles onto each other: 2, 4 or 6.

        The translations that bring every tile onto an equal one form the finest lattice; it is asked whether that
        lattice looks the same turned by 90 or 60 degrees. Cells may be several of its meshes.
        """
        steps = self._translations()
        for order in (4, 6):
            angle = 2 * np.pi / order
            turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
            if all(self._is_translation(step @ turn, steps) for step in steps):
                return order
        return 2

    def _translations(self) -> Float[np.ndarray, "_ 2"]:
        """Translations of the contracted pattern: those of the cell, and those within it."""
        cell = self.motion.cell
        centers, arms = arms_of(cell)
        # tiles of one shape in one position; adding 0 makes -0 and 0 one number
        looks = [np.sort_complex(np.round(arms[a:b], 6) + 0.0).tobytes() for a, b in pairwise(cell.tiles.offsets)]
        look = np.unique(looks, return_inverse=True)[1]
        rarest = np.flatnonzero(look == np.argmin(np.bincount(look)))
        place = np.stack([centers.real, centers.imag], axis=1)
        inverse = np.linalg.inv(cell.contracted_shifts)
        tree = cKDTree(_folded(place @ inverse), boxsize=1.0)
        found = [*cell.contracted_shifts]
        for other in rarest[1:]:
            step = place[other] - place[rarest[0]]
            gap, hit = tree.query(_folded((place + step) @ inverse))
            if gap.max() < SAME and (look[hit] == look).all():
                found.append(step)
        return np.array(found)

    def _is_translation(self, step: np.ndarray, steps: np.ndarray) -> bool:
        inverse = np.linalg.inv(self.motion.cell.contracted_shifts)
        parts = (step - np.vstack([np.zeros(2), steps[2:]])) @ inverse
        return bool((np.abs(parts - np.round(parts)).max(axis=1) < SAME).any())


def _folded(parts: np.ndarray) -> np.ndarray:
    """Places in columns and rows, within one cell."""
    return np.mod(np.mod(parts, 1.0), 1.0)


def _area(corners: np.ndarray) -> float:
    after = np.roll(corners, -1, axis=0)
    return float(0.5 * (corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]).sum())
