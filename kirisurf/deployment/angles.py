"""Squares of the angles between two vectors, with exact derivatives that stay smooth where the angle closes."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.vectors import dot

BEGINS = -0.5 * np.pi
"""Angle at which planar angles begin, radians: they go on to 3 pi / 2, so that slits may open beyond pi."""

SMALL = 0.03
"""Angle in radians below which the derivatives by the cosine are taken from their series."""

ROUND = 0.02
"""Radius in radians by which spatial angles are rounded where they close."""

LEAST_SINE = 1e-8
"""In space an angle has no derivatives at pi: the sine is taken for no less."""

Derivatives = tuple[Float[np.ndarray, "2 d k"], dict[tuple[int, int], Float[np.ndarray, "d d k"]]]


def signed_angles(u: Float[np.ndarray, "2 k"], v: Float[np.ndarray, "2 k"]) -> Float[np.ndarray, " k"]:
    """Return the planar angles from u to v, counter-clockwise, from -pi / 2 up to 3 pi / 2.

    Examples
    --------
    >>> signed_angles(np.array([[1.0], [0.0]]), np.array([[-1.0], [-1.0]])).round(4).tolist()
    [3.927]
    """
    angle = np.arctan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])
    return np.where(angle < BEGINS, angle + 2 * np.pi, angle)


def squared_angles(u: Float[np.ndarray, "d k"], v: Float[np.ndarray, "d k"], angle: np.ndarray) -> Derivatives:
    """Return the derivatives of the squares of angles by u and v.

    Parameters
    ----------
    u, v : (d, k)
    angle : (k,), radians
        In the plane signed, in space between 0 and pi.
    """
    if len(u) == 3:
        return _spatial(u, v, angle)
    first, second = _planar(u, v)
    return 2 * angle * first, {
        (i, j): 2 * (first[i][:, None] * first[j][None] + angle * second[i, j]) for i, j in second
    }


def smooth_values(angle: Float[np.ndarray, " k"], dimension: int) -> Float[np.ndarray, " k"]:
    """Return angles that have derivatives where they close: see `smooth_angles`."""
    return angle if dimension == 2 else np.sqrt(angle**2 + ROUND**2) - ROUND


def smooth_angles(
    u: Float[np.ndarray, "d k"], v: Float[np.ndarray, "d k"], angle: np.ndarray
) -> tuple[Float[np.ndarray, " k"], Derivatives]:
    """Return angles that have derivatives where they close, with these.

    In the plane they are the signed angles. In space, where the angle has no sign, they are
    sqrt(angle^2 + r^2) - r with r = `ROUND`.
    """
    if len(u) == 2:
        return smooth_values(angle, 2), _planar(u, v)
    first, second = _spatial(u, v, angle)
    size = np.sqrt(angle**2 + ROUND**2)
    by, twice = 0.5 / size, -0.25 / size**3
    bends = {(i, j): by * bend + twice * first[i][:, None] * first[j][None] for (i, j), bend in second.items()}
    return smooth_values(angle, 3), (by * first, bends)


def _planar(u: np.ndarray, v: np.ndarray) -> Derivatives:
    """Derivatives of arg v - arg u: those of arg a are a' / |a|^2 with a' = a turned by a right angle."""
    slopes, bends = [], []
    for vector, sign in ((u, -1.0), (v, 1.0)):
        square = (vector**2).sum(axis=0)
        slope = sign * np.stack([-vector[1], vector[0]]) / square
        ray = vector / square
        slopes.append(slope)
        bends.append(-(ray[:, None] * slope[None] + slope[:, None] * ray[None]))
    return np.stack(slopes), {(0, 0): bends[0], (0, 1): np.zeros_like(bends[0]), (1, 1): bends[1]}


def _spatial(u: np.ndarray, v: np.ndarray, angle: np.ndarray) -> Derivatives:
    """Derivatives through the cosine c: (arccos c)^2 is analytic where the angle closes, c = 1."""
    by_cosine, twice = _by_cosine(angle)
    sizes = np.sqrt(dot(u, u)), np.sqrt(dot(v, v))
    rays = u / sizes[0], v / sizes[1]
    cosine = dot(*rays)
    slopes = (rays[1] - cosine * rays[0]) / sizes[0], (rays[0] - cosine * rays[1]) / sizes[1]
    projections = []
    for ray in rays:
        projection = -ray[:, None] * ray[None]
        for i in range(3):
            projection[i, i] += 1.0
        projections.append(projection)
    second = {}
    for i in range(2):
        part = rays[i][:, None] * slopes[i][None]
        bend = -(part + part.swapaxes(0, 1)) / sizes[i] - cosine * projections[i] / sizes[i] ** 2
        second[i, i] = twice * slopes[i][:, None] * slopes[i][None] + by_cosine * bend
    mixed = np.einsum("ijk,jlk->ilk", projections[0], projections[1]) / (sizes[0] * sizes[1])
    second[0, 1] = twice * slopes[0][:, None] * slopes[1][None] + by_cosine * mixed
    return by_cosine * np.stack(slopes), second


def _by_cosine(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative of the squared angle by its cosine."""
    square = np.minimum(angle, SMALL) ** 2
    first = -2 * (1 + square / 6 + 7 * square**2 / 360 + 31 * square**3 / 15120)
    second = 2 / 3 + 4 * square / 15 + 4 * square**2 / 63
    wide = np.maximum(angle, SMALL)
    sine = np.maximum(np.sin(wide), LEAST_SINE)
    large = angle > SMALL
    return (
        np.where(large, -2 * wide / sine, first),
        np.where(large, (2 - 2 * wide * np.cos(wide) / sine) / sine**2, second),
    )
