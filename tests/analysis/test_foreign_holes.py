"""Holes of a sheet that is known by two states alone: the same as with everything known."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.foreign_holes import foreign_holes
from analysis.measures import measure
from kirisurf.errors import UnusableError
from kirisurf.loops import Loops
from kirisurf.pattern import quad_pattern
from kirisurf.surface import Surface

PATTERN = quad_pattern(3, 3)
X, Y = 0.2 * (PATTERN.deployed - PATTERN.deployed.mean(axis=0)).T
OPENED = np.column_stack([X, Y, 0.5 * X * Y])


def hypar(n: int = 41, size: float = 1.2) -> Surface:
    x, y = (side.ravel() for side in np.meshgrid(*[np.linspace(-size, size, n)] * 2, indexing="ij"))
    number = np.arange(n * n).reshape(n, n)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    faces = np.vstack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return Surface.from_arrays(np.column_stack([x, y, 0.5 * x * y]), faces)


def by_place(found_points: np.ndarray, holes: Loops, values: np.ndarray) -> np.ndarray:
    """Values in the order of the holes' middles: the two tessellations may number them differently."""
    middles = np.array([found_points[hole].mean(axis=0) for hole in holes]).round(9)
    return values[np.lexsort(middles.T)]


@pytest.mark.parametrize("with_target", [True, False])
def test_the_fields_are_those_of_the_measures(with_target: bool) -> None:
    expected = measure(PATTERN, OPENED, PATTERN.contracted, hypar()).fields
    found = foreign_holes(OPENED, PATTERN.contracted, PATTERN.tiles, hypar() if with_target else None)
    names = {name for where, name in expected if where == "hole"}
    assert set(found.fields) == names if with_target else set(found.fields) < names
    assert with_target == ("target_gaussian_curvature" in found.fields)
    for name, values in found.fields.items():
        ours = by_place(OPENED, PATTERN.holes, expected["hole", name])
        assert by_place(found.points, found.holes, values) == pytest.approx(ours, rel=1e-7, abs=1e-9, nan_ok=True)


def test_vertices_that_no_tile_uses_change_nothing() -> None:
    found = foreign_holes(OPENED, PATTERN.contracted, PATTERN.tiles)
    stray = foreign_holes(
        np.vstack([OPENED, [[9.0, 9, 9]]]), np.vstack([PATTERN.contracted, [[9.0, 9]]]), PATTERN.tiles
    )
    assert np.array_equal(found.points, stray.points) and np.array_equal(found.holes.indices, stray.holes.indices)


def test_tiles_that_are_no_sheet_are_refused() -> None:
    doubled = Loops.from_lists([*PATTERN.tiles, PATTERN.tiles[0]])
    with pytest.raises(UnusableError, match="holes: expected the tiles of one sheet, got others"):
        foreign_holes(OPENED, PATTERN.contracted, doubled)
