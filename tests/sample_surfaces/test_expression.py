"""Expressions: text becomes arithmetic and never anything else."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.errors import ParameterError
from sample_surfaces.expression import Expression

X, Y = np.array([0.5, -2.0, 1.25]), np.array([1.5, 0.25, -1.0])


def test_steps_are_evaluated_in_order():
    """A step may use those before it, numbers, pi and whole powers."""
    height = Expression.from_texts({"q": "(x/2)**2 + y**2", "w": "-q + pi", "z": "2*w - sin(q)/4"})
    q = (X / 2) ** 2 + Y**2
    assert height(X, Y).value == pytest.approx(2 * (np.pi - q) - np.sin(q) / 4, rel=1e-15)


def test_functions_take_numbers_as_well():
    """A function of a number is a constant."""
    jet = Expression.from_texts({"z": "exp(0) + bump(x, 0)"})(X, Y)
    assert jet.value == pytest.approx(1 + np.exp(-(X**2) / 2), rel=1e-15)


def test_a_constant_height_is_a_plane():
    """Numbers alone are a height too, with no derivatives."""
    jet = Expression.from_texts({"z": "2.5*pi"})(X, Y)
    assert np.array_equal(jet.value, np.full(3, 2.5 * np.pi))
    assert not jet.parts[1:].any()


@pytest.mark.parametrize(
    "text",
    [
        "x +",
        "w",
        "True",
        "'x'",
        "x.real",
        "x[0]",
        "x if y else x",
        "lambda: x",
        "__import__('os')",
        "sin(x, y)",
        "bump(x)",
        "sin(a=x)",
        "sin",
        "x**y",
        "x**0.5",
        "x**-1",
        "x // y",
        "x < y",
        "not x",
    ],
)
def test_everything_else_is_refused(text: str):
    """What is no arithmetic of known names is named in the message."""
    with pytest.raises(ParameterError, match="height step z: expected"):
        Expression.from_texts({"z": text})


@pytest.mark.parametrize("texts", [{}, {"z": "x", "w": "y"}, {"w": "x"}])
def test_the_last_step_is_z(texts: dict[str, str]):
    """Without a last step z there is no height."""
    with pytest.raises(ParameterError, match="expected steps that end with 'z'"):
        Expression.from_texts(texts)
