"""Cells whose tiles turn, alternately to the left and to the right, about centers that move apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.loops import Loops
from kirisurf.unit_cell import UnitCell


def turning_cell(
    name: str,
    tiles: Sequence[tuple[Float[np.ndarray, "2"], Float[np.ndarray, "_ 2"], int]],
    shifts: Float[np.ndarray, "2 2"],
    rotation: float,
    tangent: float,
    openings: tuple[Float[np.ndarray, "_ 2"], ...] = (),
) -> UnitCell:
    """Return the cell in which every tile turns by +-rotation while all centers are stretched alike.

    Two tiles with a common side turn against each other and stay hinged at one of its ends. With c the distance
    of a center from that side, over half the side's length, the centers move apart by

        stretch = cos(rotation) + sin(rotation) / c,

    which grows from 1 to sqrt(1 + 1 / c^2) at rotation = arctan(1 / c) (Grima and Evans 2000 for squares).

    Parameters
    ----------
    name : str
    tiles : sequence of (center (2,), corners about it (k, 2), +1 or -1)
        Contracted, counter-clockwise; the sign is the sense in which the tile turns.
    shifts : (2, 2)
        Contracted translations to the next column and row.
    rotation : float
        Radians; 0 is closed.
    tangent : float
        1 / c; tan(pi / n) for regular n-gons.
    openings : tuple of (_, 2)
        See :class:`kirisurf.unit_cell.UnitCell`.
    """
    cos, sin = np.cos(rotation), np.sin(rotation)
    stretch = cos + tangent * sin
    contracted, deployed, sizes = [], [], []
    for center, corners, sense in tiles:
        turn = np.array([[cos, sense * sin], [-sense * sin, cos]])
        contracted.append(center + corners)
        deployed.append(stretch * center + corners @ turn)
        sizes.append(len(corners))
    offsets = np.r_[0, np.cumsum(sizes)]
    return UnitCell(
        deployed=frozen(np.concatenate(deployed)),
        contracted=frozen(np.concatenate(contracted)),
        tiles=Loops(frozen(offsets, np.int64), frozen(np.arange(offsets[-1]), np.int64)),
        deployed_shifts=frozen(stretch * shifts),
        contracted_shifts=frozen(shifts),
        name=name,
        openings=openings,
    ).normalized()


def regular(sides: int, direction: float, circumradius: float = 1.0) -> Float[np.ndarray, "k 2"]:
    """Return the corners of a regular polygon about the origin, the first in the given direction (radians)."""
    angle = direction + 2 * np.pi * np.arange(sides) / sides
    return circumradius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
