"""Outlines with a name: the planar targets of the paper, and round, curved and lettered ones to begin with.

The published ones are those of G. P. T. Choi, L. H. Dudte and L. Mahadevan, "Programming shape using kirigami
tessellations" (Nature Materials 18, 2019), from the repository garyptchoi/inverse-kirigami-design (Apache-2.0):
each side is the cubic spline, not-a-knot and evenly parameterized, through a few points.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from kirisurf.errors import ParameterError
from kirisurf.outlines.curve import Curve, joined
from kirisurf.outlines.outline import Outline
from kirisurf.outlines.shapes import arc, spline, straight

_DIAGONAL = math.sqrt(0.5)


def names() -> tuple[str, ...]:
    """Return the names of the outlines, the published ones first.

    Examples
    --------
    >>> names()[:3]
    ('circle', 'egg', 'rainbow')
    """
    return tuple(_OUTLINES)


def title(name: str) -> str:
    """Return what an outline is, in one line.

    Raises
    ------
    ParameterError
        Where there is no such outline.

    Examples
    --------
    >>> title("disc")
    'A disc of radius 1: a true circle without corners'
    """
    return _entry(name)[0]


def is_published(name: str) -> bool:
    """Whether an outline is one of the paper's.

    Raises
    ------
    ParameterError
        Where there is no such outline.
    """
    return names().index(_known(name)) < _N_PUBLISHED


def outline(name: str) -> Outline:
    """Return a named outline, about 2 wide, without a unit.

    Raises
    ------
    ParameterError
        Where there is no such outline.

    Examples
    --------
    >>> outline("rect").area
    6.0
    """
    sides, is_smooth = _entry(name)[1]()
    return Outline.from_sides(sides, name, is_smooth=is_smooth)


_Sides = tuple[list[Curve], bool]


def _known(name: str) -> str:
    if name not in _OUTLINES:
        near = difflib.get_close_matches(name, _OUTLINES, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"outlines: {', '.join(_OUTLINES)}"
        raise ParameterError(f"outline: expected the name of an outline, got {name!r} ({hint})")
    return name


def _entry(name: str) -> tuple[str, Callable[[], _Sides]]:
    return _OUTLINES[_known(name)]


def _splines(*sides: ArrayLike) -> Callable[[], _Sides]:
    """Bottom, right, top and left, each given by the points of its spline."""
    return lambda: ([spline(points) for points in sides], False)


def _mirrored(bottom: ArrayLike, right: ArrayLike, top: ArrayLike) -> Callable[[], _Sides]:
    """Sides of an outline that is its own mirror image in the y axis."""
    return _splines(bottom, right, top, (np.array(right) * (-1, 1))[::-1])


def _quarters(bottom: ArrayLike) -> Callable[[], _Sides]:
    """Sides that follow from the first by quarter turns."""
    quarter = np.array([[0, 1], [-1, 0]])
    return _splines(*(np.array(bottom) @ np.linalg.matrix_power(quarter, k) for k in range(4)))


def _egg() -> _Sides:
    mirror = np.array([-1, 1])
    low, high = np.array([1.065, -1.5]) * _DIAGONAL, np.array([1.125, 1.125]) * _DIAGONAL
    bottom = np.array([low * mirror, [0, -1.425], low])
    right = np.array([low, [1.065, -0.213], high])
    top = np.array([high, [0, 1.425], high * mirror])
    return _mirrored(bottom, right, top)()


def _wavy() -> _Sides:
    k = np.arange(11)
    return _quarters(np.stack([0.2 * k - 1, -1 - 0.1 * np.array([0, 1, 0, -1])[k % 4]], axis=1))()


def _ellipse(a: float, b: float) -> Callable[[], _Sides]:
    return lambda: ([arc([0, 0], np.diag([a, b]), 0.0, 2 * math.pi)], True)


def _heart() -> _Sides:
    # A square on its corner with half circles on its upper sides, which go on from its lower ones.
    turn, radius = math.pi / 4, _DIAGONAL
    right = joined([straight([(0, -1), (1, 0)]), arc([0.5, 0.5], radius, -turn, math.pi)])
    left = joined([arc([-0.5, 0.5], radius, turn, math.pi), straight([(-1, 0), (0, -1)])])
    return [right, left], False


def _letter_s() -> _Sides:
    # A band of width 0.4 along two arcs of 240 degrees that meet at the origin; its ends are straight.
    radius, half, sweep = 0.5, 0.2, math.radians(240)
    upper, lower, first = [0.0, radius], [0.0, -radius], math.radians(30)
    quarter = math.pi / 2

    def along(outer: float, inner: float) -> Curve:
        return joined([arc(upper, outer, first, sweep), arc(lower, inner, quarter, -sweep)])

    outside, inside = along(radius + half, radius - half), along(radius - half, radius + half).turned()
    return [outside, straight([outside.end, inside.start]), inside, straight([inside.end, outside.start])], False


_N_PUBLISHED = 9
_OUTLINES: dict[str, tuple[str, Callable[[], _Sides]]] = {
    "circle": (
        "The paper's circle: four parabolas, 3 % inside the true circle at most",
        _quarters([(-_DIAGONAL, -_DIAGONAL), (0, -1), (_DIAGONAL, -_DIAGONAL)]),
    ),
    "egg": ("The paper's egg: four parabolas", _egg),
    "rainbow": (
        "The paper's rainbow: two slanted sides between two arches",
        _mirrored([(-1, -1), (0, -0.8), (1, -1)], [(1, -1), (1.75, 1)], [(1.75, 1), (0, 1.5), (-1.75, 1)]),
    ),
    "anvil": (
        "The paper's anvil: a trapezium that is wider above",
        _mirrored([(-1, -1), (1, -1)], [(1, -1), (1.75, 1)], [(1.75, 1), (-1.75, 1)]),
    ),
    "shear": (
        "The paper's sheared square: a parallelogram",
        _splines([(-1.5, -1), (0.5, -1)], [(0.5, -1), (1.5, 1)], [(1.5, 1), (-0.5, 1)], [(-0.5, 1), (-1.5, -1)]),
    ),
    "wedge": (
        "The paper's wedge: two sides bulge, two are hollow",
        _mirrored([(-1, -1), (0, -1.25), (1, -1)], [(1, -1), (0.75, 0), (1, 1)], [(1, 1), (0, 1.25), (-1, 1)]),
    ),
    "star": ("The paper's star: four arms that turn", _quarters([(-0.75, -2), (0, -1), (1, -1), (2, -0.75)])),
    "wavy": ("The paper's wavy square: sides of two waves and a half", _wavy),
    "rect": (
        "The paper's rectangle, 2 wide and 3 high",
        _mirrored([(-1, -1.5), (1, -1.5)], [(1, -1.5), (1, 1.5)], [(1, 1.5), (-1, 1.5)]),
    ),
    "disc": ("A disc of radius 1: a true circle without corners", _ellipse(1.0, 1.0)),
    "ellipse": ("An ellipse, 2 wide and 1.2 high, without corners", _ellipse(1.0, 0.6)),
    "heart": ("A heart: straight lines and half circles, with a corner below and a hollow one above", _heart),
    "letter-s": ("The letter S: a band along two arcs, 1.4 wide and 2.4 high", _letter_s),
}
