"""The kagome cell: rotating equilateral triangles, which open into the trihexagonal (kagome) lattice."""

from __future__ import annotations

import numpy as np

from kirisurf.unit_cell import UnitCell
from kirisurf.unit_cells.turning import regular, turning_cell

STRETCH = (1.0, 2.0)
"""cos(r) + sqrt(3) sin(r) = 2 cos(r - pi/3) for r from 0 to pi/3."""


def kagome_cell(rotation: float = np.pi / 3) -> UnitCell:
    """Return the cell of two columns and two rows of triangle pairs, eight tiles.

    Parameters
    ----------
    rotation : float
        Radians by which each triangle is turned, pointing up to the left and pointing down to the right: 0 is
        closed, pi/3 fully open, where the holes are regular hexagons. Slits open by twice this angle.

    Examples
    --------
    >>> kagome_cell().stretches.round(12).tolist()
    [2.0, 2.0]
    """
    height, inradius = np.sqrt(3) / 2, np.sqrt(3) / 6
    up, down = regular(3, np.pi / 2, 2 * inradius), regular(3, -np.pi / 2, 2 * inradius)
    tiles = []
    # both rows span the same width: the lower begins with a triangle that points down, the upper with one upwards
    for left, base, points_up in ((0.5, 0.0, False), (0.5, height, True)):
        for k in range(4):
            rises = points_up == (k % 2 == 0)
            center = np.array([left + 0.5 * k, base + (inradius if rises else height - inradius)])
            tiles.append((center, up, 1) if rises else (center, down, -1))
    return turning_cell("kagome", tiles, np.diag([2.0, 2 * height]), rotation, np.sqrt(3))
