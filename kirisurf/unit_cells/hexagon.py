"""The hexagon cell: two of the three classes of hexagons of the honeycomb turn, the third stays open."""

from __future__ import annotations

import numpy as np

from kirisurf.arrays import frozen
from kirisurf.unit_cell import UnitCell
from kirisurf.unit_cells.turning import regular, turning_cell

STRETCH = (1.0, 2 / np.sqrt(3))
"""cos(r) + sin(r) / sqrt(3) = 2/sqrt(3) cos(r - pi/6) for r from 0 to pi/6."""


def hexagon_cell(rotation: float = np.pi / 6) -> UnitCell:
    """Return the rectangular cell of four hexagons round two hexagonal openings, a third of its area.

    No contracted vertex is surrounded by tiles: the sheet has no ring, and its openings stay.

    Parameters
    ----------
    rotation : float
        Radians by which each hexagon is turned, alternately left and right: 0 is contracted, pi/6 fully open.

    Examples
    --------
    >>> hexagon_cell().stretches.round(4).tolist()
    [1.1547, 1.1547]
    """
    half = np.sqrt(3) / 2
    hexagon = regular(6, 0.0)
    # a zigzag upwards; hexagons with a common side turn against each other
    places = [(0.0, -2 * half, 1), (1.5, -half, -1), (1.5, half, 1), (0.0, 2 * half, -1)]
    tiles = [(np.array([x, y]), hexagon, sense) for x, y, sense in places]
    openings = frozen(hexagon), frozen(hexagon + np.array([1.5, 3 * half]))
    shifts = np.diag([3.0, 6 * half])
    return turning_cell("hexagon", tiles, shifts, rotation, 1 / np.sqrt(3), openings)
