"""Interior angles of tile corners with their first and second derivatives."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from jaxtyping import Float

from kirisurf.vectors import cross, dot, outer


class CornerAngles:
    """The angles at the middle of (previous, vertex, next): atan2(|u x v|, u.v), in (0, pi).

    u leads from the vertex to the next point and v to the previous one; n is the unit normal, a = -n x u/|u|
    and b = n x v/|v|, so that a/|u| and b/|v| are the derivatives of the angle by u and by v.

    Parameters
    ----------
    corners : (3, 3, k)
        Points (previous, vertex, next) of k corners, by components.
    """

    def __init__(self, corners: Float[np.ndarray, "3 3 k"]) -> None:
        self._u, self._v = corners[2] - corners[1], corners[0] - corners[1]
        normal = cross(self._u, self._v)
        self._sine, self._cosine = np.sqrt(dot(normal, normal)), dot(self._u, self._v)
        self._normal = normal

    @cached_property
    def angles(self) -> Float[np.ndarray, " k"]:
        """The angles."""
        return np.arctan2(self._sine, self._cosine)

    @cached_property
    def lengths(self) -> Float[np.ndarray, " k"]:
        """Lengths of the edges from the vertex to the next point."""
        return np.sqrt(dot(self._u, self._u))

    @cached_property
    def directions(self) -> Float[np.ndarray, "3 k"]:
        """Unit vectors from the vertex to the next point."""
        return self._u / self.lengths

    @cached_property
    def _frames(self) -> tuple[np.ndarray, ...]:
        lv = np.sqrt(dot(self._v, self._v))
        n, vh = self._normal / np.maximum(self._sine, 1e-300), self._v / lv
        return n, vh, cross(self.directions, n), cross(n, vh), lv

    @cached_property
    def gradients(self) -> Float[np.ndarray, "3 3 k"]:
        """Derivatives of the angles by (previous, vertex, next)."""
        _, _, a, b, lv = self._frames
        result = np.empty((3, *a.shape))
        np.divide(b, lv, out=result[0])
        np.divide(a, self.lengths, out=result[2])
        np.negative(result[0] + result[2], out=result[1])
        return result

    def hessians(
        self, weights: Float[np.ndarray, " k"], stretch: Float[np.ndarray, " k"] | None = None
    ) -> Float[np.ndarray, "k 9 9"]:
        """Return second derivatives of weights * angles + stretch * lengths by (previous, vertex, next).

        H_uu = (cot n n' - u a' - a u') / |u|^2 with u of unit length, H_vv likewise, and
        H_uv = -n n' / (sin |u| |v|); a length has (1 - u u') / |u|.
        """
        (n, vh, a, b, lv), lu, uh = self._frames, self.lengths, self.directions
        # the angle is not smooth at 0 and pi: a floor keeps its curvature finite there
        sine_angle = np.maximum(self._sine / (lu * lv), 1e-6)
        cotangent = self._cosine / (lu * lv) / sine_angle
        normals = outer(n, n)

        def own(direction: np.ndarray, turned: np.ndarray, length: np.ndarray) -> np.ndarray:
            scale = weights / length**2
            mixed = outer(direction * scale, turned)
            return (cotangent * scale) * normals - (mixed + mixed.swapaxes(0, 1))

        huu, hvv = own(uh, a, lu), own(vh, b, lv)
        huv = (-weights / (sine_angle * lu * lv)) * normals
        if stretch is not None:
            bend = stretch / lu
            huu -= outer(bend * uh, uh)
            huu[[0, 1, 2], [0, 1, 2]] += bend
        mu, mv = huu + huv, hvv + huv
        result = np.empty((3, 3, 3, 3, len(weights)))
        places = {(0, 0): hvv, (2, 2): huu, (0, 2): huv, (0, 1): -mv, (1, 2): -mu, (1, 1): mu + mv}
        # every block is symmetric
        for (i, j), block in places.items():
            result[i, :, j] = result[j, :, i] = block
        return np.moveaxis(result.reshape(9, 9, -1), -1, 0)
