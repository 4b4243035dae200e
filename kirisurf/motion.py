"""The motion of a unit cell: the states between contracted and deployed, one for every part of the way."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Complex, Float, Int

from kirisurf.adjacency import Adjacency, adjacency
from kirisurf.arrays import frozen
from kirisurf.turns import arms, tile_turns, tilt, upright
from kirisurf.unit_cell import UnitCell

STEPS = 65
"""States in the table from which a stretch finds its place on the way."""

NEWTON = 12
"""Steps that find a place on the way from a stretch; about five do where the stretch does not stop growing."""

HELD = 1e-6
"""Largest distance between hinged corners, in cells, of a sheet that is said to move and not to snap."""

ALMOST_HALF = 1e-6
"""Difference from half a turn, in radians, within which a tile may have turned either way."""


@dataclass(frozen=True, eq=False)
class Motion:
    """One state of a cell for every part `way` of the way from contracted (0) to deployed (1).

    Every tile turns by that part of its whole turn; tiles and lattice then lie where hinged corners are nearest to
    each other (least squares). Where rigid tiles lead from one state to the other, as they do for rotating squares,
    triangles, hexagons, rectangles, the hinges hold all the way; where the sheet snaps, they do so at both ends only.

    States are turned so that the lattice is the contracted one times a symmetric matrix: as upright as it can be.

    Attributes
    ----------
    cell : UnitCell
        With contracted area 1, its columns along the first axis.
    adjacency : Adjacency
    turns : (k,)
        Turn of every tile over the whole way, in radians, against the lattice.
    response : (k + 2, k) complex
        Centers of the tiles and the two translations are `response @ exp(1j * way * turns)`; the tiles' mean is 0.
    mismatch : float
        Largest distance between hinged corners at any state.
    """

    cell: UnitCell
    adjacency: Adjacency
    turns: Float[np.ndarray, " k"]
    response: Complex[np.ndarray, "k_plus_2 k"]
    mismatch: float

    @property
    def snaps(self) -> bool:
        """Whether only the two ends are free of strain, as far as tiles turn in proportion to their whole turns."""
        return self.mismatch > HELD

    @cached_property
    def table(self) -> tuple[Float[np.ndarray, " _"], Float[np.ndarray, " _"]]:
        """Parts of the way and the stretch there, as far as it grows."""
        way = np.linspace(0.0, 1.0, STEPS)
        stretch = self.stretch(way)
        top = int(np.argmax(stretch >= stretch.max() * (1 - 1e-12)))
        grows = np.r_[True, stretch[1 : top + 1] > np.maximum.accumulate(stretch[:top])]
        return frozen(way[: top + 1][grows]), frozen(stretch[: top + 1][grows])

    @property
    def most(self) -> float:
        """Largest stretch: the root of the area of the open cell over that of the closed one."""
        return float(self.table[1][-1])

    def lattice(self, way: Float[np.ndarray, " t"]) -> Float[np.ndarray, "t 2 2"]:
        """Return the translations to the next column (row 0) and the next row (row 1)."""
        shifts = self._phases(way) @ self.response[-2:].T
        shifts = shifts * np.exp(-1j * self._tilt(shifts))[:, None]
        return np.stack([shifts.real, shifts.imag], axis=-1)

    def stretch(self, way: Float[np.ndarray, " t"]) -> Float[np.ndarray, " t"]:
        """Return the linear stretch from contracted to a state, the geometric mean over all directions."""
        return np.sqrt(self._area(np.asarray(way, float))[0])

    def stretches(self, way: float) -> Float[np.ndarray, " 2"]:
        """Return the largest and the smallest linear stretch over all directions."""
        return np.linalg.svd(np.linalg.solve(self.cell.contracted_shifts, self.lattice(np.array([way]))[0]))[1]

    def way(self, stretch: Float[np.ndarray, " t"]) -> Float[np.ndarray, " t"]:
        """Return the part of the way at which a stretch is first reached; the nearest end where none does."""
        ways, stretches = self.table
        stretch = np.clip(np.asarray(stretch, float), stretches[0], stretches[-1])
        after = np.clip(np.searchsorted(stretches, stretch), 1, len(ways) - 1)
        low, high = ways[after - 1], ways[after]
        way = low + (high - low) * (stretch - stretches[after - 1]) / (stretches[after] - stretches[after - 1])
        # Newton's method between two entries, where the stretch grows; by halves where it would leave them
        for _ in range(NEWTON):
            area, slope = self._area(way)
            found = np.sqrt(area)
            below = found < stretch
            low, high = np.where(below, way, low), np.where(below, high, way)
            step = (stretch - found) * 2 * found / np.where(slope > 0, slope, np.inf)
            way = np.where((way + step >= low) & (way + step <= high) & (slope > 0), way + step, 0.5 * (low + high))
        # at the end the stretch may not grow, and a rounding of it moves the place by its square root
        return np.where(stretch < stretches[-1], way, ways[-1])

    def corners(
        self, cells: Int[np.ndarray, "t 3"], way: Float[np.ndarray, " t"], lattice: Float[np.ndarray, "2 2"]
    ) -> Float[np.ndarray, "s 2"]:
        """Return the corners of tiles, each in a state of its own, on a common lattice.

        A tile has the place in the lattice that it has in its state, and its size over the stretch of that state.

        Parameters
        ----------
        cells : (t, 3)
            Column, row, number within the cell.
        way : (t,)
        lattice : (2, 2)
            Translations, of area 1. Where it is that of one state over its stretch and all tiles are in that state,
            so is the sheet.

        Returns
        -------
        (s, 2)
            Tile after tile, in the order of the cell's.
        """
        which = cells[:, 2]
        phases = self._phases(way)
        shifts = phases @ self.response[-2:].T
        back = np.exp(-1j * self._tilt(shifts))
        center = np.einsum("tk,tk->t", phases, self.response[which])
        # the part of the lattice at which the center lies: center = x * shifts[0] + y * shifts[1]
        area = (shifts[:, 0].conj() * shifts[:, 1]).imag
        x = (center.conj() * shifts[:, 1]).imag / area
        y = (shifts[:, 0].conj() * center).imag / area
        size = np.sqrt(self.cell.area / np.abs(area))
        place = (np.stack([x, y], axis=1) + self._middle + cells[:, :2]) @ lattice

        sizes = self.cell.tiles.sizes[which]
        offsets = np.r_[0, np.cumsum(sizes)]
        owner = np.repeat(np.arange(len(which)), sizes)
        local = self.cell.tiles.offsets[which][owner] + np.arange(offsets[-1]) - offsets[owner]
        turned = (np.exp(1j * way * self.turns[which]) * back * size)[owner] * self._arms[local]
        return place[owner] + np.stack([turned.real, turned.imag], axis=1)

    def state(self, way: float) -> UnitCell:
        """Return the cell deployed up to a part of the way."""
        count = len(self.cell.tiles)
        cells = np.column_stack([np.zeros((count, 2), int), np.arange(count)])
        lattice = self.lattice(np.array([way]))[0]
        stretch = float(self.stretch(np.array([way]))[0])
        corners = stretch * self.corners(cells, np.full(count, float(way)), lattice / stretch)
        deployed = np.zeros_like(self.cell.deployed)
        deployed[self.cell.tiles.indices] = corners
        return replace(self.cell, deployed=frozen(deployed), deployed_shifts=frozen(lattice))

    @cached_property
    def _arms(self) -> Complex[np.ndarray, " s"]:
        return arms(self.cell)[1]

    @cached_property
    def _middle(self) -> Float[np.ndarray, " 2"]:
        """Mean of the contracted tiles' centers, in parts of the lattice."""
        center = arms(self.cell)[0].mean()
        return np.array([center.real, center.imag]) @ np.linalg.inv(self.cell.contracted_shifts)

    def _area(self, way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Area (t,) of a cell at states over that of the contracted one, and its derivative by the way."""
        turns, shifts = self._turning
        phases = np.exp(1j * way[:, None] * turns)
        first, second = (phases @ shifts.T).T
        d_first, d_second = ((1j * turns * phases) @ shifts.T).T
        area = (first.conj() * second).imag
        slope = (d_first.conj() * second + first.conj() * d_second).imag
        return area / self.cell.area, slope / self.cell.area

    @cached_property
    def _turning(self) -> tuple[np.ndarray, np.ndarray]:
        """The different turns (u,), and the response (2, u) of the two translations to them."""
        turns, group = np.unique(np.round(self.turns, 12), return_inverse=True)
        exact = np.bincount(group, self.turns) / np.bincount(group)
        shifts = np.stack([self.response[-2:, group == k].sum(axis=1) for k in range(len(turns))], axis=1)
        return exact, shifts

    def _phases(self, way: np.ndarray) -> np.ndarray:
        return np.exp(1j * np.asarray(way, float)[:, None] * self.turns)

    def _tilt(self, shifts: np.ndarray) -> np.ndarray:
        """Angle (t,) by which the lattice is turned against the contracted one: polar decomposition."""
        return tilt(self.cell.contracted_shifts, shifts)


def motion_of(cell: UnitCell) -> Motion:
    """Return the motion of a cell.

    Examples
    --------
    >>> from kirisurf.unit_cell import quad_cell
    >>> motion = motion_of(quad_cell())
    >>> round(motion.most, 6), motion.snaps
    (1.414214, False)
    """
    cell = upright(cell.normalized())
    around = adjacency(cell)
    turns = tile_turns(cell)
    system, right = _hinge_rows(cell, around)
    response = np.linalg.lstsq(system, right, rcond=None)[0]
    response[: len(turns)] -= response[: len(turns)].mean(axis=0)

    def gaps(turns: np.ndarray) -> float:
        phases = np.exp(1j * np.linspace(0, 1, 9)[:, None] * turns)
        return float(np.abs(phases @ (system @ response - right).T).max(initial=0.0))

    for k in np.flatnonzero(np.abs(turns) > np.pi - ALMOST_HALF):
        other = turns.copy()
        other[k] -= np.sign(turns[k]) * 2 * np.pi
        turns = min((turns, other), key=gaps)
    return Motion(cell, around, frozen(turns), frozen(response, np.complex128), gaps(turns))


def _hinge_rows(cell: UnitCell, around: Adjacency) -> tuple[np.ndarray, np.ndarray]:
    """Linear system (h, k + 2) and its right sides (h, k) for the centers and translations that hold the hinges."""
    k, h = len(cell.tiles), len(around.hinges)
    i, a, j, b, column, row = around.hinges.T
    rows = np.arange(h)
    arm = arms(cell)[1]
    system, right = np.zeros((h, k + 2)), np.zeros((h, k), complex)
    np.add.at(system, (rows, i), 1.0)
    np.add.at(system, (rows, j), -1.0)
    system[:, k], system[:, k + 1] = -column, -row
    np.add.at(right, (rows, j), arm[b])
    np.add.at(right, (rows, i), -arm[a])
    return system, right
