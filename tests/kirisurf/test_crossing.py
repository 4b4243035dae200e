"""Crossing tiles are found where they cross, and where the certificate finds them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analysis.intersections import crossing_pairs
from kirisurf.crossing import _pierces, tiles_cross
from kirisurf.derive import derive_tessellation
from kirisurf.loops import Loops
from kirisurf.pattern import quad_pattern


def test_a_segment_pierces_a_triangle_where_barycentric_coordinates_say_so() -> None:
    rng = np.random.default_rng(2)
    begin, end = rng.standard_normal((2, 4000, 3))
    triangle = rng.standard_normal((4000, 3, 3))
    matrix = np.stack([begin - end, triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]], axis=2)
    t, a, b = np.linalg.solve(matrix, (begin - triangle[:, 0])[:, :, None])[:, :, 0].T
    expected = (t > 0) & (t < 1) & (a > 0) & (b > 0) & (a + b < 1)
    assert 100 < expected.sum() < 1000
    assert (_pierces(begin, end, triangle) == expected).mean() > 0.999


@pytest.mark.parametrize("rotation", [0.0, 0.3, np.pi / 4])
def test_the_regular_pattern_does_not_cross(rotation: float) -> None:
    tessellation = quad_pattern(4, 4, rotation)
    assert not tiles_cross(tessellation, np.column_stack([tessellation.deployed, np.zeros(tessellation.n_vertices)]))


def test_it_agrees_with_the_certificate_on_loose_squares() -> None:
    """Three squares at random places: about half of such triples cross."""
    flat = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    apart = np.concatenate([flat[:, :2] + [3.0 * k, 0.0] for k in range(3)])
    loose = derive_tessellation(apart, apart, Loops.from_lists(np.arange(12).reshape(3, 4)), np.arange(12))
    rng = np.random.default_rng(7)
    found = []
    for _ in range(200):
        turns = Rotation.random(3, random_state=rng).as_matrix()
        points = np.concatenate([flat @ turn.T + 1.2 * rng.random(3) for turn in turns])
        found.append((tiles_cross(loose, points), len(crossing_pairs(points, loose.tiles, 1.0)) > 0))
    assert all(ours == certified for ours, certified in found)
    assert 40 < sum(ours for ours, _ in found) < 160
