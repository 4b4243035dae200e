"""The springs of a sheet: what its tiles and slits are in the energy of a deployment."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import checked, frozen
from kirisurf.deployment.elements import Contacts, Folds, Hinges, Rods, folds_of
from kirisurf.deployment.energy import Energy, checked_torsion
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.tessellation import Tessellation


def energy_of(
    tessellation: Tessellation,
    contracted: Float[np.ndarray, "n 2"],
    torsion: float = 0.0,
    dimension: int = 3,
    contact: bool = True,
) -> Energy:
    """Return the energy of a sheet whose rest state is the contracted one.

    Parameters
    ----------
    tessellation : Tessellation
    contracted : (n, 2)
        Contracted points.
    torsion : float
        lambda: stiffness of the slits' torsional springs over that of the rods.
    dimension : int
        2 in the plane, 3 in space.
    contact : bool
        Keep the sides of slits from overlapping, in the plane; False for the energy of the paper.

    Raises
    ------
    ParameterError
        Where the dimension is neither, or lambda is negative or not finite.
    UnusableError
        Where a tile has two corners in one place, or no area.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> sheet = quad_pattern(2, 2)
    >>> energy = energy_of(sheet, sheet.contracted, dimension=2)
    >>> bool(energy.value(sheet.contracted) < 1e-25), bool(energy.value(sheet.deployed) < 1e-25)
    (True, True)
    """
    if dimension not in (2, 3):
        raise ParameterError(f"dimension: expected 2 or 3, got {dimension}")
    flat = checked(contracted, "contracted", (tessellation.n_vertices, 2))
    pairs, owners, folds, scales = [], [], [], []
    for size, (which, loops) in tessellation.tiles.by_size().items():
        first, second = np.triu_indices(size, 1)
        pairs.append(np.stack([loops[:, first], loops[:, second]], axis=2).reshape(-1, 2))
        owners.append(np.repeat(which, len(first)))
        if dimension == 3 and size > 3:
            stencil, scale = folds_of(flat, loops)
            folds.append(stencil)
            scales.append(scale)
    rods = np.concatenate(pairs)
    lengths = np.linalg.norm(flat[rods[:, 0]] - flat[rods[:, 1]], axis=1)
    edges = tessellation.tiles.edges
    length = float(np.median(np.linalg.norm(flat[edges[:, 0]] - flat[edges[:, 1]], axis=1)))
    owner = np.concatenate(owners)
    if not lengths.min() > 1e-9 * length:
        raise UnusableError(
            f"tile {owner[lengths.argmin()]}: expected corners apart from each other, got two in one place"
        )
    hinges = frozen(tessellation.hinges[tessellation.slit_ends][:, [1, 0, 2]], np.int64)
    bounds: Folds | Contacts | None = Contacts(hinges) if contact and dimension == 2 else None
    if folds:
        bounds = Folds(frozen(np.concatenate(folds), np.int64), frozen(np.concatenate(scales)))
    return Energy(
        Rods(frozen(rods, np.int64), frozen(lengths)),
        Hinges(hinges),
        bounds,
        checked_torsion(torsion),
        tessellation.n_vertices,
        dimension,
        length,
        _area(flat, edges),
        frozen(owner, np.int64),
        tessellation.n_tiles,
    )


def _area(flat: np.ndarray, edges: np.ndarray) -> float:
    a, b = flat[edges[:, 0]] - flat[0], flat[edges[:, 1]] - flat[0]
    return float(0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())
