"""Interior angles of tile corners with their first and second derivatives."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float


def _sides(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    u, v = corners[:, 2] - corners[:, 1], corners[:, 0] - corners[:, 1]
    normal = np.cross(u, v)
    return u, v, normal, np.linalg.norm(normal, axis=1), np.einsum("ki,ki->k", u, v)


def corner_angles(corners: Float[np.ndarray, "k 3 3"]) -> Float[np.ndarray, " k"]:
    """Return the angle at the middle point of (previous, vertex, next): atan2(|u x v|, u.v), in (0, pi)."""
    _, _, _, sine, cosine = _sides(corners)
    return np.arctan2(sine, cosine)


def _frames(corners: np.ndarray) -> tuple[np.ndarray, ...]:
    u, v, normal, sine, cosine = _sides(corners)
    lu, lv = np.linalg.norm(u, axis=1), np.linalg.norm(v, axis=1)
    n = normal / np.maximum(sine, 1e-300)[:, None]
    uh, vh = u / lu[:, None], v / lv[:, None]
    return n, uh, vh, -np.cross(n, uh), np.cross(n, vh), lu, lv, sine, cosine


def corner_gradients(corners: Float[np.ndarray, "k 3 3"]) -> Float[np.ndarray, "k 9"]:
    """Return the derivatives of the angles with respect to (previous, vertex, next)."""
    _, _, _, a, b, lu, lv, _, _ = _frames(corners)
    du, dv = a / lu[:, None], b / lv[:, None]
    return np.concatenate([dv, -du - dv, du], axis=1)


def corner_hessians(corners: Float[np.ndarray, "k 3 3"]) -> Float[np.ndarray, "k 9 9"]:
    """Return the second derivatives of the angles with respect to (previous, vertex, next).

    With n the unit normal, a = -n x u/|u|, b = n x v/|v|:
    H_uu = (cot n n' - u a' - a u') / |u|^2, H_vv likewise, H_uv = -n n' / (sin |u| |v|).
    """
    n, uh, vh, a, b, lu, lv, sine, cosine = _frames(corners)
    outer = n[:, :, None] * n[:, None, :]
    # the angle is not smooth at 0 and pi: a floor keeps its curvature finite there
    sine_angle = np.maximum(sine / (lu * lv), 1e-6)
    cotangent = cosine / (lu * lv) / sine_angle

    def own(direction: np.ndarray, turned: np.ndarray, length: np.ndarray) -> np.ndarray:
        mixed = direction[:, :, None] * turned[:, None, :]
        return (cotangent[:, None, None] * outer - mixed - np.swapaxes(mixed, 1, 2)) / length[:, None, None] ** 2

    huu, hvv = own(uh, a, lu), own(vh, b, lv)
    huv = -outer / (sine_angle * lu * lv)[:, None, None]
    result = np.empty((len(n), 9, 9))
    result[:, 0:3, 0:3] = hvv
    result[:, 6:9, 6:9] = huu
    result[:, 0:3, 6:9] = result[:, 6:9, 0:3] = huv
    result[:, 3:6, 0:3] = result[:, 0:3, 3:6] = -(hvv + huv)
    result[:, 3:6, 6:9] = result[:, 6:9, 3:6] = -(huu + huv)
    result[:, 3:6, 3:6] = huu + hvv + 2 * huv
    return result
