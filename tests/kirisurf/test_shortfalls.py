"""What a finished sheet falls short of is said: vertices outside an outline, openings and corners beyond a bound."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.outlines import Outline, straight
from kirisurf.pattern import quad_pattern
from kirisurf.prescribed import Prescribed
from kirisurf.shortfalls import shortfalls
from kirisurf.spec import FitSpec

ROTATION = 0.4


def square(half: float, middle: np.ndarray) -> Outline:
    corner = middle + half * np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    return Outline("square", tuple(straight(np.stack([corner[k], corner[(k + 1) % 4]])) for k in range(4)))


@pytest.mark.parametrize(("grown", "outside"), [(0.0, False), (-0.1, True)])
def test_vertices_outside_an_outline_are_counted(grown: float, outside: bool) -> None:
    pattern = quad_pattern(2, 2, ROTATION)
    points = np.column_stack([pattern.deployed, np.zeros(pattern.n_vertices)])
    low, high = pattern.deployed.min(axis=0), pattern.deployed.max(axis=0)
    outline = square(float(0.5 * (high - low).max()) + grown, 0.5 * (low + high))
    boundary = Prescribed(pattern.outline[:0], pattern.outline[:0], outline)
    said = shortfalls(FitSpec("x.svg"), pattern, points, pattern.contracted, 0.5, boundary, None)
    assert len(said) == outside
    # 0.1 beyond every side, over an edge of 1/2
    assert not outside or "by up to 0.2 tile edges" in said[0]


@pytest.mark.parametrize(("options", "count"), [
    ({"max_opening": np.degrees(2 * ROTATION) + 0.1}, 0),
    ({"max_opening": np.degrees(2 * ROTATION) - 0.1}, 1),
    ({"min_corner": 60.0}, 0),
])  # fmt: skip
def test_bounds_are_measured_on_the_finished_sheet(options: dict, count: int) -> None:
    pattern = quad_pattern(2, 2, ROTATION)
    points = np.column_stack([pattern.deployed, np.zeros(pattern.n_vertices)])
    assert len(shortfalls(FitSpec("x.svg", **options), pattern, points, pattern.contracted, 0.5, None, None)) == count
    sheared = pattern.contracted @ np.array([[1.0, 0.0], [0.9, 1.0]])
    narrow = shortfalls(FitSpec("x.svg", min_corner=60.0), pattern, points, sheared, 0.5, None, None)
    assert len(narrow) == 1 and "--min-corner" in narrow[0]
