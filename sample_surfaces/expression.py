"""Height expressions: arithmetic in x and y, read from text without running code, evaluated as jets."""

from __future__ import annotations

import ast
import inspect
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from kirisurf.errors import ParameterError
from sample_surfaces.jets import FUNCTIONS, Jet, coordinates

_OPERATORS: dict[type[ast.operator], Callable] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}

_ARITY = {name: len(inspect.signature(function).parameters) for name, function in FUNCTIONS.items()}


@dataclass(frozen=True, eq=False)
class Expression:
    """A height z(x, y), given by named steps whose last one is `z`.

    Attributes
    ----------
    steps : tuple of (name, parsed expression)
        Each may use x, y, pi, numbers, + - * /, powers ** by whole numbers, the functions of
        `sample_surfaces.jets.FUNCTIONS` and the steps before it.

    Examples
    --------
    >>> import numpy as np
    >>> saddle = Expression.from_texts({"z": "0.5*x*y"})
    >>> float(saddle(np.array([2.0]), np.array([3.0])).second[1, 0])
    0.5
    """

    steps: tuple[tuple[str, ast.expr], ...]

    @classmethod
    def from_texts(cls, texts: Mapping[str, str]) -> Expression:
        """Parse the steps.

        Raises
        ------
        ParameterError
            Where a step is not an arithmetic expression of known names, or the last is not `z`.
        """
        if not texts or list(texts)[-1] != "z":
            raise ParameterError(f"height: expected steps that end with 'z', got {list(texts)}")
        known, steps = {"x", "y", "pi"}, []
        for name, text in texts.items():
            try:
                tree = ast.parse(text, mode="eval").body
            except SyntaxError as problem:
                raise ParameterError(
                    f"height step {name}: expected an expression, got {text!r} ({problem.msg})"
                ) from None
            _require_arithmetic(tree, name, known)
            steps.append((name, tree))
            known.add(name)
        return cls(tuple(steps))

    def __call__(self, x: np.ndarray, y: np.ndarray) -> Jet:
        """Return the jet of z at n places, given by x (n,) and y (n,)."""
        jet_x, jet_y = coordinates(x, y)
        names: dict[str, Jet | float] = {"x": jet_x, "y": jet_y, "pi": math.pi}
        for name, tree in self.steps:
            names[name] = _evaluated(tree, names)
        return _as_jet(names["z"], names)


def _require_arithmetic(node: ast.expr, step: str, known: set[str]) -> None:
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            return
        case ast.Name(id=name) if name in known:
            return
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            _require_arithmetic(inner, step, known)
        case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int() as exponent)) if exponent >= 0:
            _require_arithmetic(base, step, known)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            _require_arithmetic(left, step, known)
            _require_arithmetic(right, step, known)
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if len(arguments) == _ARITY.get(name):
            for argument in arguments:
                _require_arithmetic(argument, step, known)
        case _:
            raise ParameterError(
                f"height step {step}: expected numbers, {', '.join(sorted(known))}, + - * /, whole powers and "
                f"{', '.join(FUNCTIONS)}, got {ast.unparse(node)!r}"
            )


def _evaluated(node: ast.expr, names: Mapping[str, Jet | float]) -> Jet | float:
    match node:
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.Name(id=name):
            return names[name]
        case ast.UnaryOp(operand=inner):
            return -_evaluated(inner, names)
        case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int() as exponent)):
            return _evaluated(base, names) ** exponent
        case ast.BinOp(left=left, op=op, right=right):
            return _OPERATORS[type(op)](_evaluated(left, names), _evaluated(right, names))
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return FUNCTIONS[name](*(_as_jet(_evaluated(argument, names), names) for argument in arguments))
    raise TypeError(f"expected a parsed arithmetic expression, got {ast.dump(node)}")


def _as_jet(value: Jet | float, names: Mapping[str, Jet | float]) -> Jet:
    return value if isinstance(value, Jet) else value + 0.0 * names["x"]  # type: ignore[return-value]
