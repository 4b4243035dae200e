"""Cubic Bernstein polynomials and tensor-product evaluation: arithmetic only."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

BINOMIALS = (np.array([1.0]), np.array([1.0, 1.0]), np.array([1.0, 2.0, 1.0]), np.array([1.0, 3.0, 3.0, 1.0]))


def bernstein(t: Float[np.ndarray, "*n"], degree: int = 3) -> Float[np.ndarray, "*n k"]:
    """Return the degree + 1 Bernstein polynomials at t: C(degree, i) t^i (1 - t)^(degree - i)."""
    i = np.arange(degree + 1)
    t = np.asarray(t)[..., None]
    return BINOMIALS[degree] * t**i * (1 - t) ** (degree - i)


def cubic_basis(t: Float[np.ndarray, "*n"], order: int = 0) -> Float[np.ndarray, "*n 4"]:
    """Return the derivative of given order (0 to 3) of the four cubic Bernstein polynomials at t.

    The derivative of a Bezier curve has the differences of its control points, times the degree, as control
    points; read for the basis, that is B_(3-k) times the k-th difference matrix times 3!/(3-k)!.
    """
    factor = (1.0, 3.0, 6.0, 6.0)[order]
    return factor * (bernstein(t, 3 - order) @ difference_matrix(4, order))


def difference_matrix(n: int, order: int) -> Float[np.ndarray, "m n"]:
    """Return the forward differences of given order of n values as a matrix (n - order, n)."""
    return np.diff(np.eye(n), n=order, axis=0)


def tensor_rows(
    u: Float[np.ndarray, "*n"], v: Float[np.ndarray, "*n"], order_u: int = 0, order_v: int = 0
) -> Float[np.ndarray, "*n 16"]:
    """Return the weights of the 16 control points in the derivative d^(i+j) / du^i dv^j at (u, v).

    Control points are counted with the row (direction u) first: 4 i + j.
    """
    a, b = cubic_basis(u, order_u), cubic_basis(v, order_v)
    return (a[..., :, None] * b[..., None, :]).reshape(*a.shape[:-1], 16)
