"""Shapes of tiles: exact on regular patterns, and on patterns that are scaled."""

from __future__ import annotations

import numpy as np
import pytest

from analysis import tile_shapes
from kirisurf.pattern import quad_pattern
from tests.analysis.patterns import NAMES, in_space, regular


@pytest.mark.parametrize("name", NAMES)
def test_regular_tiles_are_alike_in_any_state_and_scale(name, rotation):
    pattern = regular(name)
    for points in (in_space(pattern.deployed), 3 * in_space(pattern.contracted) @ rotation.T):
        assert tile_shapes.area_spread(points, pattern) <= 1e-12
        assert tile_shapes.edge_spread(points, pattern) <= 1e-12
        assert tile_shapes.angle_deviation(points, pattern).max() <= 1e-7


def test_stretched_squares_spread_as_their_sides():
    pattern = quad_pattern(2, 2, 0.0)
    points = in_space(pattern.contracted) * np.array([3.0, 1.0, 1.0])
    # half of the edges are three times as long as the others: mean 2, deviation 1
    assert tile_shapes.edge_spread(points, pattern) == pytest.approx(0.5)
    assert tile_shapes.area_spread(points, pattern) == pytest.approx(0, abs=1e-12)
    assert tile_shapes.smallest_edges(points, pattern) == pytest.approx(np.full(16, 0.5))


def test_sheared_squares_deviate_by_the_shear():
    pattern = quad_pattern(2, 2)
    points = in_space(pattern.contracted)
    points[:, 0] += points[:, 1]
    smallest, largest = tile_shapes.corner_angle_range(points, pattern)
    assert smallest == pytest.approx(np.full(16, np.pi / 4))
    assert largest == pytest.approx(np.full(16, 3 * np.pi / 4))
    assert tile_shapes.angle_deviation(points, pattern) == pytest.approx(np.full(16, np.pi / 4))


def test_reflex_corners_are_reflex():
    pattern = regular("islamic-quad", 2)
    largest = tile_shapes.corner_angle_range(in_space(pattern.deployed), pattern)[1]
    octagon = pattern.tiles.sizes == 8
    assert np.degrees(largest[octagon]) == pytest.approx(np.full(octagon.sum(), 225))
    assert np.degrees(largest[~octagon]) == pytest.approx(np.full((~octagon).sum(), 90))
