"""Blocks of problems with both states obey the laws of blocks, and say what they should on known shapes."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.block import Block
from kirisurf.constraints.chord import OpeningsBelow, SquaredDistances
from kirisurf.constraints.facing import FacingTiles
from kirisurf.constraints.gap import OpenGaps
from kirisurf.constraints.isometry import IsometricTiles
from kirisurf.constraints.linear import LinearRows, plane_rows
from kirisurf.constraints.opening import OpenHinges
from kirisurf.constraints.outline import OnOutline, OnScaledOutline
from kirisurf.constraints.planarity import FlatTiles
from kirisurf.constraints.turn import TurnedCorners
from kirisurf.constraints.unfolded import UnfoldedTiles
from kirisurf.objective.fairness import EqualNeighbors
from kirisurf.objective.flat_shape import FlatTileShapes
from kirisurf.outlines import outline
from kirisurf.slit_ends import SlitEnds
from kirisurf.triangulation import TriangulatedTiles
from tests.kirisurf.block_laws import check_block
from tests.kirisurf.both_states import NAMES, bumpy, regular, regular_points, turned

UNEVEN = ("quad", "kagome", "islamic-quad", "islamic-triangle")


def check_flat_block(block: Block, points: np.ndarray) -> None:
    """The laws, with rigid motions of the plane, and heights that play no part."""
    check_block(block, points, invariant=False)
    rows = block.residual(points)
    np.testing.assert_allclose(block.residual(turned(points, 0.7, (3.0, -2.0))), rows, atol=1e-11)
    np.testing.assert_array_equal(block.residual(points + np.array([0, 0, 0.3])), rows)


@pytest.mark.parametrize("name", UNEVEN)
def test_laws_of_tiles_in_both_states(name: str) -> None:
    tessellation = regular(name)
    points = bumpy(regular_points(tessellation), noise=0.02)
    triangulated = TriangulatedTiles.of(tessellation)
    n = tessellation.n_vertices
    check_block(IsometricTiles(tessellation, triangulated), points, invariant=False)
    for block in (
        OpenHinges(tessellation, 0.05, points[:n]),
        FacingTiles(tessellation, points[:n]),
        FlatTiles(triangulated.diagonals),
        UnfoldedTiles(triangulated.diagonals, points[:n]),
        OpeningsBelow(SlitEnds.of(tessellation), 1.2),
        SquaredDistances(
            "wide", SlitEnds.of(tessellation).stencil[:, 1:3], np.full(len(SlitEnds.of(tessellation).stencil), 0.4)
        ),
    ):
        if len(block.stencil):
            check_block(block, points)


def test_isometry_sees_each_state_move_by_itself() -> None:
    tessellation = regular("kagome")
    points = bumpy(regular_points(tessellation))
    block, n = IsometricTiles(tessellation, TriangulatedTiles.of(tessellation)), tessellation.n_vertices
    moved = points.copy()
    moved[:n] = moved[:n, [1, 2, 0]] + [4, 5, 6]
    moved[n:] = turned(moved[n:], 1.1, (7.0, 8.0))
    np.testing.assert_allclose(block.residual(moved), block.residual(points), atol=1e-12)
    stretched = points.copy()
    stretched[:n] *= 1.1
    lengths = ((points[block.stencil[:, 0]] - points[block.stencil[:, 1]]) ** 2).sum(axis=1)
    np.testing.assert_allclose((block.residual(stretched) - block.residual(points))[:, 0], 0.21 * lengths, atol=1e-12)


@pytest.mark.parametrize("name", UNEVEN)
def test_laws_of_flat_shapes(name: str) -> None:
    """Straight corners (islamic-triangle) and reflex ones (both islamic patterns) among them."""
    tessellation = regular(name)
    points = bumpy(regular_points(tessellation), noise=0.02)
    corners = tessellation.n_vertices + tessellation.weld[tessellation.tiles.indices]
    for size, (_, loops) in tessellation.tiles.by_size().items():
        check_flat_block(FlatTileShapes(tessellation.n_vertices + tessellation.weld[loops]), points)
        block = EqualNeighbors(tessellation, size, FlatTileShapes, corners)
        check_flat_block(block, points)
        np.testing.assert_allclose(block.residual(regular_points(tessellation)), 0.0, atol=1e-12)


def test_flat_shapes_know_straight_and_reflex_corners() -> None:
    loop = np.array([[0, 0], [1, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]])
    points = np.column_stack([loop, np.zeros(6)]).astype(float)
    rows = FlatTileShapes(np.arange(6)[None]).residual(points).reshape(6, 2)
    # the notch between (2, 2) and (0, 2) ends at (1, 1/2): its sides rise by 3/2 over 1
    reflex = 2 * np.pi - 2 * np.arctan(1 / 1.5)
    np.testing.assert_allclose(rows[[0, 1, 4], 1], [np.pi / 2, np.pi, reflex], atol=1e-14)
    assert rows[:, 1].sum() == pytest.approx(4 * np.pi)
    np.testing.assert_allclose(rows[:3, 0], [1, 1, 2], atol=1e-15)


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 2, 2.5, np.pi])
def test_turned_corners_obey_the_laws_and_pin_their_angle(angle: float) -> None:
    rng = np.random.default_rng(2)
    points, corners = rng.standard_normal((12, 3)), rng.permutation(12).reshape(4, 3)
    check_flat_block(TurnedCorners("turn", corners, np.full(4, angle), np.full(4, 0.1)), points)
    # (previous, corner, next): from next to previous is the angle inside a counter-clockwise tile
    along = np.array([[2 * np.cos(angle), 2 * np.sin(angle), 0], [0, 0, 0], [3, 0, 0]])
    block = TurnedCorners("turn", np.array([[0, 1, 2]]), np.array([angle]))
    np.testing.assert_allclose(block.residual(along), 0.0, atol=1e-14)
    for more, sign in ((0.1, 1), (3.0, 1), (-0.1, -1)):
        beyond = np.array([[np.cos(angle + more), np.sin(angle + more), 0], [0, 0, 0], [3, 0, 0]])
        assert sign * block.residual(beyond)[0, 0] > 0
        np.testing.assert_allclose(block.residual(beyond), 3 * np.sin(more), atol=1e-13)


def test_linear_rows_obey_the_laws() -> None:
    rng = np.random.default_rng(3)
    points = rng.standard_normal((9, 3))
    stencil, coefficients, constants = rng.permutation(9).reshape(3, 3), rng.standard_normal((3, 3, 3)), np.arange(3.0)
    block = LinearRows("linear", stencil, coefficients, constants)
    check_block(block, points, invariant=False)
    expected = [(coefficients[k] * points[stencil[k]]).sum() - constants[k] for k in range(3)]
    np.testing.assert_allclose(block.residual(points)[:, 0], expected, atol=1e-14)
    np.testing.assert_array_equal(plane_rows("flat", np.array([2, 5])).residual(points)[:, 0], points[[2, 5], 2])


@pytest.mark.parametrize("name", ["disc", "egg", "star"])
def test_outline_rows_obey_the_laws_and_are_the_distance_to_third_order(name: str) -> None:
    curve = outline(name)
    points = np.column_stack([curve.polyline(0.5) * [1.05, 0.97], np.zeros(len(curve.polyline(0.5)))])
    vertices = np.arange(len(points))[::2]
    found = curve.project(points[vertices, :2])
    block = OnOutline("boundary", vertices, found)
    check_block(block, points, invariant=False)
    np.testing.assert_allclose(block.residual(points)[:, 0], found.distances, atol=1e-12)
    if name == "disc":
        radius = np.hypot(*points[vertices, :2].T)
        np.testing.assert_allclose(block.residual(points)[:, 0], radius - 1, atol=1e-9)
        # the model is of third order in the distance from where it was made, at points on the curve
        errors = []
        for step in (0.02, 0.01):
            here = points.copy()
            here[vertices, :2] = found.points + step * np.array([0.6, 0.8])
            errors.append(np.abs(block.residual(here)[:, 0] - (np.hypot(*here[vertices, :2].T) - 1)).max())
        assert np.log2(errors[0] / errors[1]) > 2.8


@pytest.mark.parametrize("name", ["disc", "egg", "star"])
def test_rows_of_an_outline_of_unknown_size(name: str) -> None:
    curve, size = outline(name), 1.7
    flat = size * curve.polyline(0.5) * [1.05, 0.97]
    points = np.vstack([np.column_stack([flat, np.zeros(len(flat))]), [[size, 0.4, -0.2]]])
    vertices = np.arange(len(flat))
    block = OnScaledOutline("contracted", vertices, len(flat), curve.project(flat / size))
    check_block(block, points, invariant=False)
    # rows of a size and of an outline at that size are the same
    fixed = OnOutline("contracted", vertices, curve.scaled(size).project(flat))
    np.testing.assert_allclose(block.residual(points), fixed.residual(points), atol=1e-9)
    # points and outline that grow together: the rows grow with them
    np.testing.assert_allclose(block.residual(3 * points), 3 * block.residual(points), atol=1e-12)
    # a row knows nothing of the other coordinates of the size
    other = points + np.r_[np.zeros((len(flat), 3)), [[0, 5.0, 7.0]]]
    np.testing.assert_array_equal(block.residual(other), block.residual(points))


@pytest.mark.parametrize("largest", [0.3, 1.0, np.pi / 2, 2.8])
def test_openings_are_below_an_angle_where_the_row_is_not_negative(largest: float) -> None:
    tessellation = regular("quad")
    ends = SlitEnds.of(tessellation)
    block = OpeningsBelow(ends, largest)
    points = regular_points(tessellation)
    a, b, c = ends.stencil[0, :3]
    for more, sign in ((0.0, 0), (1e-3, -1), (-1e-3, 1)):
        points[a], points[b] = [1, 1, 0], [3, 1, 0]
        points[c] = points[a] + 2 * np.array([np.cos(largest + more), np.sin(largest + more), 0])
        row = block.residual(points)[0, 0]
        assert abs(row) < 1e-12 if not sign else sign * row > 1e-5


def test_gaps_obey_the_laws_and_are_angles_beyond_a_half_turn() -> None:
    rng = np.random.default_rng(4)
    points, gaps = rng.standard_normal((15, 3)), rng.permutation(15).reshape(5, 3)
    check_flat_block(OpenGaps(gaps, 0.1), points)
    for angle in (-0.5, -0.1, 0.0, 1.0, 3.0, 3.3, 4.6, 5.7):
        corner = np.array([[2, 0, 0], [0, 0, 0], [np.cos(angle), np.sin(angle), 0.0]])
        assert OpenGaps(np.array([[0, 1, 2]]), 0.0).residual(corner)[0, 0] == pytest.approx(angle, abs=1e-14)


@pytest.mark.parametrize("name", NAMES)
def test_regular_deployed_tiles_are_open_flat_and_face_the_same_way(name: str) -> None:
    tessellation = regular(name)
    points = regular_points(tessellation)[: tessellation.n_vertices]
    diagonals = TriangulatedTiles.of(tessellation).diagonals
    assert OpenHinges(tessellation, 0.0, points).residual(points).min() > 0.1
    assert FacingTiles(tessellation, points, 0.0).residual(points).min() > 0.1
    if len(diagonals):
        np.testing.assert_allclose(FlatTiles(diagonals).residual(points), 0.0, atol=1e-15)
        assert UnfoldedTiles(diagonals, points).residual(points).min() > 0


@pytest.mark.parametrize("name", NAMES)
def test_overlaps_and_folds_are_negative(name: str) -> None:
    """The second side of a slit turned beyond the first, with its tile; and its tile turned over about that side."""
    tessellation = regular(name)
    points = regular_points(tessellation)[: tessellation.n_vertices]
    ends = SlitEnds.of(tessellation)
    for k in range(0, len(ends.stencil), max(1, len(ends.stencil) // 7)):
        a, b, c = ends.stencil[k, :3]
        tiles = [tile for tile in tessellation.tiles if a in tile]
        (second,) = (tile for tile in tiles if c in tile and c == tile[(list(tile).index(a) + 1) % len(tile)])
        u, v = points[b] - points[a], points[c] - points[a]
        opening = np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v)
        closed = points.copy()
        closed[second] = turned(points[second] - points[a], -(opening + 0.2), (0, 0)) + points[a]
        assert OpenHinges(tessellation, 0.0, points).residual(closed)[k].max() < 0
        assert FacingTiles(tessellation, points, 0.0).residual(closed)[k, 0] > 0
        axis = v / np.linalg.norm(v)
        folded = points.copy()
        folded[second] = (
            points[a] + 2 * ((points[second] - points[a]) @ axis)[:, None] * axis - (points[second] - points[a])
        )
        assert FacingTiles(tessellation, points, 0.0).residual(folded)[k, 0] < 0


def test_a_tile_folded_over_along_a_diagonal_is_negative() -> None:
    tessellation = regular("quad")
    points = regular_points(tessellation)[: tessellation.n_vertices]
    diagonals = TriangulatedTiles.of(tessellation).diagonals
    a, b, c, _ = diagonals[3]
    along = (points[c] - points[a]) / np.linalg.norm(points[c] - points[a])
    folded = points.copy()
    folded[b] = points[a] + 2 * ((points[b] - points[a]) @ along) * along - (points[b] - points[a])
    assert UnfoldedTiles(diagonals, points).residual(folded)[3, 0] < 0
    # flat as before, and as long: neither planarity nor isometry notices
    np.testing.assert_allclose(FlatTiles(diagonals).residual(folded)[3], 0.0, atol=1e-15)
