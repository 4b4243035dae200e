"""Second-order jets: a function of (x, y) carried with its exact first and second derivatives.

Sums, products and compositions of jets follow the sum, product and chain rules, so that a height written
once as an ordinary expression comes with derivatives that are closed-form, not differences.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

# Below this argument the power series of sin(sqrt q)/sqrt q is exact to rounding; above it, the closed form is.
_SERIES_BELOW = 4.0


@dataclass(frozen=True, eq=False)
class Jet:
    """A function's values at n places with its derivatives there.

    Attributes
    ----------
    parts : (6, n)
        Rows: value, d/dx, d/dy, d2/dx2, d2/dxdy, d2/dy2. One array, because most rules treat them alike.
    """

    parts: Float[np.ndarray, "6 n"]

    @property
    def value(self) -> np.ndarray:
        """Values (n,)."""
        return self.parts[0]

    @property
    def gradient(self) -> np.ndarray:
        """First derivatives (2, n): d/dx, d/dy."""
        return self.parts[1:3]

    @property
    def second(self) -> np.ndarray:
        """Second derivatives (3, n): d2/dx2, d2/dxdy, d2/dy2."""
        return self.parts[3:]

    def __add__(self, other: Jet | float) -> Jet:
        """Return the sum with a jet or a number."""
        if isinstance(other, Jet):
            return Jet(self.parts + other.parts)
        parts = self.parts.copy()
        parts[0] += other
        return Jet(parts)

    def __mul__(self, other: Jet | float) -> Jet:
        """Return the product with a jet or a number."""
        if not isinstance(other, Jet):
            return Jet(self.parts * other)
        a, b = self.parts, other.parts
        parts = a * b[0] + a[0] * b
        parts[0] = a[0] * b[0]
        parts[3] += 2 * a[1] * b[1]
        parts[4] += a[1] * b[2] + a[2] * b[1]
        parts[5] += 2 * a[2] * b[2]
        return Jet(parts)

    def __pow__(self, k: int) -> Jet:
        """Return the power by a whole number k >= 0."""
        v = self.value
        first = k * v ** (k - 1) if k > 0 else np.zeros_like(v)
        second = k * (k - 1) * v ** (k - 2) if k > 1 else np.zeros_like(v)
        return self.composed(v**k, first, second)

    def __truediv__(self, other: Jet | float) -> Jet:
        """Return the quotient by a jet or a number."""
        return self * (other.reciprocal() if isinstance(other, Jet) else 1.0 / other)

    def __neg__(self) -> Jet:
        """Return the jet with every sign changed."""
        return Jet(-self.parts)

    def __sub__(self, other: Jet | float) -> Jet:
        """Return the difference to a jet or a number."""
        return self + (-other)

    def __rsub__(self, other: float) -> Jet:
        """Return a number less this jet."""
        return -self + other

    def __rtruediv__(self, other: float) -> Jet:
        """Return a number divided by this jet."""
        return self.reciprocal() * other

    __radd__ = __add__
    __rmul__ = __mul__

    def reciprocal(self) -> Jet:
        """Return 1 / self."""
        inverse = 1.0 / self.value
        return self.composed(inverse, -(inverse**2), 2 * inverse**3)

    def composed(self, value: np.ndarray, first: np.ndarray, second: np.ndarray) -> Jet:
        """Return g(self) from the values (n,) of g, g' and g'' at `self.value` (chain rule)."""
        dx, dy = self.gradient
        parts = first * self.parts
        parts[0] = value
        parts[3] += second * dx * dx
        parts[4] += second * dx * dy
        parts[5] += second * dy * dy
        return Jet(parts)


def coordinates(x: np.ndarray, y: np.ndarray) -> tuple[Jet, Jet]:
    """Return the jets of the functions x and y at n places, given by their coordinates (n,) each."""
    parts = np.zeros((2, 6, len(x)))
    parts[0, 0], parts[1, 0] = x, y
    parts[0, 1] = parts[1, 2] = 1.0
    return Jet(parts[0]), Jet(parts[1])


def sin(a: Jet) -> Jet:
    """Return the sine of a jet."""
    s, c = np.sin(a.value), np.cos(a.value)
    return a.composed(s, c, -s)


def cos(a: Jet) -> Jet:
    """Return the cosine of a jet."""
    s, c = np.sin(a.value), np.cos(a.value)
    return a.composed(c, -s, -c)


def exp(a: Jet) -> Jet:
    """Return the exponential of a jet."""
    e = np.exp(a.value)
    return a.composed(e, e, e)


def tanh(a: Jet) -> Jet:
    """Return the hyperbolic tangent of a jet."""
    t = np.tanh(a.value)
    slope = 1 - t * t
    return a.composed(t, slope, -2 * t * slope)


def sqrt(a: Jet) -> Jet:
    """Return the square root of a positive jet."""
    root = np.sqrt(a.value)
    return a.composed(root, 0.5 / root, -0.25 / (root * a.value))


def bump(u: Jet, v: Jet) -> Jet:
    """Return the Gaussian bell exp(-(u^2 + v^2) / 2), one high and one standard deviation wide in u and v."""
    return exp((u * u + v * v) * -0.5)


def radial_sinc(q: Jet) -> Jet:
    """Return sin(s) / s at s = sqrt(q), q >= 0, as the smooth function of q that it is.

    In q the function is entire, so that sin(8 r) / (8 r) = radial_sinc(64 (x^2 + y^2)) has its
    derivatives at r = 0 as well; dividing by r would not.
    """
    small = q.value < _SERIES_BELOW
    near = np.where(small, q.value, 0.0)
    s = np.sqrt(np.where(small, _SERIES_BELOW, q.value))
    sine, cosine = np.sin(s), np.cos(s)
    closed = (sine / s, (s * cosine - sine) / (2 * s**3), (3 * sine - 3 * s * cosine - s * s * sine) / (4 * s**5))
    value, first, second = (np.where(small, _sinc_series(near, k), closed[k]) for k in range(3))
    return q.composed(value, first, second)


def _sinc_series(q: np.ndarray, derivative: int) -> np.ndarray:
    # Horner's rule on the derivative of sum_k (-q)^k / (2k + 1)!.
    terms = [1.0]
    for k in range(1, 20):
        terms.append(-terms[-1] / ((2 * k) * (2 * k + 1)))
    series = np.polynomial.Polynomial(terms)
    return series.deriv(derivative)(q) if derivative else series(q)


FUNCTIONS: dict[str, Callable[..., Jet]] = {
    "sin": sin,
    "cos": cos,
    "exp": exp,
    "tanh": tanh,
    "sqrt": sqrt,
    "bump": bump,
    "radial_sinc": radial_sinc,
}
