"""Frames: the sheet between its two states, as files show it, with what can be measured on every one of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from analysis import polygons, rigidity
from analysis.fields import hole_openings
from analysis.interpolation import Interpolation
from kirisurf.arrays import checked, frozen
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class Frame:
    """The sheet at one moment.

    Attributes
    ----------
    share : float
        0 is contracted, 1 is deployed.
    points : (n, 3), units
    isometry : (t,)
        Largest change of a tile's vertex-to-vertex distance from the contracted state, over the median tile edge:
        how far from rigid the interpolation leaves a tile.
    opening_angle : (h,), rad
        Smallest at a slit end of every hole; NaN for a hole without one.
    """

    share: float
    points: Float[np.ndarray, "n 3"]
    isometry: Float[np.ndarray, " t"]
    opening_angle: Float[np.ndarray, " h"]


def frames(
    tessellation: Tessellation, contracted: ArrayLike, deployed: ArrayLike, shares: Iterable[float]
) -> Iterator[Frame]:
    """Yield the sheet at shares of the way between its states: interpolated, see `Interpolation`, no mechanism.

    The contracted sheet is moved, without being turned over or changed in size, to where it lies nearest to the
    deployed one, so that nothing flies through the picture.

    Parameters
    ----------
    tessellation : Tessellation
    contracted : (n, 2) or (n, 3), units
    deployed : (n, 3), units
    shares : iterable of float
        From 0 to 1.

    Raises
    ------
    UnusableError
        Where an array has another shape or a number that is not finite.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> flat, opened = (np.c_[state, np.zeros(pattern.n_vertices)] for state in (pattern.contracted, pattern.deployed))
    >>> [round(float(frame.opening_angle.min()), 6) for frame in frames(pattern, flat, opened, (0.0, 1.0))]
    [0.0, 1.570796]
    """
    space = checked(deployed, "deployed vertices", (tessellation.n_vertices, 3))
    width = np.shape(contracted)[1] if np.ndim(contracted) == 2 else 0
    flat = checked(contracted, "contracted vertices", (len(space), 2 if width == 2 else 3))
    if width == 2:
        flat = frozen(np.pad(flat, ((0, 0), (0, 1))))
    tiles = tessellation.tiles
    length = float(np.median(polygons.edge_lengths(space, tiles)))
    between = Interpolation.between(tiles, laid_beneath(flat, space), space)
    for share in shares:
        points = between.at(share)
        local = points - points.mean(axis=0)
        changes = rigidity.shape_changes(local, flat, tiles) / length
        opening, _ = hole_openings(tessellation, local)
        yield Frame(float(share), points, frozen(changes), frozen(opening))


def laid_beneath(flat: Float[np.ndarray, "n 3"], deployed: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Return the contracted vertices turned and shifted to lie nearest to the deployed ones (least squares)."""
    middle, goal = flat.mean(axis=0), deployed.mean(axis=0)
    turn, _ = Rotation.align_vectors(deployed - goal, flat - middle)
    return frozen(turn.apply(flat - middle) + goal)
