"""Bicubic Bezier patches: control nets, points and derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from analysis.bernstein import tensor_rows


@dataclass(frozen=True, eq=False)
class BezierPatch:
    """g bicubic Bezier patches.

    The control net b_ij belongs to the monomials of u (row i) and v (column j) on [0, 1]^2::

        v
        1   b03 --- b13 --- b23 --- b33
        |    |       |       |       |
            b02 --- b12 --- b22 --- b32
        |    |       |       |       |
            b01 --- b11 --- b21 --- b31
        |    |       |       |       |
        0   b00 --- b10 --- b20 --- b30
             0 ------------------- 1   u

    S(u, v) = sum_ij B_i(u) B_j(v) b_ij with the cubic Bernstein polynomials B_i.

    Attributes
    ----------
    nets : (g, 4, 4, 3), units
    """

    nets: Float[np.ndarray, "g 4 4 3"]

    def __len__(self) -> int:
        return len(self.nets)

    def evaluate(self, u: Float[np.ndarray, "g q"], v: Float[np.ndarray, "g q"]) -> Float[np.ndarray, "g q 3"]:
        """Return the points of every patch at its own q parameters, units."""
        return self.derivative(u, v, 0, 0)

    def derivative(
        self, u: Float[np.ndarray, "g q"], v: Float[np.ndarray, "g q"], order_u: int, order_v: int
    ) -> Float[np.ndarray, "g q 3"]:
        """Return d^(i+j) S / du^i dv^j of every patch at its own q parameters, orders up to 3."""
        return tensor_rows(u, v, order_u, order_v) @ self.nets.reshape(len(self.nets), 16, 3)
