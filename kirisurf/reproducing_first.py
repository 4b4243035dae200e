"""What Fig. 1 shows, from our own designs: the regular pattern opening, and one place of a general sheet.

The paper's text says of its Fig. 1a that it is the quad tessellation of the plane, compact and deployed. The rest of
the figure here follows what the paper states of a general sheet: edges that meet are equally long, and the angles
that meet sum to a full turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from kirisurf.design import Design
from kirisurf.errors import UnusableError
from kirisurf.loops import Loops
from kirisurf.pattern import quad_pattern
from kirisurf.tessellation import Tessellation

TURNS = (0.0, 15.0, 30.0, 45.0)
"""Degrees by which the squares are turned in the states that are shown."""


@dataclass(frozen=True, eq=False)
class OpeningSquares:
    """The quad pattern in several states of its one motion; rigid squares of side 1.

    Attributes
    ----------
    tiles : Loops
    states : tuple of (n, 2)
        From closed to fully open.
    degrees : tuple of float
        By which every square is turned.
    tones : (t,)
        0 or 1: which way it turns.
    """

    tiles: Loops
    states: tuple[Float[np.ndarray, "n 2"], ...]
    degrees: tuple[float, ...]
    tones: Int[np.ndarray, " t"]

    @property
    def stretches(self) -> tuple[float, ...]:
        """Length of the opened sheet over that of the closed one, in the limit of many tiles: cos r + sin r."""
        return tuple(float(np.cos(r) + np.sin(r)) for r in np.radians(self.degrees))


def opening_squares(cells: int = 2, degrees: Sequence[float | int] = TURNS) -> OpeningSquares:
    """Return the quad pattern of cells x cells unit cells in several states.

    Examples
    --------
    >>> squares = opening_squares(1, (0, 45))
    >>> [round(float(np.ptp(state[:, 0])), 3) for state in squares.states]
    [2.0, 2.828]
    """
    states = []
    for degree in degrees:
        pattern = quad_pattern(cells, cells, np.radians(degree) if degree else np.pi / 4)
        states.append(2 * (pattern.deployed if degree else pattern.contracted))
    odd = [int(column + row) % 2 for column, row in _places(pattern)]
    return OpeningSquares(pattern.tiles, tuple(states), tuple(map(float, degrees)), np.array(odd))


@dataclass(frozen=True, eq=False)
class MeetingCorner:
    """The tiles round one inner point of a closed sheet, and what of them meets there.

    Attributes
    ----------
    tiles : tuple of (k, 2)
        Their corners in the closed sheet.
    opened : tuple of (k, 2)
        The same corners in the open sheet.
    corners : tuple of int
        The corner of every tile that lies at the point.
    pairs : tuple of ((int, int), (int, int))
        Sides that meet when closed, each as (tile, side).
    """

    tiles: tuple[Float[np.ndarray, "k 2"], ...]
    opened: tuple[Float[np.ndarray, "k 2"], ...]
    corners: tuple[int, ...]
    pairs: tuple[tuple[tuple[int, int], tuple[int, int]], ...]

    @property
    def angles(self) -> Float[np.ndarray, " t"]:
        """Angles of the tiles at the point, in the open sheet; radians."""
        found = []
        for points, corner in zip(self.opened, self.corners, strict=True):
            ahead, back = (points[(corner + step) % len(points)] - points[corner] for step in (1, -1))
            a, b = complex(*ahead), complex(*back)
            found.append(float(np.angle(b / a)) % (2 * np.pi))
        return np.array(found)

    @property
    def lengths(self) -> Float[np.ndarray, "p 2"]:
        """Lengths of the sides that meet, in the open sheet, a row a pair."""
        return np.array([[self._length(tile, side) for tile, side in pair] for pair in self.pairs])

    def _length(self, tile: int, side: int) -> float:
        points = self.opened[tile]
        return float(np.linalg.norm(points[(side + 1) % len(points)] - points[side]))


def meeting_corner(design: Design, place: tuple[float, float]) -> MeetingCorner:
    """Return the tiles round the inner point of a planar sheet that lies nearest to a place of the closed sheet.

    Parameters
    ----------
    design : Design
        In a planar outline.
    place : (float, float)
        Over width and height of the closed sheet, from its lower left corner.

    Raises
    ------
    UnusableError
        Where no point has tiles all round.
    """
    pattern, flat, opened = design.tessellation, design.contracted_points, design.deployed_points[:, :2]
    if not len(pattern.rings):
        raise UnusableError("figure: expected a sheet with a point that has tiles all round, got none")
    middles = np.array([flat[pattern.corners[ring, 1]].mean(axis=0) for ring in pattern.rings])
    wanted = flat.min(axis=0) + np.array(place) * np.ptp(flat, axis=0)
    ring = pattern.rings[int(np.linalg.norm(middles - wanted, axis=1).argmin())]
    owners = pattern.tiles.owners[ring]
    found = tuple(int(position - pattern.tiles.offsets[owner]) for position, owner in zip(ring, owners, strict=True))
    loops = [pattern.tiles[int(owner)] for owner in owners]
    sides = {
        (int(a), int(b)): (tile, side)
        for tile, loop in enumerate(loops)
        for side, (a, b) in enumerate(zip(loop, np.roll(loop, -1), strict=True))
    }
    pairs = tuple(
        (sides[a, b], sides[d, c])
        for (a, b), (c, d) in pattern.edge_pairs.tolist()
        if (a, b) in sides and (d, c) in sides
    )
    return MeetingCorner(tuple(flat[loop] for loop in loops), tuple(opened[loop] for loop in loops), found, pairs)


def _places(pattern: Tessellation) -> np.ndarray:
    """Column and row of every square."""
    middles = np.array([pattern.contracted[tile].mean(axis=0) for tile in pattern.tiles])
    return np.rint(2 * (middles - middles.min(axis=0))).astype(np.int64)
