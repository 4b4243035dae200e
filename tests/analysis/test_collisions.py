"""Tiles that reach into each other are found, whatever their shape; those that touch or hinge are not."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from scipy.optimize import linprog

from analysis.collisions import Collider, collisions
from analysis.convex_parts import ConvexParts
from analysis.intersections import crossing_pairs
from analysis.plates import Plates, depths
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.loops import Loops
from kirisurf.motion import motion_of
from kirisurf.pattern import tile_pattern
from kirisurf.unit_cell import quad_cell
from tests.analysis import patterns

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
MOUTH = np.array([[-2.0, -2], [2, -2], [2, 2], [1.5, 2], [1.5, -1.5], [-1.5, -1.5], [-1.5, 2], [-2, 2]])


def loose(*tiles: np.ndarray) -> tuple[np.ndarray, Loops]:
    loops = np.split(np.arange(sum(map(len, tiles))), np.cumsum([len(tile) for tile in tiles])[:-1])
    return np.concatenate(tiles), Loops.from_lists(loops)


def swollen(tessellation, factor):
    """Every tile on its own, larger about its middle."""
    polygons = [tessellation.deployed[tile] for tile in tessellation.tiles]
    return loose(*(middle + factor * (p - middle) for p in polygons for middle in [p.mean(axis=0)]))


def brute_force(points, tiles, least=1e-9):
    shapes = [shapely.Polygon(points[tile]) for tile in tiles]
    t = len(shapes)
    return [
        (i, j) for i in range(t) for j in range(i + 1, t) if shapely.intersection(shapes[i], shapes[j]).area > least
    ]


@pytest.mark.parametrize("name", patterns.NAMES)
@pytest.mark.parametrize("factor", [0.98, 1.15, 1.5])
def test_plane_tiles_against_brute_force_over_all_pairs(name, factor):
    points, tiles = swollen(patterns.regular(name, 2), factor)
    expected = brute_force(points, tiles)
    assert bool(expected) == (factor > 1) or factor == 1.15  # some patterns have room for that
    assert collisions(points, tiles).pairs.tolist() == [list(pair) for pair in expected]
    assert collisions(np.pad(points, ((0, 0), (0, 1))), tiles).pairs.tolist() == [list(pair) for pair in expected]


@pytest.mark.parametrize("name", patterns.NAMES)
def test_both_states_of_a_regular_pattern_are_free(name):
    pattern = patterns.regular(name)
    for points in (pattern.contracted, pattern.deployed):
        assert collisions(points, pattern.tiles).count == 0
        assert collisions(patterns.in_space(points), pattern.tiles, thickness=0.05).count == 0


@pytest.mark.parametrize("way", [0.2, -0.1, -0.4])
def test_rotating_squares_collide_where_they_turn_past_closed(way):
    motion = motion_of(quad_cell())
    pattern = tile_pattern(motion.cell, np.ones((3, 3), bool))
    lattice = motion.lattice(np.array([way]))[0]
    stretch = float(motion.stretch(np.array([way]))[0])
    corners = motion.corners(pattern.cells, np.full(pattern.n_tiles, way), lattice / stretch)
    points = np.zeros((pattern.n_vertices, 2))
    points[pattern.tiles.indices] = corners
    found = collisions(points, pattern.tiles)
    assert found.pairs.tolist() == [list(pair) for pair in brute_force(points, pattern.tiles)]
    assert bool(found.count) == (way < 0)


def test_overlap_in_the_plane_is_as_deep_as_it_is_wide():
    points, tiles = loose(SQUARE, SQUARE + np.array([0.9, 0.3, 0]))
    assert collisions(points[:, :2], tiles).depths == pytest.approx([0.1], abs=1e-7)
    assert collisions(points, tiles, thickness=0.01).depths == pytest.approx([0.1], abs=1e-7)
    assert collisions(points[:, :2], tiles, slit_width=0.04).depths == pytest.approx([0.06], abs=1e-7)
    assert collisions(points[:, :2], tiles, slit_width=0.11).count == 0


@pytest.mark.parametrize("thickness", [0.0, 0.1, 0.3])
def test_an_upright_tile_meets_a_lying_one_at_half_a_thickness(thickness, rotation):
    upright = SQUARE[:, [0, 2, 1]] + [0, 0.5, 0]  # stands with its foot on height 0
    for lift, hits in ((-1e-3, True), (1e-3, False)):
        points, tiles = loose(SQUARE, upright + np.array([0, 0, 0.5 * thickness + lift]))
        found = collisions(points @ rotation.T, tiles, thickness)
        assert found.count == hits
        if hits:
            assert found.deepest == pytest.approx(1e-3, rel=1e-3)


def test_parallel_tiles_meet_at_one_thickness(rotation):
    for gap, hits in ((0.0999, True), (0.1001, False)):
        points, tiles = loose(SQUARE, SQUARE + np.array([0.3, 0.2, gap]))
        assert collisions(points @ rotation.T, tiles, 0.1).count == hits


def hinged_squares(opening: float, fold: float) -> tuple[np.ndarray, Loops]:
    """Two unit squares on a hinge at 0, a slit upwards between them; the right one folds about its slit side."""
    slit = np.array([np.sin(opening), np.cos(opening), 0.0])
    across = np.array([np.cos(opening), -np.sin(opening), 0.0]) * np.cos(fold) + np.array([0, 0, np.sin(fold)])
    left = np.array([[0.0, 0, 0], [0, 1, 0], [-1, 1, 0], [-1, 0, 0]])
    right = np.array([across, across + slit, slit])
    return np.concatenate([left, right]), Loops.from_lists([[0, 1, 2, 3], [0, 4, 5, 6]])


@pytest.mark.parametrize("fold", [0.1, 0.5, 1.2, -0.8])
@pytest.mark.parametrize("thickness", [0.01, 0.1])
def test_squares_that_fold_pinch_below_the_angle_of_the_formula(fold, thickness, rotation):
    # at s along the slit side the folded tile's edge is (h / 2) sin(fold) nearer, and the slit s tan(opening) wide;
    # the corners are cut back to s = sqrt(2) h
    critical = np.arctan(np.sin(abs(fold)) / np.sqrt(8))
    for factor, hits in ((0.99, 1), (1.01, 0)):
        points, tiles = hinged_squares(factor * critical, fold)
        assert collisions(points @ rotation.T, tiles, thickness).count == hits
        assert collisions(points @ rotation.T, tiles).count == 0  # without thickness they touch in a point


def test_hinged_squares_that_open_flat_never_collide_and_past_closed_always():
    for thickness in (0.0, 0.1):
        for opening in (0.0, 1e-3, 1.0, 2.0):
            assert collisions(*hinged_squares(opening, 0.0), thickness).count == 0
        assert collisions(*hinged_squares(-0.05, 0.0), thickness).count == 1


def test_a_fold_about_an_axis_through_the_hinge_pinches_at_the_hinge_only():
    # tiles corner to corner fold about the line between them: their hinge corners alone come near to each other
    diamond = np.array([[0.0, 0, 0], [1, -1, 0], [2, 0, 0], [1, 1, 0]])
    for fold in np.radians([10, 60, 115]):
        turn = np.array([[np.cos(fold), 0, -np.sin(fold)], [0, 1, 0], [np.sin(fold), 0, np.cos(fold)]])
        points = np.concatenate([-diamond, (diamond @ turn.T)[1:]])
        assert collisions(points, Loops.from_lists([[0, 1, 2, 3], [0, 4, 5, 6]]), thickness=0.1).count == 0


def test_a_tile_in_the_mouth_of_a_concave_one(rotation):
    inside = 2 * (SQUARE[:, :2] - 0.5)
    for shift, hits in (((0, 0), 0), ((0.6, 0), 1), ((0, -0.6), 1), ((0, 5), 0)):
        points, tiles = loose(MOUTH, inside + shift)
        assert collisions(points, tiles).count == hits
        space = np.pad(points, ((0, 0), (0, 1))) @ rotation.T
        assert collisions(space, tiles, thickness=0.1).count == hits


def test_parts_are_convex_and_fill_the_tiles():
    points, tiles = swollen(patterns.regular("islamic-triangle", 1), 1.0)
    points, tiles = loose(MOUTH, *(points[tile] + 10 for tile in tiles))
    space = np.pad(points, ((0, 0), (0, 1)))
    parts = ConvexParts.of(space, tiles, np.arange(len(points)), np.radians(120))
    shapes = [shapely.Polygon(points[corners]) for corners in parts.corners]
    areas = shapely.area(shapes)
    assert np.allclose(areas, shapely.area(shapely.convex_hull(shapes)), rtol=1e-12)
    whole = [shapely.Polygon(points[tile]).area for tile in tiles]
    assert np.bincount(parts.tiles, areas) == pytest.approx(whole, rel=1e-12)
    for corners in parts.corners:
        loop = points[list(dict.fromkeys(corners.tolist()))]
        ahead, back = np.roll(loop, -1, axis=0) - loop, np.roll(loop, 1, axis=0) - loop
        cosine = np.einsum("ki,ki->k", ahead, back) / np.linalg.norm(ahead, axis=1) / np.linalg.norm(back, axis=1)
        assert len(loop) == 3 or (cosine > np.cos(np.radians(120.1))).all()


def test_depth_of_plates_in_general_position_against_linear_programming():
    rng = np.random.default_rng(7)
    triangles = rng.normal(size=(400, 3, 3))
    triangles[200:] += 0.5 * rng.normal(size=(200, 1, 3))
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    plates = Plates.of(triangles, normals, 0.2)
    hits = depths(plates.chosen(np.arange(200)), plates.chosen(np.arange(200, 400)), 1.0) > 0

    def common_point(i, j):
        corners = [np.r_[triangles[k] + 0.1 * normals[k], triangles[k] - 0.1 * normals[k]] for k in (i, j)]
        equal = np.block([[corners[0].T, -corners[1].T], [np.ones(6), np.zeros(6)], [np.zeros(6), np.ones(6)]])
        return linprog(np.zeros(12), A_eq=equal, b_eq=[0, 0, 0, 1, 1]).status == 0

    expected = [common_point(i, 200 + i) for i in range(200)]
    assert 20 < sum(expected) < 180
    assert hits.tolist() == expected


def test_pushed_by_its_depth_a_tile_only_touches():
    one, two = SQUARE[None], (SQUARE + np.array([0.7, 0.2, 0.0]))[None]
    up = np.array([[0.0, 0, 1]])
    for turn in (0.0, 0.3):
        r = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
        first, second = Plates.of(one, up, 0.1), Plates.of(two @ r.T, up, 0.1)
        depth = depths(first, second, 1.0)[0]
        shifts = [depth * np.array([np.cos(a), np.sin(a), 0]) for a in np.linspace(0, 2 * np.pi, 721)]
        after = [depths(first, Plates.of(second.corners + shift, up, 0.1), 1.0)[0] for shift in shifts]
        assert min(after) == pytest.approx(0.0, abs=1e-4)  # no shorter shift parts them, one of this length does
        closer = [depths(first, Plates.of(second.corners + 0.98 * s, up, 0.1), 1.0)[0] for s in shifts]
        assert min(closer) > 1e-3


def test_rigid_motion_scale_and_order_of_tiles_change_nothing(rotation):
    points, tiles = swollen(patterns.regular("kagome", 2), 1.2)
    space = np.pad(points, ((0, 0), (0, 1)))
    space[:, 2] = 0.1 * np.sin(3 * space[:, 0])
    space = np.concatenate([space[tile].mean(axis=0) + (space[tile] - space[tile].mean(axis=0)) for tile in tiles])
    found = collisions(space, tiles, 0.02)
    assert found.count > 10
    moved = collisions(7 * space @ rotation.T + [3, -50, 20], tiles, 0.14)
    assert moved.pairs.tolist() == found.pairs.tolist()
    assert moved.depths == pytest.approx(found.depths, abs=1e-7)
    order = np.random.default_rng(0).permutation(len(tiles))
    shuffled = collisions(space, tiles.subset(order), 0.02)
    assert sorted(np.sort(order[shuffled.pairs], axis=1).tolist()) == found.pairs.tolist()


def test_wrong_lengths_and_points_are_named():
    points, tiles = loose(SQUARE, SQUARE + np.array([2, 0, 0]))
    with pytest.raises(ParameterError, match=r"thickness: expected a number from 0 to 0\.5"):
        collisions(points, tiles, 0.6)
    with pytest.raises(ParameterError, match="thickness"):
        collisions(points, tiles, np.nan)
    with pytest.raises(ParameterError, match="slit width"):
        collisions(points, tiles, slit_width=-1.0)
    with pytest.raises(UnusableError, match="expected shape"):
        Collider.of(points, tiles).collisions(points[:, :2])
    with pytest.raises(UnusableError, match="itself"):
        collisions(np.array([[0.0, 0], [1, 1], [1, 0], [0.1, 1.2], [2, 2]]), Loops.from_lists([[0, 1, 2, 3, 4]]))


def test_without_thickness_the_certificate_finds_the_same_crossings():
    rng = np.random.default_rng(3)
    triangles = rng.uniform(-1, 1, (80, 1, 3)) * 2 + rng.normal(size=(80, 3, 3)) * 0.6
    points, tiles = loose(*triangles)
    expected = crossing_pairs(points, tiles, 1.0).tolist()
    assert len(expected) > 20
    assert collisions(points, tiles).pairs.tolist() == sorted(map(sorted, expected))


def test_tiles_that_are_not_quite_flat_or_rigid_are_taken_as_they_are():
    # as an energy leaves them: bent by a thousandth and stretched by a hundredth
    pattern = patterns.regular("quad", 3)
    flat, opened = patterns.in_space(pattern.contracted), patterns.in_space(pattern.deployed)
    collider = Collider.of(flat, pattern.tiles, 0.02)
    bent = 1.01 * opened + 1e-3 * np.random.default_rng(0).normal(size=opened.shape)
    assert collider.collisions(bent).count == 0
