"""Stencils that name every vertex once say the same as those that repeat it."""

from __future__ import annotations

import numpy as np

from kirisurf.stencil import DistinctStencil


def test_derivatives_by_repeated_names_are_added_up() -> None:
    repeated = np.array([[4, 7, 4, 1], [2, 2, 2, 0], [9, 3, 5, 8]])
    gradients = np.random.default_rng(0).standard_normal((3, 4, 3))
    distinct = DistinctStencil(repeated)
    rows = distinct.gathered(gradients).reshape(3, -1, 3)
    expected, found = np.zeros((3, 10, 3)), np.zeros((3, 10, 3))
    for group in range(3):
        np.add.at(expected[group], repeated[group], gradients[group])
        np.add.at(found[group], distinct.vertices[group], rows[group])
    np.testing.assert_allclose(found, expected, atol=1e-15)
    np.testing.assert_array_equal(distinct.vertices[0][:3], [1, 4, 7])


def test_no_groups() -> None:
    distinct = DistinctStencil(np.zeros((0, 6), np.int64))
    assert distinct.gathered(np.zeros((0, 6, 3))).shape[:2] == (0, 1)
