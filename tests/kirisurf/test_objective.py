"""Objective terms obey the laws of blocks; fairness and rim mean what they say."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.objective.fairness import EqualNeighbors, neighbor_tiles
from kirisurf.objective.proximity import Proximity
from kirisurf.objective.rim import RimDistance
from kirisurf.pattern import quad_pattern
from kirisurf.projection import Projection
from tests.kirisurf.block_laws import bumpy_sheet, check_block


@pytest.mark.parametrize("seed", range(3))
def test_fairness_obeys_the_laws(seed: int) -> None:
    tessellation, points = bumpy_sheet(seed)
    check_block(EqualNeighbors(tessellation, 4), points)


def test_proximity_obeys_the_laws() -> None:
    _, points = bumpy_sheet()
    check_block(Proximity(points + 0.3), points, invariant=False)


def test_fairness_of_a_regular_pattern_vanishes() -> None:
    tessellation = quad_pattern(3, 3, 0.4)
    points = np.column_stack([tessellation.deployed, np.zeros(tessellation.n_vertices)])
    np.testing.assert_allclose(EqualNeighbors(tessellation, 4).residual(points), 0.0, atol=1e-14)


def test_neighbors_are_equal_tiles_of_adjacent_cells() -> None:
    tessellation = quad_pattern(3, 2)
    pairs = neighbor_tiles(tessellation)
    # 4 tiles a cell; 2 x 2 horizontal and 3 x 1 vertical neighbors of cells
    assert len(pairs) == 4 * (2 * 2 + 3 * 1)
    away = np.abs(tessellation.cells[pairs[:, 0]] - tessellation.cells[pairs[:, 1]])
    assert (away.sum(axis=1) == 1).all() and (away[:, 2] == 0).all()


def rim_of_a_half_plane(points: np.ndarray) -> Projection:
    """The target z = 0, x <= 0, seen from points."""
    n = len(points)
    on_rim = points[:, 0] >= 0
    rim = points * [0.0, 1.0, 0.0]
    return Projection(
        points=np.where(on_rim[:, None], rim, points * [1.0, 1.0, 0.0]),
        distances=np.zeros(n),
        normals=np.tile([0.0, 0.0, 1.0], (n, 1)),
        shape_operators=np.zeros((n, 3, 3)),
        faces=np.zeros(n, np.int64),
        on_rim=on_rim,
        rim_points=rim,
        rim_conormals=np.tile([1.0, 0.0, 0.0], (n, 1)),
    )


def test_rim_pulls_back_pulls_out_and_leaves_alone() -> None:
    points = np.array([[0.2, 0.0, 0.0], [-0.5, 1.0, 0.0], [-0.5, 2.0, 0.0], [0.4, 3.0, 0.0], [-9.0, 4.0, 0.0]])
    outline = np.array([True, True, False, False, False])
    rows = RimDistance(outline, rim_of_a_half_plane(points), points, reach=0.04).residual(points)[:, 0]
    np.testing.assert_allclose(rows, [0.2, -0.5 * 0.2, 0.0, 0.4, 0.0])


def test_rim_has_a_row_for_vertices_that_cross_it_later() -> None:
    points = np.array([[-0.1, 0.0, 0.0]])
    block = RimDistance(np.array([False]), rim_of_a_half_plane(points), points, reach=0.04)
    assert block.residual(points)[0, 0] == 0
    across = points + np.array([0.3, 0.0, 0.0])
    assert block.residual(across)[0, 0] == pytest.approx(0.2)
    check_block(block, across, invariant=False)
