"""How the tiles and the lattice of a unit cell turn between its two states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from jaxtyping import Complex, Float

from kirisurf.arrays import frozen
from kirisurf.unit_cell import UnitCell


def upright(cell: UnitCell) -> UnitCell:
    """Return the cell in the frame in which contracted columns follow each other along the first axis."""
    x, y = cell.contracted_shifts[0]
    if y == 0 and x > 0:
        return cell
    turn = np.array([[x, -y], [y, x]]) / np.hypot(x, y)
    return replace(
        cell,
        contracted=frozen(cell.contracted @ turn),
        contracted_shifts=frozen(cell.contracted_shifts @ turn),
        openings=tuple(frozen(opening @ turn) for opening in cell.openings),
    )


def arms(cell: UnitCell) -> tuple[Complex[np.ndarray, " k"], Complex[np.ndarray, " s"]]:
    """Return the contracted center of every tile (k,), and every corner's place from it (s,), as complex numbers."""
    corner = cell.contracted[cell.tiles.indices] @ np.array([1, 1j])
    owners = cell.tiles.owners
    center = (np.bincount(owners, corner.real) + 1j * np.bincount(owners, corner.imag)) / cell.tiles.sizes
    return center, corner - center[owners]


def tile_turns(cell: UnitCell) -> Float[np.ndarray, " k"]:
    """Return the turn of every tile from contracted to deployed against that of the lattice, in radians.

    The rotation that fits the corners best (least squares), in (-pi, pi].
    """
    opened = replace(cell, contracted=cell.deployed)
    before, after, owners = arms(cell)[1], arms(opened)[1], cell.tiles.owners
    moment = before.conj() * after
    total = np.bincount(owners, moment.real) + 1j * np.bincount(owners, moment.imag)
    tilted = tilt(cell.contracted_shifts, cell.deployed_shifts[None] @ np.array([1, 1j]))
    return np.angle(total * np.exp(-1j * tilted))


def tilt(contracted: Float[np.ndarray, "2 2"], shifts: Complex[np.ndarray, "t 2"]) -> Float[np.ndarray, " t"]:
    """Return the angles by which lattices are turned against a contracted one, in radians.

    The rotation in the polar decomposition of the linear map from one to the other.

    Parameters
    ----------
    contracted : (2, 2)
        Translations to the next column (row 0) and the next row.
    shifts : (t, 2) complex
        The same of the other lattices.
    """
    gradient = np.linalg.inv(contracted) @ shifts.T
    # rows are the images of the axes, 1 and 1j where nothing turns
    return np.angle(gradient[0] - 1j * gradient[1])
