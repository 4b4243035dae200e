"""The islamic-triangle cell: 18-gons that move apart while triangles between them turn by 60 degrees.

After the ancient geometric motifs of Rafsanjani and Pasini (2016), as the paper takes them; see
:mod:`kirisurf.unit_cells.islamic_quad` for why there are two states and nothing between.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from kirisurf.unit_cell import UnitCell
from kirisurf.unit_cells.turning import regular

STRETCH = (1.0, 1.5)
"""Contracted and deployed, for the default triangles."""


def islamic_triangle_cell(side: float = 0.5) -> UnitCell:
    """Return the rectangular cell of two 18-gons, not convex, and four triangles.

    Triangles sit at the vertices of a honeycomb; two neighbors are joined by their prolonged sides, so that six
    corners of the 18-gon are straight.

    Parameters
    ----------
    side : float
        Side of a triangle over the distance between neighboring 18-gons, in (0, 1). The deployed cell is larger
        by 1 + side; the default is the published cell.

    Raises
    ------
    ParameterError
        Where the side is not in (0, 1).

    Examples
    --------
    >>> islamic_triangle_cell().stretches.round(4).tolist()
    [1.5, 1.5]
    """
    if not 0 < side < 1:
        raise ParameterError(f"side: expected a number between 0 and 1, got {side}")
    height = np.sqrt(3) / 2
    reach = 1 / np.sqrt(3)  # from the center of an 18-gon to those of its six triangles
    up, down = regular(3, np.pi / 2, side / np.sqrt(3)), regular(3, np.pi / 6, side / np.sqrt(3))
    polygon = _eighteen_gon(side)
    places = []
    for center in (np.array([0.5, reach]), np.array([1.0, height + reach])):
        places += [
            (center, polygon, 0.0),
            (center - np.array([0.0, reach]), up, -np.pi / 3),
            (center + reach * np.array([-height, -0.5]), down, np.pi / 3),
        ]
    contracted = [center + corners for center, corners, _ in places]
    deployed = [(1 + side) * center + corners @ _turn(angle).T for center, corners, angle in places]
    offsets = np.r_[0, np.cumsum([len(corners) for corners in contracted])]
    shifts = np.diag([1.0, 2 * height])
    return UnitCell(
        deployed=frozen(np.concatenate(deployed)),
        contracted=frozen(np.concatenate(contracted)),
        tiles=Loops(frozen(offsets, np.int64), frozen(np.arange(offsets[-1]), np.int64)),
        deployed_shifts=frozen((1 + side) * shifts),
        contracted_shifts=frozen(shifts),
        name="islamic-triangle",
    ).normalized()


def _eighteen_gon(side: float) -> Float[np.ndarray, "18 2"]:
    """Corners about the center, counter-clockwise; distance between neighbors 1."""
    reach, radius, bend = 1 / np.sqrt(3), side / np.sqrt(3), (1 + 2 * side) / 6
    corners = []
    for triangle in (30, 150, 270):
        corners += [
            (0.5 + bend) * _direction(triangle - 30),
            reach * _direction(triangle) + radius * _direction(triangle - 60),
            (reach - radius) * _direction(triangle),
            (0.5 - bend) * _direction(triangle + 30),
            (reach - radius) * _direction(triangle + 60),
            reach * _direction(triangle + 60) + radius * _direction(triangle + 120),
        ]
    return np.array(corners)


def _direction(degrees: int) -> Float[np.ndarray, "2"]:
    return np.array([np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))])


def _turn(angle: float) -> Float[np.ndarray, "2 2"]:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
