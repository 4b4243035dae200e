"""Similarities: one shape laid on another as it is, but for its size, its place and its attitude."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen


def laid_on(points: Float[np.ndarray, "n 3"], goal: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Return points moved by the similarity that brings them nearest to others (least squares).

    Minimizes sum |s R p + c - g|^2 over scales s, rotations R and shifts c; Umeyama, IEEE PAMI 13 (1991) 376.

    Parameters
    ----------
    points, goal : (n, 3)

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
    >>> laid_on(corners, 2 * corners + 1).round(9).tolist()
    [[1.0, 1.0, 1.0], [3.0, 1.0, 1.0], [3.0, 3.0, 1.0]]
    """
    if not len(points):
        return points
    centered, wanted = points - points.mean(axis=0), goal - goal.mean(axis=0)
    left, sizes, right = np.linalg.svd(centered.T @ wanted)
    sign = np.array([1.0, 1.0, np.sign(np.linalg.det(left @ right)) or 1.0])
    spread = (centered**2).sum()
    scale = (sizes * sign).sum() / spread if spread > 0 else 1.0
    return frozen(scale * centered @ (left * sign) @ right + goal.mean(axis=0))
