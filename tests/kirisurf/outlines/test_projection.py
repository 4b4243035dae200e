"""Closest points on outlines: brute force, Taylor slopes, invariances, extensions beyond corners."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.errors import ParameterError
from kirisurf.outlines import Outline, bezier, names, outline, straight

NAMES = names()


def _near(name: str, n: int, seed: int = 0) -> tuple[Outline, np.ndarray]:
    found = outline(name)
    low, high = found.box
    margin = 0.3 * (high - low)
    return found, np.random.default_rng(seed).uniform(low - margin, high + margin, (n, 2))


@pytest.mark.parametrize("name", NAMES)
def test_no_point_of_the_curve_is_closer(name: str) -> None:
    found, points = _near(name, 300)
    projection = found.project(points)
    dense = found.curve.points(np.linspace(0.0, found.curve.n_pieces, 40_001))
    brute = np.array([np.linalg.norm(dense - p, axis=1).min() for p in points])
    away = np.linalg.norm(points - projection.points, axis=1)
    spacing = np.linalg.norm(np.diff(dense, axis=0), axis=1).max()
    assert (away <= brute + 1e-14 * found.diagonal).all()
    # A dense point lies within half a spacing of the foot.
    assert (away >= brute - 0.5 * spacing).all()


@pytest.mark.parametrize("name", NAMES)
def test_feet_lie_on_their_sides_and_perpendiculars_are_exact(name: str) -> None:
    found, points = _near(name, 300, seed=1)
    projection = found.project(points)
    for k in range(found.n_sides):
        mine = projection.sides == k
        on_side = found.sides[k].points(projection.parameters[mine])
        np.testing.assert_allclose(on_side, projection.points[mine], atol=1e-14 * found.diagonal, rtol=0)
    away = points - projection.points
    tangents = np.stack([-projection.normals[:, 1], projection.normals[:, 0]], axis=1)
    at_corner = (
        np.zeros(len(points), bool)
        if not found.n_corners
        else (np.linalg.norm(projection.points[:, None] - found.corners, axis=2).min(axis=1) < 1e-12)
    )
    # The foot is known to rounding of the coordinates, over 1 + k d where that is small.
    steepness = np.abs(1 + projection.curvatures * projection.distances)
    slack = 1e-13 * found.diagonal * np.maximum(1.0, 1.0 / np.maximum(steepness, 1e-6))
    assert (np.abs((away * tangents).sum(axis=1))[~at_corner] <= slack[~at_corner]).all()
    np.testing.assert_allclose(np.linalg.norm(projection.normals, axis=1), 1.0, rtol=1e-14)


@pytest.mark.parametrize("name", NAMES)
def test_sign_is_that_of_the_polygon(name: str) -> None:
    import shapely

    found, points = _near(name, 500, seed=2)
    distances = found.project(points).distances
    clear = np.abs(distances) > 2e-3 * found.diagonal
    inside = shapely.contains_xy(found.polygon, points)
    np.testing.assert_array_equal(distances[clear] < 0, inside[clear])


def test_circle_is_exact() -> None:
    found, points = _near("disc", 1000)
    radius = np.linalg.norm(points, axis=1)
    projection = found.project(points)
    np.testing.assert_allclose(projection.distances, radius - 1, atol=1e-15, rtol=0)
    np.testing.assert_allclose(projection.points, points / radius[:, None], atol=1e-14, rtol=0)
    np.testing.assert_allclose(projection.curvatures, 1.0, rtol=1e-14)
    np.testing.assert_allclose(found.project(np.zeros((1, 2))).distances, -1.0, rtol=1e-15)


def test_center_of_a_symmetric_outline_has_a_closest_point_among_equal_ones() -> None:
    found = outline("ellipse")
    projection = found.project(np.array([[0.0, 0.0], [0.1, 0.0], [-0.1, 0.0]]))
    # Of (0.1, 0): the foot of an ellipse with half axes a, b at x = a^2 x0 / (a^2 - b^2).
    x = 0.1 / (1 - 0.36)
    expected = np.hypot(x - 0.1, 0.6 * np.sqrt(1 - x**2))
    np.testing.assert_allclose(projection.distances, [-0.6, -expected, -expected], rtol=1e-15)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("sides", [False, True])
def test_second_order_model_has_slope_three(name: str, sides: bool) -> None:
    found = outline(name)
    rng = np.random.default_rng(3)
    side = rng.integers(0, found.n_sides, 40)
    u = np.array([rng.uniform(0.1, 0.9) * found.sides[k].n_pieces for k in side])
    # Away from joints of pieces, where the curvature may jump.
    u = np.floor(u) + 0.1 + 0.8 * (u - np.floor(u))
    foot = np.concatenate([found.sides[k].points(np.array([v])) for k, v in zip(side, u, strict=True)])
    base = found.project(foot, side)
    direction = rng.normal(size=(40, 2))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    steps = found.diagonal * np.array([1e-3, 5e-4, 2.5e-4])
    errors = []
    for step in steps:
        x = foot + step * direction
        tangent = np.stack([-base.normals[:, 1], base.normals[:, 0]], axis=1)
        along = ((x - base.points) * tangent).sum(axis=1)
        model = ((x - base.points) * base.normals).sum(axis=1) + 0.5 * base.curvatures * along**2
        errors.append(np.abs(found.project(x, side if sides else None).distances - model).max())
    if max(errors) > 1e-13:
        slopes = np.diff(np.log(errors)) / np.diff(np.log(steps))
        assert slopes.min() > 2.8


@pytest.mark.parametrize("name", ["rainbow", "star", "heart", "letter-s"])
def test_gradient_is_the_normal_and_hessian_follows_from_the_curvature(name: str) -> None:
    found, points = _near(name, 60, seed=4)
    side = np.random.default_rng(5).integers(0, found.n_sides, len(points))
    base = found.project(points, side, extended=True)
    sound = np.abs(1 + base.curvatures * base.distances) > 0.3
    h = 1e-5
    for k in range(2):
        step = h * np.eye(2)[k]
        ahead, behind = (found.project(points + sign * step, side, extended=True) for sign in (1, -1))
        gradient = (ahead.distances - behind.distances) / (2 * h)
        change = (ahead.normals - behind.normals) / (2 * h)
        steady = sound & (np.linalg.norm(ahead.points - behind.points, axis=1) < 20 * h)
        steady &= (ahead.curvatures == 0) == (behind.curvatures == 0)
        np.testing.assert_allclose(gradient[steady], base.normals[steady, k], atol=1e-8)
        tangent = np.stack([-base.normals[:, 1], base.normals[:, 0]], axis=1)
        expected = (base.curvatures / (1 + base.curvatures * base.distances) * tangent[:, k])[:, None] * tangent
        smooth = steady & (np.abs(ahead.curvatures - behind.curvatures) < 1e-2)
        assert smooth.sum() > 20
        np.testing.assert_allclose(change[smooth], expected[smooth], atol=2e-3)


@pytest.mark.parametrize("name", NAMES)
def test_extended_sides_go_on_along_their_tangents(name: str) -> None:
    found = outline(name)
    for k, side in enumerate(found.sides[: found.n_corners]):
        for u, sign in ((0.0, -1.0), (float(side.n_pieces), 1.0)):
            pieces, s = side.located(np.array([u]))
            tangent = side.tangents(pieces, s)[0]
            normal = np.array([tangent[1], -tangent[0]])
            end = side.points(np.array([u]))[0]
            beyond = 1e-2 * found.diagonal
            point = end + sign * beyond * tangent + 1e-3 * normal
            projection = found.project(point[None], np.array([k]), extended=True)
            if np.linalg.norm(found.project(point[None], np.array([k])).points[0] - end) > 1e-9:
                continue  # another part of the side is closer
            np.testing.assert_allclose(projection.distances[0], 1e-3, rtol=1e-9)
            np.testing.assert_allclose(projection.points[0], end + sign * beyond * tangent, atol=1e-12)
            np.testing.assert_allclose(projection.normals[0], normal, atol=1e-12)
            assert projection.curvatures[0] == 0
            assert sign * (projection.parameters[0] - u) > 0
            np.testing.assert_allclose(side.points(projection.parameters)[0], projection.points[0], atol=1e-12)


def test_a_straight_side_is_its_line_on_both_sides_of_its_ends() -> None:
    found = outline("rect").four_sides()[0]
    points = np.array([[-5.0, -2.0], [0.0, -1.0], [7.0, -1.5]])
    projection = found.project(points, np.zeros(3, np.int64), extended=True)
    np.testing.assert_allclose(projection.distances, [0.5, -0.5, 0.0], atol=1e-15)
    np.testing.assert_allclose(projection.points, [[-5, -1.5], [0, -1.5], [7, -1.5]], atol=1e-15)
    ends = found.project(points, np.zeros(3, np.int64))
    np.testing.assert_allclose(ends.points, [[-1, -1.5], [0, -1.5], [1, -1.5]], atol=1e-15)


def test_distance_is_continuous_across_the_end_of_a_side() -> None:
    found = outline("circle")
    corner = found.corners[1]
    around = corner + 1e-3 * np.stack([np.cos(t := np.linspace(0, 2 * np.pi, 2001)), np.sin(t)], axis=1)
    projection = found.project(around, np.zeros(len(around), np.int64), extended=True)
    assert np.abs(np.diff(projection.distances)).max() < 1e-3 * 2 * np.pi / 2000 * 1.01
    assert np.linalg.norm(np.diff(projection.normals, axis=0), axis=1).max() < 1e-4


@pytest.mark.parametrize("name", ["disc", "heart", "wavy"])
def test_similarities_carry_projections_along(name: str) -> None:
    found, points = _near(name, 200, seed=6)
    turn, factor, shift = 0.7, 3.7, np.array([12.0, -5.0])
    matrix = factor * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    here = found.project(points)
    there = found.transformed(matrix, shift).project(points @ matrix.T + shift)
    np.testing.assert_allclose(there.distances, factor * here.distances, atol=1e-13 * factor * found.diagonal)
    same = np.linalg.norm(there.points - (here.points @ matrix.T + shift), axis=1) < 1e-6
    assert same.mean() > 0.98  # the others have two closest points, or nearly so
    np.testing.assert_allclose(there.normals[same], here.normals[same] @ matrix.T / factor, atol=1e-6)
    np.testing.assert_allclose(there.curvatures[same], here.curvatures[same] / factor, atol=1e-6)


def test_corner_seen_from_outside_is_at_its_distance() -> None:
    found = outline("shear")
    projection = found.project(np.array([[2.0, 1.5], [1.5, 1.0]]))
    np.testing.assert_allclose(projection.distances, [np.sqrt(0.5), 0.0], atol=1e-15)
    np.testing.assert_allclose(projection.points, [[1.5, 1.0], [1.5, 1.0]], atol=1e-15)


def test_a_handle_without_length_has_a_tangent() -> None:
    lens = Outline.from_sides([bezier([[0, 0], [0, 0], [1, -1], [2, 0]]), straight([[2, 0], [0, 0]])])
    projection = lens.project(np.array([[-0.5, -0.1], [1.0, -0.6]]), np.zeros(2, np.int64), extended=True)
    np.testing.assert_allclose(projection.normals[0], [-np.sqrt(0.5), -np.sqrt(0.5)], atol=1e-6)
    assert np.isfinite(projection.curvatures).all()


def test_no_points_have_no_feet() -> None:
    projection = outline("disc").project(np.zeros((0, 2)))
    assert projection.points.shape == (0, 2) and projection.sides.shape == (0,)


def test_sides_that_are_not_there_are_refused() -> None:
    found, points = _near("rect", 3)
    with pytest.raises(ParameterError, match="expected 0 to 3, got 0 to 4"):
        found.project(points, np.array([0, 4, 1]))
    with pytest.raises(ParameterError, match="expected sides"):
        found.project(points, extended=True)
