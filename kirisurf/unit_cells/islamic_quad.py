"""The islamic-quad cell: octagons that move apart while squares between them turn by a right angle.

After the ancient geometric motifs of Rafsanjani and Pasini, "Bistable auxetic mechanical metamaterials inspired by
ancient geometric motifs" (2016), as the paper takes them. Octagons do not turn, which is consistent in the two
states alone: squares turned by t ask for cells longer by sin(t) diagonals in one direction and by 1 - cos(t) in the
other. Neither state has another periodic motion of rigid tiles, not even to first order: the sheet snaps. So there
is no rotation to choose, but the size of the squares.
"""

from __future__ import annotations

import numpy as np

from kirisurf.arrays import frozen
from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from kirisurf.unit_cell import UnitCell

STRETCH = (1.0, np.sqrt(2))
"""Contracted and deployed, for the default squares."""


def islamic_quad_cell(diagonal: float = np.sqrt(2) - 1) -> UnitCell:
    """Return the cell of four octagons, not convex, and four squares.

    Parameters
    ----------
    diagonal : float
        Diagonal of a square over the distance between neighboring squares, in (0, 1). The deployed cell is
        larger by 1 + diagonal. The default is the published cell: octagons with sides 1 + sqrt(2)/2 : 1/2,
        stretch sqrt(2).

    Raises
    ------
    ParameterError
        Where the diagonal is not in (0, 1).

    Examples
    --------
    >>> islamic_quad_cell().stretches.round(4).tolist()
    [1.4142, 1.4142]
    """
    if not 0 < diagonal < 1:
        raise ParameterError(f"diagonal: expected a number between 0 and 1, got {diagonal}")
    r = diagonal / 2
    square = r * np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
    # between the squares at (+-1/2, +-1/2); the sides of the octagon that lies across are a quarter turn further
    upright = np.array([[-0.5, -0.5 - r], [0.5, -0.5 - r], [0.5 - r, -0.5], [0.5 - r, 0.5]])
    upright = np.concatenate([upright, -upright])
    quarter = np.array([[0.0, 1.0], [-1.0, 0.0]])
    contracted, deployed = [], []
    for row in range(2):
        for column in range(2):
            place = np.array([column, row], dtype=float)
            even = (row + column) % 2 == 0
            turned = square @ (quarter if even else quarter.T)
            contracted += [place + square, place + 0.5 + (upright if even else upright @ quarter)]
            deployed += [
                (1 + diagonal) * place + turned,
                (1 + diagonal) * (place + 0.5) + (upright if even else upright @ quarter),
            ]
    offsets = np.r_[0, np.cumsum([len(tile) for tile in contracted])]
    return UnitCell(
        deployed=frozen(np.concatenate(deployed)),
        contracted=frozen(np.concatenate(contracted)),
        tiles=Loops(frozen(offsets, np.int64), frozen(np.arange(offsets[-1]), np.int64)),
        deployed_shifts=frozen(2 * (1 + diagonal) * np.eye(2)),
        contracted_shifts=frozen(2 * np.eye(2)),
        name="islamic-quad",
    ).normalized()
