"""Every constraint block obeys the laws of blocks, and says what it should on known shapes."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.constraints.angle import FullTurns
from kirisurf.constraints.convexity import ConvexTiles
from kirisurf.constraints.edge import LongEdges
from kirisurf.constraints.facing import FacingTiles
from kirisurf.constraints.length import EqualLengths
from kirisurf.constraints.opening import OpenHinges
from kirisurf.constraints.planarity import FlatTiles
from kirisurf.constraints.surface import OnSurface
from kirisurf.corner_angle import CornerAngles
from kirisurf.pattern import quad_pattern
from kirisurf.projection import Projection
from kirisurf.soundness import are_convex
from kirisurf.triangulation import TriangulatedTiles
from tests.kirisurf.block_laws import bumpy_sheet, check_block


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["length", "angle", "planarity", "opening", "edge", "convexity", "facing"])
def test_laws(kind: str, seed: int) -> None:
    tessellation, points = bumpy_sheet(seed)
    block = {
        "length": lambda: EqualLengths(tessellation),
        "angle": lambda: FullTurns(tessellation, 4),
        "planarity": lambda: FlatTiles(TriangulatedTiles.of(tessellation).diagonals),
        "opening": lambda: OpenHinges(tessellation, 0.05, points),
        "edge": lambda: LongEdges(tessellation, 0.1),
        "convexity": lambda: ConvexTiles(tessellation, 4, points),
        "facing": lambda: FacingTiles(tessellation, points),
    }[kind]()
    check_block(block, points)


def test_overhanging_tiles_have_the_right_derivatives() -> None:
    """Where the projection of a tile on the xy plane is clockwise, the published gradient has the wrong sign."""
    tessellation, points = bumpy_sheet(4)
    over = points * [1.0, -1.0, -1.0]
    check_block(FullTurns(tessellation, 4), over)
    check_block(OpenHinges(tessellation, 0.05, over), over)


def test_surface_block_obeys_the_laws_with_its_model_frozen() -> None:
    tessellation, points = bumpy_sheet()
    rng = np.random.default_rng(3)
    n = tessellation.n_vertices
    normals = rng.standard_normal((n, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    shape = rng.standard_normal((n, 3, 3))
    shape = shape + np.swapaxes(shape, 1, 2)
    tangent = np.eye(3) - normals[:, :, None] * normals[:, None, :]
    projection = Projection(
        points=points + 0.1,
        distances=np.full(n, 0.1),
        normals=normals,
        shape_operators=tangent @ shape @ tangent,
        faces=np.zeros(n, np.int64),
        on_rim=np.zeros(n, bool),
        rim_points=points,
        rim_conormals=normals,
    )
    check_block(OnSurface(np.arange(n), projection), points, invariant=False)


@pytest.mark.parametrize("rotation", [0.15, 0.5, np.pi / 4])
def test_the_regular_pattern_meets_every_rigid_row(rotation: float) -> None:
    tessellation = quad_pattern(3, 2, rotation)
    points = np.column_stack([2 * tessellation.deployed, np.zeros(tessellation.n_vertices)])
    for block in (
        EqualLengths(tessellation),
        FullTurns(tessellation, 4),
        FlatTiles(TriangulatedTiles.of(tessellation).diagonals),
    ):
        np.testing.assert_allclose(block.residual(points), 0.0, atol=1e-13)
    # unit squares with opening 2 rotation: the row is the product of the sines of opening and tile angle
    rows = OpenHinges(tessellation, 0.0, points).residual(points)
    np.testing.assert_allclose(rows, np.sin(2 * rotation), atol=1e-12)


@pytest.mark.parametrize("corner", range(4))
def test_a_tile_that_turns_inside_out_is_negative(corner: int) -> None:
    """A corner beyond the diagonal: the unsigned angles and the planarity need not notice, these rows do."""
    tessellation = quad_pattern(2, 2, 0.4)
    points = np.column_stack([2 * tessellation.deployed, np.zeros(tessellation.n_vertices)])
    block = ConvexTiles(tessellation, 4, points, margin=0.0)
    np.testing.assert_allclose(block.residual(points), 1.0, atol=1e-12)
    assert are_convex(tessellation, points)
    tile = tessellation.tiles[5]
    moved = points.copy()
    moved[tile[corner]] = points[tile[corner]] + 1.3 * (points[tile].mean(axis=0) - points[tile[corner]])
    assert block.residual(moved)[5].min() < 0
    assert not are_convex(tessellation, moved)


def test_an_overlapping_hinge_is_negative() -> None:
    tessellation = quad_pattern(2, 2, 0.2)
    points = np.column_stack([2 * tessellation.deployed, np.zeros(tessellation.n_vertices)])
    block = OpenHinges(tessellation, 0.0, points)
    assert block.residual(points).min() > 0
    end = tessellation.hinges[tessellation.slit_ends][0]
    crossed = points.copy()
    crossed[end[0]], crossed[end[2]] = points[end[2]], points[end[0]]
    assert block.residual(crossed)[0, 0] < 0


def test_corner_angles_of_known_triangles() -> None:
    corners = np.array([[[0, 1, 0], [0, 0, 0], [1, 0, 0]], [[1, 1, 0], [0, 0, 0], [1, 0, 0]]], float)
    angles = CornerAngles(np.moveaxis(corners, 0, -1)).angles
    np.testing.assert_allclose(angles, [np.pi / 2, np.pi / 4], atol=1e-15)


def test_an_array_changed_in_place_is_another_point() -> None:
    tessellation, points = bumpy_sheet()
    for block in (
        FullTurns(tessellation, 4),
        FlatTiles(TriangulatedTiles.of(tessellation).diagonals),
        OpenHinges(tessellation, 0.05, points),
    ):
        place = points.copy()
        before = block.residual(place)
        place[:, 2] *= 1.5
        after = block.residual(place)
        assert np.abs(after - before).max() > 1e-3
        np.testing.assert_array_equal(after, block.residual(place.copy()))
        place[:, 2] /= 1.5
        np.testing.assert_allclose(block.residual(place), before, atol=1e-14)


def test_the_second_opening_row_is_the_first_with_the_tiles_exchanged() -> None:
    tessellation, points = bumpy_sheet(2)
    block = OpenHinges(tessellation, 0.05, points)
    a, b, c, _, e = points[block.stencil.T]
    u, v, w = c - a, b - a, e - a
    lengths = np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1) ** 2 * np.linalg.norm(w, axis=1)
    expected = np.einsum("ki,ki->k", np.cross(u, v), np.cross(v, w)) / lengths - 0.05
    np.testing.assert_allclose(block.residual(points)[:, 1], expected, atol=1e-14)


def test_stencils_of_rings_and_slit_edges_name_a_vertex_once() -> None:
    tessellation, _ = bumpy_sheet()
    for block in (FullTurns(tessellation, 4), EqualLengths(tessellation)):
        ordered = np.sort(block.stencil, axis=1)
        assert (np.diff(ordered, axis=1) > 0).all()


def test_planarity_is_the_volume() -> None:
    tessellation = quad_pattern(1, 1, 0.5)
    points = np.column_stack([2 * tessellation.deployed, np.zeros(tessellation.n_vertices)])
    lifted = points.copy()
    tile = tessellation.tiles[0]
    lifted[tile[3], 2] += 0.3
    # unit square, one corner lifted by 0.3: six times the tetrahedron's volume
    assert FlatTiles(TriangulatedTiles.of(tessellation).diagonals).residual(lifted)[0, 0] == pytest.approx(
        0.3, abs=1e-12
    )
