"""Collisions along a path: how far a sheet opens before its tiles meet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from analysis.collisions import TOUCH, Collider, Collisions
from analysis.interpolation import Interpolation
from kirisurf.arrays import frozen
from kirisurf.errors import ParameterError
from kirisurf.loops import Loops

TOLERANCE = 1e-4
"""Length of the piece of the way within which the first contact is found."""


@dataclass(frozen=True, eq=False)
class PathCollisions:
    """The collisions along a path.

    Attributes
    ----------
    shares : (k,)
        Part of the way of every state.
    states : tuple of Collisions
        Of every state.
    free_until : float or None
        Part of the way up to which no tiles collide; the last share where none ever do, None where some collide in
        the first state.
    first_contact : Collisions or None
        At most the tolerance after `free_until`.
    """

    shares: Float[np.ndarray, " k"]
    states: tuple[Collisions, ...]
    free_until: float | None
    first_contact: Collisions | None

    @property
    def counts(self) -> np.ndarray:
        """Number of colliding pairs (k,) in every state."""
        return np.array([state.count for state in self.states])

    @property
    def depths(self) -> np.ndarray:
        """Largest depth (k,) over the tile edge in every state."""
        return np.array([state.deepest for state in self.states])

    @property
    def is_free(self) -> bool:
        """Whether no tiles collide in any of the states."""
        return self.first_contact is None


def path_collisions(
    states: Sequence[ArrayLike] | np.ndarray,
    tiles: Loops,
    shares: ArrayLike | None = None,
    thickness: float = 0.0,
    slit_width: float = 0.0,
    touch: float = TOUCH,
    tolerance: float = TOLERANCE,
    between: Callable[[float], np.ndarray] | None = None,
) -> PathCollisions:
    """Return the collisions in every state of a path, and where on the way the first one is.

    Before the first state with a collision, the way is halved until the tolerance is met. Unless `between` gives
    the states there, every tile moves rigidly from one state to the next, all by the same part of their turns
    (:class:`analysis.interpolation.Interpolation`). Tiles that meet and part again between two states are not seen.

    Parameters
    ----------
    states : (k, n, 2) or (k, n, 3), or a sequence of states, units
        From contracted to deployed; at least one.
    tiles : Loops
        As rigid as the path leaves them; their shapes are taken from the first state.
    shares : (k,), optional
        Part of the way of every state, ascending; by default equal steps from 0 to 1.
    thickness, slit_width, touch
        As for :meth:`analysis.collisions.Collider.of`.
    tolerance : float
        Of the place of the first contact, in parts of the way.
    between : callable, optional
        Returns the state at a part of the way.

    Raises
    ------
    ParameterError
        Where the numbers of states and shares differ, shares do not ascend, or a length is out of its range.
    UnusableError
        Where a state has another shape than the first, or is not finite.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> path_collisions([pattern.deployed], pattern.tiles).is_free
    True
    """
    way = np.linspace(0.0, 1.0, len(states)) if shares is None else np.asarray(shares, float)
    if not len(states) or way.shape != (len(states),):
        raise ParameterError(f"shares: expected one for each of at least one state, got {len(way)} for {len(states)}")
    if not (np.diff(way) > 0).all():
        raise ParameterError("shares: expected numbers that ascend, got others")
    if not tolerance > 0:
        raise ParameterError(f"tolerance: expected a number above 0, got {tolerance:.6g}")
    collider = Collider.of(states[0], tiles, thickness, slit_width, touch)
    found = tuple(collider.collisions(state) for state in states)
    met = next((k for k, state in enumerate(found) if state.count), None)
    if met is None:
        return PathCollisions(frozen(way), found, float(way[-1]), None)
    if met == 0:
        return PathCollisions(frozen(way), found, None, found[0])
    low, high, contact = float(way[met - 1]), float(way[met]), found[met]
    between = between or _rigid(tiles, np.asarray(states[met - 1], float), np.asarray(states[met], float), low, high)
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        here = collider.collisions(between(middle))
        if here.count:
            high, contact = middle, here
        else:
            low = middle
    return PathCollisions(frozen(way), found, low, contact)


def _rigid(tiles: Loops, begin: np.ndarray, end: np.ndarray, low: float, high: float) -> Callable[[float], np.ndarray]:
    """States from one to the next, of the same dimension."""
    dimension = begin.shape[1]
    motion = Interpolation.between(tiles, *(np.pad(state, ((0, 0), (0, 3 - dimension))) for state in (begin, end)))
    return lambda share: motion.at((share - low) / (high - low))[:, :dimension]
