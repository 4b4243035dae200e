"""The product (u x v).(v x w) of two normals with a common side, by components: arrays (3, k).

Positive where the turn from u to v and that from v to w face the same way; the form of the non-overlap rows of
Choi, Dudte, Mahadevan (2019).
"""

from __future__ import annotations

import numpy as np

from kirisurf.vectors import cross, dot, outer

_DIAGONAL = np.arange(3)


def value(u: np.ndarray, v: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return (u x v).(v x w), (k,)."""
    return dot(cross(u, v), cross(v, w))


def gradient(u: np.ndarray, v: np.ndarray, w: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the derivatives of scale (u x v).(v x w) by u, v and w, (3, k) each."""
    first, second = cross(u, v) * scale, cross(v, w) * scale
    return cross(v, second), cross(second, u) + cross(w, first), cross(first, v)


def hessian(u: np.ndarray, v: np.ndarray, w: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the second derivatives by uv, uw, vv and vw, (3, 3, k) each; those by uu and ww vanish.

    Of the form (u.v)(v.w) - (u.w)(v.v), which is the same function.
    """
    su, sv = scale * u, scale * v
    vu, vw, uw = outer(sv, u), outer(v, scale * w), outer(su, w)
    by_uv = vw - 2 * vw.swapaxes(0, 1)
    by_vw = vu.swapaxes(0, 1) - 2 * vu
    by_uw = outer(sv, v)
    by_vv = uw + uw.swapaxes(0, 1)
    for block, inner in ((by_uv, dot(sv, w)), (by_vw, dot(su, v)), (by_uw, -dot(sv, v)), (by_vv, -2 * dot(su, w))):
        block[_DIAGONAL, _DIAGONAL] += inner
    return by_uv, by_uw, by_vv, by_vw
