"""Constructions of the patches: what each knows of a surface, with which order, and what it cannot know."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from analysis.bernstein import tensor_rows
from analysis.constructions import CONSTRUCTIONS
from analysis.curvature import hole_curvature
from analysis.hole_measures import measure_holes
from analysis.patch_fitting import fitted_nets, net_differences
from analysis.patches import hole_patches
from kirisurf.closest import ClosestPoints
from kirisurf.design import Design, fit
from kirisurf.errors import ParameterError
from tests.analysis.patterns import NAMES, in_space, regular

GRAPHS = {
    "sphere": (lambda x, y: np.sqrt(4 - x * x - y * y), lambda x, y: 0 * x + 0.25),
    "paraboloid": (lambda x, y: 0.5 * (x * x + y * y), lambda x, y: (1 + x * x + y * y) ** -2.0),
    "hypar": (lambda x, y: 0.5 * x * y, lambda x, y: -0.25 * (1 + 0.25 * (x * x + y * y)) ** -2.0),
}
HINGES_BETWEEN_CENTERS = ("quad", "kagome", "hexagon", "truncated-square")
"""Patterns whose hinges lie between the centers of the two tiles."""
MANY_CORNERS = ("hexagon", "truncated-square")
"""Patterns whose holes have at least six corners, and not on a conic."""


def lifted(name, graph, n):
    pattern = regular(name, n)
    flat = pattern.deployed - pattern.deployed.mean(axis=0)
    flat = 0.9 * flat / np.abs(flat).max()
    return pattern, np.column_stack([flat, GRAPHS[graph][0](*flat.T)])


def relative_error(name, graph, n, construction):
    pattern, points = lifted(name, graph, n)
    patches = hole_patches(points, pattern, construction)
    found = hole_curvature(patches)
    truth = GRAPHS[graph][1](*found.centers[:, :2].T)
    assert not patches.ill_conditioned.any()
    return float(np.median(np.abs(found.gaussian - truth)) / np.median(np.abs(truth)))


@pytest.mark.parametrize("graph", GRAPHS)
@pytest.mark.parametrize("name", HINGES_BETWEEN_CENTERS)
def test_corners_and_normals_are_of_second_order_where_hinges_lie_between_centers(name, graph):
    coarse, fine = (relative_error(name, graph, n, "corners_and_normals") for n in (6, 12))
    assert np.log2(coarse / fine) >= 1.7 or fine <= 1e-4
    assert fine <= 3e-3


@pytest.mark.parametrize("graph", GRAPHS)
@pytest.mark.parametrize("name", MANY_CORNERS)
def test_many_corners_alone_are_of_second_order(name, graph):
    coarse, fine = (relative_error(name, graph, n, "corners") for n in (6, 12))
    assert np.log2(coarse / fine) >= 1.7 or fine <= 1e-4
    assert fine <= 1e-3


@pytest.mark.parametrize("graph", ["sphere", "paraboloid"])
def test_four_corners_cannot_tell_a_bowl_from_a_plane(graph):
    """Whatever the size of the tiles: all of the curvature is missing."""
    for n in (4, 12):
        pattern, points = lifted("quad", graph, n)
        found = hole_curvature(hole_patches(points, pattern, "corners"))
        assert (found.gaussian <= 1e-9).all()
        assert relative_error("quad", graph, n, "corners") == pytest.approx(1, abs=0.01)


def test_four_corners_of_a_square_are_joined_by_their_bilinear_patch():
    """With w = c x y / a^2 over the square of half-side a, K = -(c / a^2)^2 and H = 0 in the middle."""
    pattern = regular("quad", 2)
    points = in_space(pattern.deployed)
    hole = pattern.holes[0]
    middle = points[hole].mean(axis=0)
    # all else stays in the plane: the hole's plane must not tilt, so its corners move alike up and down
    points[hole, 2] += 0.01 * np.array([1, -1, 1, -1])
    found = hole_curvature(hole_patches(points, pattern, "corners"))
    half = np.abs(points[hole][:, :2] - middle[:2]).max()
    radius = np.linalg.norm(points[hole][:, :2] - middle[:2], axis=1)
    assert np.ptp(radius) < 1e-12, "the hole is a square"
    # along its diagonals the square's bilinear patch is x^2 - y^2
    assert found.gaussian[0] == pytest.approx(-((2 * 0.01 / radius[0] ** 2) ** 2), rel=0.02)
    assert half > 0


@pytest.mark.parametrize("construction", CONSTRUCTIONS)
@pytest.mark.parametrize("name", NAMES)
def test_planes_are_met_and_motions_change_nothing(name, construction, rotation):
    pattern = regular(name)
    flat = in_space(pattern.deployed)
    plane = hole_curvature(hole_patches(flat @ rotation.T, pattern, construction))
    assert np.abs(plane.gaussian).max() <= 1e-9 and np.abs(plane.mean).max() <= 1e-9
    bent = flat.copy()
    bent[:, 2] = 0.02 * flat[:, 0] ** 2 + 0.03 * flat[:, 0] * flat[:, 1]
    one = hole_curvature(hole_patches(bent, pattern, construction))
    two = hole_curvature(hole_patches(3 * bent @ rotation.T + 5.0, pattern, construction))
    assert 3 * two.mean == pytest.approx(one.mean, rel=1e-5, abs=1e-8)
    assert 9 * two.gaussian == pytest.approx(one.gaussian, rel=1e-5, abs=1e-8)


@pytest.mark.parametrize("construction", CONSTRUCTIONS)
@pytest.mark.parametrize("name", ["quad", "kagome", "right-triangles"])
def test_every_construction_is_drawn_from_center_to_corners(name, construction):
    pattern, points = lifted(name, "hypar", 4)
    patches = hole_patches(points, pattern, construction)
    grid = patches.sample(4)
    assert np.isfinite(grid).all()
    corners = np.stack([points[hole].mean(axis=0) for hole in pattern.holes])
    spread = np.linalg.norm(points[pattern.holes.indices] - corners[pattern.holes.owners], axis=1).max()
    assert np.linalg.norm(grid.reshape(len(grid), -1, 3).mean(axis=1) - corners, axis=1).max() < 0.3 * spread
    assert patches.residuals.max() < 0.05 * spread


@cache
def bowl() -> Design:
    return fit("paraboloid", cells=(4, 4))


def test_normals_of_rigid_tiles_mislead_at_the_corners_of_holes():
    """On a sheet of flat tiles the tiles tilt alternately: their mean at a hinge is not the surface's normal."""
    closest = ClosestPoints(bowl().surface)
    relative = {
        name: measure_holes(bowl().deployed_points, bowl().tessellation, closest, name).numbers[
            "gaussian_curvature_difference_relative"
        ]
        for name in CONSTRUCTIONS
    }
    assert relative["tiles"] < 0.1
    assert relative["corners_and_normals"] > 1 and relative["corners"] > 0.9


def test_only_what_is_of_the_patches_depends_on_the_construction():
    closest = ClosestPoints(bowl().surface)
    one, two = (
        measure_holes(bowl().deployed_points, bowl().tessellation, closest, c).fields for c in CONSTRUCTIONS[:2]
    )
    assert set(one) == set(two)
    for name in ("angle_defect", "gauss_image_area", "target_integrated_gaussian_curvature_cell", "opening_angle"):
        assert np.array_equal(one[name], two[name], equal_nan=True)
    assert not np.allclose(one["gaussian_curvature"], two["gaussian_curvature"])


def test_unknown_construction_is_named():
    pattern = regular("quad", 2)
    with pytest.raises(ParameterError, match="expected one of tiles, corners, corners_and_normals, got 'normals'"):
        hole_patches(in_space(pattern.deployed), pattern, "normals")


def test_nets_are_the_least_squares_answer_of_normal_equations():
    rng = np.random.default_rng(2)
    rows = tensor_rows(*rng.uniform(size=(2, 3, 20)))
    values = rng.normal(size=(3, 20, 1))
    penalty = np.sqrt(1e-3) * np.concatenate([net_differences(2), net_differences(3)])
    found = fitted_nets(rows, values, penalty)
    for k in range(3):
        normal = rows[k].T @ rows[k] + penalty.T @ penalty
        assert found[k] == pytest.approx(np.linalg.solve(normal, rows[k].T @ values[k]), abs=1e-8)
