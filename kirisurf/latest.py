"""A function that remembers its latest value."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np

Value = TypeVar("Value")


class Latest(Generic[Value]):
    """A function of points whose latest value is kept: residual, Jacobian and curvature share their geometry.

    Points are compared by content, which costs microseconds, so that an array changed in place is no danger.

    Parameters
    ----------
    function : callable
        Of points (n, 3).
    """

    def __init__(self, function: Callable[[np.ndarray], Value]) -> None:
        self._function = function
        # one attribute, so that two threads cannot mix their points and values
        self._kept: tuple[np.ndarray, Value] | None = None

    def __call__(self, points: np.ndarray) -> Value:
        """Return the function's value at `points`."""
        kept = self._kept
        if kept is None or not np.array_equal(kept[0], points):
            kept = (points.copy(), self._function(points))
            self._kept = kept
        return kept[1]
