"""Meshing: laws of the three mesh makers that no sample states by itself."""

from __future__ import annotations

import numpy as np
import pytest

from sample_surfaces.meshing import cap_mesh, grid_mesh, outline_mesh
from sample_surfaces.outlines import CurvedPolygon, outline_points


def test_a_grid_is_its_own_mirror_image():
    """Alternating diagonals: the faces of an even grid, mirrored in either axis, are the same faces."""
    places, faces = grid_mesh(np.array([-1.0, -1]), np.array([1.0, 1]), 8)
    triangles = {frozenset(map(tuple, places[face])) for face in faces}
    for mirror in ([-1, 1], [1, -1]):
        assert {frozenset(map(tuple, places[face] * mirror + 0.0)) for face in faces} == triangles


def test_a_grid_covers_its_rectangle():
    """Cells follow the longer side; the faces' areas sum to the rectangle's."""
    places, faces = grid_mesh(np.array([0.0, 0]), np.array([4.0, 1]), 8)
    assert len(places) == 9 * 3
    a, b, c = (places[faces[:, k]] for k in range(3))
    areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert areas == pytest.approx(np.full(32, 0.125))


def test_an_outline_that_curves_inward_is_filled_and_no_more():
    """The faces' areas sum to that of the polygon through the outline's points, which come first."""
    outline = CurvedPolygon(np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]]), np.array([-0.2, 0.2, -0.2, 0.0]))
    rim = outline_points(outline, 0.1)
    places, faces = outline_mesh(outline, 0.1)
    assert np.array_equal(places[: len(rim)], rim)
    a, b, c = (places[faces[:, k]] for k in range(3))
    areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    ahead = np.roll(rim, -1, axis=0)
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(0.5 * (rim[:, 0] * ahead[:, 1] - rim[:, 1] * ahead[:, 0]).sum(), rel=1e-12)


@pytest.mark.parametrize("rings", [1, 2, 7])
def test_a_cap_has_its_counts(rings: int):
    """1 + 3 n (n + 1) vertices and 6 n^2 faces, the outermost 6 n vertices on the rim."""
    points, faces = cap_mesh(rings, 1.0)
    assert (len(points), len(faces)) == (1 + 3 * rings * (rings + 1), 6 * rings**2)
    assert points[-6 * rings :, 2] == pytest.approx(np.full(6 * rings, -np.cos(1.0)), rel=1e-15)
