"""Many small vectors at once, by components: arrays (3, k), so that arithmetic runs along rows of length k."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int


def gathered(points: Float[np.ndarray, "n 3"], stencil: Int[np.ndarray, "k p"]) -> Float[np.ndarray, "p 3 k"]:
    """Return the points of stencils: one array (3, k) for every place of the stencil."""
    return np.ascontiguousarray(points.take(stencil.T, axis=0).transpose(0, 2, 1))


def dot(u: Float[np.ndarray, "3 k"], v: Float[np.ndarray, "3 k"]) -> Float[np.ndarray, " k"]:
    """Return u.v."""
    product = u * v
    return product[0] + product[1] + product[2]


def cross(u: Float[np.ndarray, "3 k"], v: Float[np.ndarray, "3 k"]) -> Float[np.ndarray, "3 k"]:
    """Return u x v."""
    result = np.empty(np.broadcast_shapes(u.shape, v.shape))
    np.subtract(u[1] * v[2], u[2] * v[1], out=result[0])
    np.subtract(u[2] * v[0], u[0] * v[2], out=result[1])
    np.subtract(u[0] * v[1], u[1] * v[0], out=result[2])
    return result


def outer(u: Float[np.ndarray, "3 k"], v: Float[np.ndarray, "3 k"]) -> Float[np.ndarray, "3 3 k"]:
    """Return the matrices u v'."""
    return u[:, None] * v[None]


def add_origin(values: Float[np.ndarray, "p 3 p 3 k"]) -> Float[np.ndarray, "k p3 p3"]:
    """Complete symmetric second derivatives by points (origin, ends) that depend on the vectors between them alone.

    Those by the ends are given and those by the origin are written in place: rows and columns sum to zero.
    """
    np.negative(values[1:, :, 1:].sum(axis=0), out=values[0, :, 1:])
    values[1:, :, 0] = values[0, :, 1:].transpose(1, 2, 0, 3)
    np.negative(values[0, :, 1:].sum(axis=1), out=values[0, :, 0])
    size = 3 * len(values)
    return np.moveaxis(values.reshape(size, size, -1), -1, 0)
