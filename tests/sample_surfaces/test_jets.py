"""Jets: the chain rules hold, by Taylor slopes, for every function and operator."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sample_surfaces.jets import FUNCTIONS, Jet, coordinates, radial_sinc

X = np.array([0.3, 0.9, 1.4, -0.2])
Y = np.array([0.8, 0.25, -0.6, 1.1])

COMBINATIONS: dict[str, Callable[[Jet, Jet], Jet]] = {
    "sum": lambda x, y: 2.0 + x + y * y * y + 3.0,
    "difference": lambda x, y: 1.0 - x * y * y - y - 0.5,
    "product": lambda x, y: (x * x * y) * (2.0 * y + x),
    "quotient": lambda x, y: (1.0 / (3.0 + x * y)) + x / (4.0 + y) + y / 2.0,
    "powers": lambda x, y: x**5 * y**3 + (x + y) ** 2 + y**1 + x**0,
    "sin": lambda x, y: FUNCTIONS["sin"](x * y + 1.0),
    "cos": lambda x, y: FUNCTIONS["cos"](2.0 * x - y * y),
    "exp": lambda x, y: FUNCTIONS["exp"](x * y),
    "tanh": lambda x, y: FUNCTIONS["tanh"](x + x * y),
    "sqrt": lambda x, y: FUNCTIONS["sqrt"](3.0 + x * y),
    "bump": lambda x, y: FUNCTIONS["bump"](x * y, y - 0.5),
    "radial_sinc near 0": lambda x, y: radial_sinc(x * x + y * y),
    "radial_sinc far from 0": lambda x, y: radial_sinc(30.0 * (x * x + y * y)),
}


def test_every_function_is_tested():
    """A function without a slope test would be a formula that nobody checked."""
    assert {name.split()[0] for name in COMBINATIONS} >= set(FUNCTIONS)


@pytest.mark.parametrize("name", COMBINATIONS)
def test_taylor_slope_is_three(name: str):
    """The remainder after the second-order term falls with the third power of the step."""
    function = COMBINATIONS[name]
    jet = function(*coordinates(X, Y))
    directions = np.random.default_rng(7).normal(size=(2, len(X)))
    remainders = []
    steps = 0.04 * 0.5 ** np.arange(4)
    for h in steps:
        a, b = h * directions
        predicted = np.sum(jet.parts * [a**0, a, b, a * a / 2, a * b, b * b / 2], axis=0)
        remainders.append(np.abs(function(*coordinates(X + a, Y + b)).value - predicted).max())
    slopes = np.diff(np.log(remainders)) / np.diff(np.log(steps))
    assert slopes[-1] == pytest.approx(3.0, abs=0.15)


def test_radial_sinc_has_its_limits_at_zero():
    """sin(sqrt q)/sqrt q = 1 - q/6 + q^2/120 - ..."""
    q, _ = coordinates(np.zeros(1), np.zeros(1))
    jet = radial_sinc(q)
    assert tuple(jet.parts[[0, 1, 3], 0]) == pytest.approx((1.0, -1 / 6, 1 / 60), rel=1e-15)


def test_radial_sinc_is_one_function_across_its_two_formulas():
    """Series and closed form agree to rounding, derivatives included, where one takes over from the other."""
    q, _ = coordinates(np.array([np.nextafter(4.0, 0.0), 4.0]), np.zeros(2))
    jet = radial_sinc(q)
    for row in (0, 1, 3):
        assert jet.parts[row, 0] == pytest.approx(jet.parts[row, 1], rel=1e-13)
