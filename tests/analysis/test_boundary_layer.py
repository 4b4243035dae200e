"""What a planar sheet leaves of its target: closed forms, the published law, failing inputs."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from analysis.boundary_layer import measure_boundary_layer
from analysis.rim import deployed_rim
from kirisurf.errors import UnusableError
from kirisurf.pattern import quad_pattern
from tests.analysis.patterns import in_space, regular


def _box(points: np.ndarray) -> np.ndarray:
    (a, b), (c, d) = points.min(axis=0), points.max(axis=0)
    return np.array([[a, b], [c, b], [c, d], [a, d]])


@pytest.mark.parametrize("cells", [1, 2, 5])
def test_open_squares_in_their_square_have_closed_forms(cells):
    pattern = quad_pattern(cells, cells)
    n, side = 2 * cells, 0.5
    layer = measure_boundary_layer(pattern.deployed, pattern, _box(pattern.deployed))
    # n^2 tiles of area 1 and (n - 1)^2 holes of area 1 in a square of area 2 n^2
    assert layer.area == pytest.approx((2 * n - 1) / (2 * n**2))
    assert layer.outline_area == pytest.approx(1 / (2 * n))
    # every other slit that ends at the rim opens there; its mouth is a diagonal wide
    sides, mouths = 4 * n, 2 * (n - 1)
    total = sides * side + mouths * np.sqrt(2) * side
    assert len(layer.bases) == sides + mouths
    assert layer.bases.mean() == pytest.approx(total / (sides + mouths))
    assert layer.heights.max() == pytest.approx(side / np.sqrt(2))


@pytest.mark.parametrize("name", ["quad", "kagome", "hexagon", "islamic-quad"])
def test_layer_falls_with_the_root_of_the_number_of_tiles(name):
    areas, tiles = [], []
    for n in (5, 10, 20):
        pattern = regular(name, n)
        areas.append(measure_boundary_layer(pattern.deployed, pattern, _box(pattern.deployed)).area)
        tiles.append(pattern.n_tiles)
    order = np.diff(np.log(areas)) / np.diff(np.log(tiles))
    assert order == pytest.approx(np.full(2, -0.5), abs=0.07)


def test_sheet_whose_rim_is_the_outline_leaves_nothing_beside_its_notches():
    pattern = regular("kagome", 5, True)
    layer = measure_boundary_layer(pattern.deployed, pattern, pattern.deployed[pattern.outline])
    assert layer.outline_area <= 1e-12
    # sides lie on the outline, notches reach into the sheet, farthest at a vertex
    curve = shapely.LinearRing(pattern.deployed[pattern.outline])
    deepest = max(shapely.Point(pattern.deployed[k]).distance(curve) for k in deployed_rim(pattern).indices)
    assert layer.heights.min() <= 1e-12
    assert layer.heights.max() == pytest.approx(deepest)


def test_areas_agree_with_samples():
    pattern = quad_pattern(3, 3, 0.5)
    middle = pattern.deployed.mean(axis=0)
    circle = shapely.Point(middle).buffer(1.6)
    layer = measure_boundary_layer(pattern.deployed, pattern, np.array(circle.exterior.coords)[:-1])
    points = middle + np.random.default_rng(0).uniform(-1.6, 1.6, size=(40000, 2))
    points = points[shapely.contains_xy(circle, *points.T)]
    covered = np.zeros(len(points), bool)
    for loop in [*pattern.tiles, *pattern.holes]:
        covered |= shapely.contains_xy(shapely.Polygon(pattern.deployed[loop]), *points.T)
    assert layer.area == pytest.approx(1 - covered.mean(), abs=0.01)


def test_layer_does_not_depend_on_scale_or_place():
    pattern = quad_pattern(2, 3, 0.5)
    outline = 1.1 * _box(pattern.deployed)
    one = measure_boundary_layer(pattern.deployed, pattern, outline)
    two = measure_boundary_layer(in_space(pattern.deployed) * 8, pattern, (outline - pattern.deployed.mean(axis=0)) * 8)
    assert two.area == pytest.approx(one.area)
    assert two.outline_area == pytest.approx(one.outline_area)
    assert two.heights == pytest.approx(8 * one.heights)
    assert two.bases == pytest.approx(8 * one.bases)


@pytest.mark.parametrize(
    ("outline", "message"),
    [
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "expected a simple polygon, got Self-intersection"),
        ([[0, 0], [1, 1]], "expected a simple polygon, got 2 corners"),
        ([[0, 0], [1, 0], [2, 0]], "expected a simple polygon"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0]], "target outline: expected shape"),
        ([[0, 0], [1, 0], [np.nan, 1]], "target outline: expected finite"),
    ],
)
def test_outlines_that_are_none_are_refused(outline, message):
    pattern = quad_pattern(1, 1)
    with pytest.raises(UnusableError, match=message):
        measure_boundary_layer(pattern.deployed, pattern, outline)


def test_sheet_in_space_is_refused():
    pattern = quad_pattern(1, 1)
    bent = np.c_[pattern.deployed, 0.1 * pattern.deployed[:, 0]]
    with pytest.raises(UnusableError, match="expected a sheet in the plane z = 0"):
        measure_boundary_layer(bent, pattern, [[0, 0], [1, 0], [1, 1]])
