"""Slit ends: every slit has two, openings are the angles that cells were built with, signs tell the tiles' normals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kirisurf.pattern import quad_pattern
from kirisurf.sizes import slit_openings, tile_edges
from kirisurf.slit_ends import SlitEnds
from tests.kirisurf.both_states import NAMES, bumpy, regular, regular_points


@pytest.mark.parametrize("name", NAMES)
def test_the_normals_that_signs_tell_are_those_of_the_tiles(name: str) -> None:
    tessellation = regular(name)
    ends = SlitEnds.of(tessellation)
    points = regular_points(tessellation)[: tessellation.n_vertices]
    for layout in (points, np.column_stack([tessellation.contracted, np.zeros(len(points))])):
        a, b, c, d, e = layout[ends.stencil.T]
        up = np.stack([np.cross(c - a, d - a)[:, 2], np.cross(e - a, b - a)[:, 2]])
        assert (ends.signs * up).min() > 0.1 * np.abs(up).max() / 10
    tiles = [set(tile.tolist()) for tile in tessellation.tiles]
    for a, b, c, d, e in ends.stencil.tolist():
        assert any({a, c, d} <= tile for tile in tiles) and any({a, b, e} <= tile for tile in tiles)


@pytest.mark.parametrize("rotation", [0.1, 0.4, np.pi / 4])
def test_openings_of_rotated_squares_are_twice_their_rotation(rotation: float) -> None:
    tessellation = quad_pattern(2, 3, rotation)
    points = np.column_stack([tessellation.deployed, np.zeros(tessellation.n_vertices)])
    moved = 3 * points @ Rotation.random(random_state=1).as_matrix().T + [5, 6, 7]
    np.testing.assert_allclose(slit_openings(tessellation, moved), 2 * rotation, atol=1e-12)
    np.testing.assert_allclose(tile_edges(tessellation, moved), 1.5, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_openings_of_flat_sheets_are_angles_from_side_to_side(name: str) -> None:
    tessellation = regular(name)
    points = bumpy(regular_points(tessellation)[: tessellation.n_vertices], noise=0.01) * [1, 1, 0]
    a, b, c = points[SlitEnds.of(tessellation).stencil[:, :3].T]
    u, v = b - a, c - a
    expected = np.arctan2(np.cross(u, v)[:, 2], (u * v).sum(axis=1))
    np.testing.assert_allclose(slit_openings(tessellation, points), expected, atol=1e-12)
