"""Bicubic patches by least squares: arithmetic on control nets."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from analysis.bernstein import difference_matrix, tensor_rows
from kirisurf.loops import Loops

SMOOTHING = 1e-3
"""Weight of the third differences of the control net against the vertices (both squared)."""

SMOOTHING_OF_MANY = 1e-5
"""The same where a hole has at least 16 vertices round it, as many as control points: they determine the cubic part
themselves. Where they do not lie symmetric about the hole's center (octagons and squares, 18-gons and triangles), a
weight of 1e-3 would leave an error of first order in the curvature there; this one is of second order, for 1.1 to 1.6
times the noise."""


def fit_patches(
    points: Float[np.ndarray, "n d"],
    parameters: Float[np.ndarray, "n 2"],
    loops: Loops,
    smoothing: float | None = None,
) -> Float[np.ndarray, "g 4 4 d"]:
    """Return the control nets of least-squares patches.

    Minimizes, for every loop of points x_k at (u_k, v_k),

        sum_k |S(u_k, v_k) - x_k|^2 + w sum |third differences of the net, pure and mixed|^2,

    so that a surface that is quadratic in (u, v) is returned as it is, and the cubic part is as small as
    the points allow.

    Parameters
    ----------
    points : (n, d), units
    parameters : (n, 2)
        In [0, 1]^2.
    loops : Loops
        Numbers of the points of every patch.
    smoothing : float, optional
        w; by default `SMOOTHING`, and `SMOOTHING_OF_MANY` for loops of at least 16 points.
    """
    nets = np.zeros((len(loops), 16, points.shape[1]))
    for size, (which, indices) in loops.by_size().items():
        weight = (SMOOTHING_OF_MANY if size >= 16 else SMOOTHING) if smoothing is None else smoothing
        rows = tensor_rows(parameters[indices, 0], parameters[indices, 1])
        nets[which] = fitted_nets(rows, points[indices], np.sqrt(weight) * net_differences(3))
    return nets.reshape(len(loops), 4, 4, points.shape[1])


def fitted_nets(
    rows: Float[np.ndarray, "g m 16"], values: Float[np.ndarray, "g m d"], penalty: Float[np.ndarray, "p 16"]
) -> Float[np.ndarray, "g 16 d"]:
    """Return the control points b that minimize |rows b - values|^2 + |penalty b|^2 for every patch."""
    system = np.concatenate([rows, np.broadcast_to(penalty, (len(rows), *penalty.shape))], axis=1)
    # the pseudo-inverse also answers where points coincide; such holes are flagged elsewhere
    return np.linalg.pinv(system)[:, :, : rows.shape[1]] @ values


def net_differences(order: int) -> Float[np.ndarray, "p 16"]:
    """Return all differences of a 4 x 4 net of given order (2 or 3), pure and mixed.

    Weighted as in the squared length of all derivatives of that order: 1, 2, 1 or 1, 3, 3, 1.
    """
    binomial = {2: (1.0, 2.0, 1.0), 3: (1.0, 3.0, 3.0, 1.0)}[order]
    pairs = [(difference_matrix(4, k), difference_matrix(4, order - k)) for k in range(order + 1)]
    return np.concatenate([np.sqrt(weight) * np.kron(*pair) for weight, pair in zip(binomial, pairs, strict=True)])


def conditions(rows: Float[np.ndarray, "g m k"]) -> Float[np.ndarray, " g"]:
    """Return the condition number of every matrix of m rows, infinite where it has fewer rows than columns."""
    if rows.shape[1] < rows.shape[2] or not len(rows):
        return np.full(len(rows), np.inf)
    values = np.linalg.svd(rows, compute_uv=False)
    return values[:, 0] / np.maximum(values[:, -1], 1e-300)
