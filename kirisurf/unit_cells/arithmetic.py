"""Numbers as people write them: 0.75, sqrt(3)/2, -2*cos(pi/5)."""

from __future__ import annotations

import math
import re

LONGEST = 80
_TOKEN = re.compile(r"\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?|[a-z]+|[-+*/()]", re.ASCII)
_FUNCTIONS = {"sqrt": math.sqrt, "sin": math.sin, "cos": math.cos, "tan": math.tan}


def parse_number(text: str) -> float:
    """Return the value of an arithmetic expression of numbers, pi, + - * / ( ), sqrt, sin, cos and tan (radians).

    Raises
    ------
    ValueError
        Where the text is no such expression or has no finite value; the message is short, for use inside another.

    Examples
    --------
    >>> parse_number("-2*(1+sqrt(4))/3")
    -2.0
    """
    if len(text) > LONGEST:
        raise ValueError(f"{len(text)} characters")
    tokens = _TOKEN.findall(text)
    if "".join(tokens) != text.replace(" ", "") or not tokens:
        raise ValueError(repr(text))
    tokens.reverse()
    try:
        value = _sum(tokens)
    except (ValueError, IndexError, ArithmeticError, RecursionError):
        raise ValueError(repr(text)) from None
    if tokens or not math.isfinite(value):
        raise ValueError(repr(text))
    return value


def _sum(tokens: list[str]) -> float:
    value = _product(tokens)
    while tokens and tokens[-1] in "+-":
        value = value + _product(tokens) if tokens.pop() == "+" else value - _product(tokens)
    return value


def _product(tokens: list[str]) -> float:
    value = _factor(tokens)
    while tokens and tokens[-1] in "*/":
        value = value * _factor(tokens) if tokens.pop() == "*" else value / _factor(tokens)
    return value


def _factor(tokens: list[str]) -> float:
    token = tokens.pop()
    if token in "+-":
        return _factor(tokens) if token == "+" else -_factor(tokens)
    if token == "pi":
        return math.pi
    if token in _FUNCTIONS:
        if tokens[-1] != "(":
            raise ValueError(token)
        return _FUNCTIONS[token](_factor(tokens))
    if token == "(":
        value = _sum(tokens)
        if tokens.pop() != ")":
            raise ValueError(token)
        return value
    return float(token)
