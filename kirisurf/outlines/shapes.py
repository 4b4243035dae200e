"""The curves that outlines are made of: lines, Bezier pieces, splines through points, arcs of ellipses."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from kirisurf.arrays import checked
from kirisurf.errors import UnusableError
from kirisurf.outlines.curve import Curve


def straight(points: ArrayLike) -> Curve:
    """Return the straight segments from point to point (n, 2), one piece each.

    Raises
    ------
    UnusableError
        Where there are fewer than two points, or two consecutive ones coincide.
    """
    x = _several(points)
    cubic = np.zeros((len(x) - 1, 4, 2))
    cubic[:, 0], cubic[:, 1] = x[:-1], np.diff(x, axis=0)
    return Curve.of_pieces(cubic)


def bezier(control_points: ArrayLike) -> Curve:
    """Return the Bezier curve of 2, 3 or 4 control points: a line, a parabola, a cubic.

    A cubic whose control points lie on the chord, in order, is the line, run through at even speed.

    Raises
    ------
    UnusableError
        Where there is another number of points, or all coincide.
    """
    p = checked(control_points, "control points", (None, 2))
    if not 2 <= len(p) <= 4:
        raise UnusableError(f"control points: expected 2 to 4, got {len(p)}")
    size = float(np.ptp(p, axis=0).max())
    if size == 0:
        raise UnusableError(f"control points: expected different points, got {len(p)} in one place, {p[0].tolist()}")
    if _on_the_chord(p, size):
        return straight(p[[0, -1]])
    if len(p) == 3:
        return Curve.of_pieces([[p[0], 2 * (p[1] - p[0]), p[0] - 2 * p[1] + p[2], np.zeros(2)]])
    second, third = 3 * (p[0] - 2 * p[1] + p[2]), p[3] - p[0] + 3 * (p[1] - p[2])
    return Curve.of_pieces([[p[0], 3 * (p[1] - p[0]), second, third]])


def spline(points: ArrayLike, knots: ArrayLike | None = None, ends: object = "not-a-knot") -> Curve:
    """Return the cubic spline through points (n, 2): two give a line, three a parabola.

    Parameters
    ----------
    points : (n, 2)
    knots : (n,), optional
        Increasing parameters of the points; 0, 1, 2, ... by default.
    ends : str or pair
        Conditions at the ends as `scipy.interpolate.CubicSpline` takes them.

    Raises
    ------
    UnusableError
        Where there are fewer than two points, or two consecutive ones coincide.

    Examples
    --------
    >>> spline([[0, 0], [1, 1], [2, 0]]).points(np.array([0.5]))
    array([[0.5 , 0.75]])
    """
    x = _several(points)
    t = np.arange(len(x), dtype=np.float64) if knots is None else checked(knots, "knots", (len(x),))
    steps = np.diff(t)
    coefficients = CubicSpline(t, x, bc_type=ends).c[::-1]
    scaled = coefficients * (steps[None, :] ** np.arange(4)[:, None])[..., None]
    return Curve.of_pieces(scaled.transpose(1, 0, 2))


def arc(center: ArrayLike, radius: float | Float[np.ndarray, "2 2"], start: float, sweep: float) -> Curve:
    """Return an arc of a circle or an ellipse, in pieces of at most a quarter turn.

    Parameters
    ----------
    center : (2,)
    radius : float or (2, 2)
        Of a circle; or two conjugate half diameters a, b as rows: x = center + a cos t + b sin t.
    start, sweep : float
        First angle t and its change, in radians; a positive sweep turns left on a circle.

    Raises
    ------
    UnusableError
        Where a value is not finite, or the arc has no extent.

    Examples
    --------
    >>> float(arc([0, 0], 2.0, 0.0, math.pi).length / math.pi)
    2.0...
    """
    middle = checked(center, "center of an arc", (2,))
    axes = radius * np.eye(2) if np.ndim(radius) == 0 else radius
    half = checked(axes, "half diameters of an arc", (2, 2))
    angles = checked([start, sweep], "angles of an arc", (2,))
    if angles[1] == 0 or np.linalg.det(half / (np.abs(half).max() or 1.0)) == 0:
        raise UnusableError(f"arc: expected a radius and an angle, got {half.tolist()} and {sweep:g} rad")
    count = max(1, math.ceil(abs(sweep) / (0.5 * math.pi) - 1e-9))
    cubic = np.zeros((count, 4, 2))
    cubic[:, 0] = middle
    begin = start + sweep * np.arange(count) / count
    return Curve.of_pieces(
        cubic, np.broadcast_to(half, (count, 2, 2)), np.stack([begin, np.full(count, sweep / count)], axis=1)
    )


def _several(points: ArrayLike) -> np.ndarray:
    x = checked(points, "points of a curve", (None, 2))
    if len(x) < 2:
        raise UnusableError(f"points of a curve: expected two or more, got {len(x)}")
    same = (np.diff(x, axis=0) == 0).all(axis=1)
    if same.any():
        k = int(np.flatnonzero(same)[0])
        raise UnusableError(f"points of a curve: expected consecutive ones to differ, got {x[k].tolist()} twice")
    return x


def _on_the_chord(p: np.ndarray, size: float) -> bool:
    chord = p[-1] - p[0]
    length = float(np.linalg.norm(chord))
    if length <= 1e-12 * size:
        return False
    along = (p - p[0]) @ chord / length
    across = (p - p[0]) @ np.array([-chord[1], chord[0]]) / length
    return bool(np.abs(across).max() <= 1e-12 * size and (np.diff(along) >= -1e-12 * size).all())
