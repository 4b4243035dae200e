"""The curvature of holes as a term: laws of blocks, exact second differences, and what is left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kirisurf.loops import Loops
from kirisurf.objective.hole_bending import HoleBending
from kirisurf.pattern import quad_pattern, tile_pattern
from kirisurf.projection import Projection
from kirisurf.surroundings import surrounding_vertices
from kirisurf.unit_cells.catalog import catalog, find_cell
from tests.kirisurf.block_laws import bumpy_sheet, check_block


def plane(points: np.ndarray) -> Projection:
    """The target z = 0."""
    n = len(points)
    return Projection(
        points=points * [1.0, 1.0, 0.0],
        distances=np.abs(points[:, 2]),
        normals=np.tile([0.0, 0.0, 1.0], (n, 1)),
        shape_operators=np.zeros((n, 3, 3)),
        faces=np.zeros(n, np.int64),
        on_rim=np.zeros(n, bool),
        rim_points=np.zeros((n, 3)),
        rim_conormals=np.zeros((n, 3)),
    )


def bowl(points: np.ndarray) -> Projection:
    """The sphere of radius 5 round (0, 0, 5), seen from inside."""
    center = np.array([0.0, 0.0, 5.0])
    inward = center - points
    inward /= np.linalg.norm(inward, axis=1, keepdims=True)
    tangent = np.eye(3) - inward[:, :, None] * inward[:, None, :]
    return replace(plane(points), points=center - 5 * inward, normals=inward, shape_operators=tangent / 5)


def twelve(tessellation) -> np.ndarray:
    return surrounding_vertices(tessellation).by_size()[12][1]


@pytest.mark.parametrize("target", [plane, bowl])
@pytest.mark.parametrize("seed", range(2))
def test_block_obeys_the_laws(seed, target) -> None:
    tessellation, points = bumpy_sheet(seed)
    start = points + 0.1 * np.random.default_rng(seed + 7).standard_normal(points.shape)
    check_block(HoleBending(twelve(tessellation), target(start)), points, invariant=False)


def test_quadratic_heights_bend_by_their_second_derivatives() -> None:
    tessellation, points = bumpy_sheet()
    x, y = points[:, :2].T
    lifted = np.column_stack([x, y, 1 + 2 * x - y + 0.3 * x * x - 0.5 * x * y + 0.2 * y * y])
    rows = HoleBending(twelve(tessellation), plane(points)).residual(lifted)
    # the frame in the plane is the block's own: compare what does not depend on it
    xx, xy, yy = rows.T / np.array([[1], [np.sqrt(2)], [1]])
    np.testing.assert_allclose(xx + yy, 2 * (0.3 + 0.2), atol=1e-12)
    np.testing.assert_allclose(xx * yy - xy**2, 0.6 * 0.4 - 0.25, atol=1e-12)
    np.testing.assert_allclose((rows**2).sum(axis=1), 0.6**2 + 2 * 0.5**2 + 0.4**2, atol=1e-12)


def test_sheet_on_its_target_does_not_bend_beyond_it() -> None:
    tessellation, points = bumpy_sheet()
    on = bowl(points).points
    np.testing.assert_allclose(HoleBending(twelve(tessellation), bowl(on)).residual(on), 0.0, atol=1e-12)


def test_sheet_of_another_radius_differs_by_the_curvature() -> None:
    """Vertices on the sphere of radius 5 about a target of radius infinite bend by 1/5, to second order."""
    differences = []
    for scale in (0.5, 0.25):
        tessellation = quad_pattern(2, 2)
        flat = scale * (tessellation.deployed - tessellation.deployed.mean(axis=0))
        points = np.column_stack([flat, 5 - np.sqrt(25 - (flat**2).sum(axis=1))])
        middle = np.argmin([np.abs(flat[hole].mean(axis=0)).sum() for hole in tessellation.holes])
        rows = HoleBending(twelve(tessellation), plane(points)).residual(points)[middle]
        differences.append(abs((rows[0] + rows[2]) / 2 - 1 / 5))
    assert differences[1] < 1e-3
    assert np.log2(differences[0] / differences[1]) > 1.8


def test_turned_sheets_bend_alike() -> None:
    tessellation, points = bumpy_sheet()
    turn = Rotation.random(random_state=3).as_matrix()
    here = plane(points)
    there = replace(here, points=here.points @ turn.T, normals=here.normals @ turn.T)
    one = HoleBending(twelve(tessellation), here).residual(points)
    two = HoleBending(twelve(tessellation), there).residual(points @ turn.T)
    np.testing.assert_allclose((one**2).sum(axis=1), (two**2).sum(axis=1), rtol=1e-9)


def test_vertices_that_do_not_determine_a_quadratic_have_rows_that_vanish() -> None:
    angle = np.arange(12) / 12 * 2 * np.pi
    circle = np.column_stack([np.cos(angle), np.sin(angle), 0.1 * np.sin(3 * angle)])
    assert not HoleBending(np.arange(12)[None], plane(circle)).residual(circle).any()
    five = circle[:5] + np.array([0.0, 0.0, 1.0])
    assert not HoleBending(np.arange(5)[None], plane(five)).residual(five).any()


@pytest.mark.parametrize("name", [entry.name for entry in catalog()])
def test_surroundings_are_the_vertices_of_the_tiles_round_the_hole(name) -> None:
    pattern = tile_pattern(find_cell(name), np.ones((2, 2), bool))
    around = surrounding_vertices(pattern)
    assert isinstance(around, Loops) and len(around) == len(pattern.holes)
    for hole, vertices in enumerate(around):
        expected = np.unique(np.concatenate([pattern.tiles[k] for k in pattern.hole_tiles[hole].tolist()]))
        np.testing.assert_array_equal(vertices, expected)
        assert set(pattern.holes[hole].tolist()) <= set(vertices.tolist())
