"""Rigid tiles on point hinges: in how many ways they can move, and whether they lead from flat to deployed."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.deployment.energy import Energy
from kirisurf.deployment.factor import Factors
from kirisurf.deployment.path import STRAINLESS, Path
from kirisurf.errors import UnusableError

INDEPENDENT = 1e-5
"""Singular value of the rigidity matrix, whose rows are strains per displacement in tile edges, below which it is 0."""

RIGID = 10 * float(np.sqrt(STRAINLESS))
"""Largest strain of rigid tiles, 1e-5: next to the flat sheet, where the last digits come slowly, a state is taken at a
root mean square of 1e-6, and one spring may have more."""


def n_mechanisms(energy: Energy, points: Float[np.ndarray, "n d"], tolerance: float = INDEPENDENT) -> int:
    """Return the number of independent motions that strain no tile, to first order; rigid motions are not counted.

    It is the number of coordinates less the rank of the rigidity matrix R, the first derivatives of all strains and,
    in space, of the heights by which tiles fold, less the rigid motions of the sheet: 3 in the plane, 6 in space.
    The singular values of R below the tolerance are counted as the negative pivots of R'R - tolerance^2, by
    Sylvester's law of inertia: no singular value is computed, so that thousands of tiles take a second.

    Motions of first order need not be motions: in the flat sheet, where all slits are closed, most are not.

    Parameters
    ----------
    energy : Energy
    points : (n, d)
    tolerance : float

    Examples
    --------
    >>> from kirisurf.deployment.springs import energy_of
    >>> from kirisurf.pattern import quad_pattern
    >>> four = quad_pattern(1, 1, 0.3)
    >>> n_mechanisms(energy_of(four, four.contracted, dimension=2), four.deployed)
    1
    """
    still = energy.with_torsion(0.0)
    stiffness = energy.stiffness(np.arange(points.size).reshape(points.shape))
    bends = still.evaluate(points, curved=False).bends
    entries = stiffness.numbers(bends) * (energy.length / energy.unit_force)
    below = Factors().of(stiffness.matrix(entries, -(tolerance**2))).n_negative
    if below < 0:
        raise UnusableError("sheet: expected a rigidity matrix that can be factored, got one with a pivot of exactly 0")
    return below - (3 if energy.dimension == 2 else 6)


def is_rigid(path: Path) -> bool:
    """Are all states of a path without torsion free of strain, to `RIGID` in every spring?"""
    return bool(path.torsion == 0 and len(path.fractions) and path.largest_strains.max() <= RIGID)


def most_strained(path: Path, count: int = 5) -> tuple[float, tuple[int, ...]]:
    """Return the largest strain along a path, and the tiles that are strained most, worst first.

    Only tiles that are strained at least half as much as the worst one are named.
    """
    most = path.tile_strains.max(axis=0, initial=0.0)
    worst = np.argsort(-most, kind="stable")[:count]
    return float(most.max(initial=0.0)), tuple(int(k) for k in worst if most[k] >= 0.5 * most.max())
