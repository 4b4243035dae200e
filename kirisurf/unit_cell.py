"""Unit cells: a few tiles, known contracted and deployed, and how they repeat."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.loops import Loops


@dataclass(frozen=True, eq=False)
class UnitCell:
    """A unit cell of a periodic tessellation.

    Attributes
    ----------
    deployed, contracted : (p, 2)
        The same p points in both states.
    tiles : Loops
        Counter-clockwise tiles on these points.
    deployed_shifts, contracted_shifts : (2, 2)
        Row 0 is the translation to the next column, row 1 to the next row.
    name : str
    openings : tuple of (_, 2)
        Corners of what stays open in the contracted cell, counter-clockwise: by design, no tile lies there.
    """

    deployed: Float[np.ndarray, "p 2"]
    contracted: Float[np.ndarray, "p 2"]
    tiles: Loops
    deployed_shifts: Float[np.ndarray, "2 2"]
    contracted_shifts: Float[np.ndarray, "2 2"]
    name: str
    openings: tuple[Float[np.ndarray, "_ 2"], ...] = ()

    @property
    def area(self) -> float:
        """Area of the contracted cell, openings included."""
        return float(abs(np.linalg.det(self.contracted_shifts)))

    @property
    def stretches(self) -> Float[np.ndarray, " 2"]:
        """Largest and smallest linear stretch of the sheet from contracted to deployed, over all directions.

        Examples
        --------
        >>> quad_cell().stretches.round(4).tolist()
        [1.4142, 1.4142]
        """
        return np.linalg.svd(np.linalg.solve(self.contracted_shifts, self.deployed_shifts), compute_uv=False)

    def normalized(self) -> UnitCell:
        """Return the same cell in both states at the scale at which the contracted cell has area 1."""
        scale = self.area**-0.5
        return replace(
            self,
            deployed=frozen(scale * self.deployed),
            contracted=frozen(scale * self.contracted),
            deployed_shifts=frozen(scale * self.deployed_shifts),
            contracted_shifts=frozen(scale * self.contracted_shifts),
            openings=tuple(frozen(scale * opening) for opening in self.openings),
        )


def quad_cell(rotation: float = np.pi / 4) -> UnitCell:
    """Return the 2x2 cell of the rotating-squares pattern.

    Parameters
    ----------
    rotation : float
        Angle in radians by which each tile is turned, alternately left and right: 0 is closed, pi/4 fully
        open. The slits open by twice this angle. Contracted tiles have side 1/2, so that a contracted
        cell is a unit square; the deployed cell is larger by cos(rotation) + sin(rotation).
    """
    c, s = np.cos(rotation), np.sin(rotation)
    square = np.array([[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]])
    deployed, contracted = [], []
    for row in range(2):
        for column in range(2):
            centre = np.array([0.5 * column + 0.25, 0.5 * row + 0.25])
            turn = s if (row + column) % 2 == 0 else -s
            deployed.append((c + s) * centre + square @ np.array([[c, turn], [-turn, c]]))
            contracted.append(centre + square)
    return UnitCell(
        deployed=frozen(np.concatenate(deployed)),
        contracted=frozen(np.concatenate(contracted)),
        tiles=Loops.from_lists(np.arange(16).reshape(4, 4)),
        deployed_shifts=frozen((c + s) * np.eye(2)),
        contracted_shifts=frozen(np.eye(2)),
        name="quad",
    )
