"""Outlines: areas against formulas, similarities, corners, four sides, refusals."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from kirisurf.errors import ParameterError, UnusableError
from kirisurf.outlines import Outline, arc, bezier, joined, names, outline, spline, straight

AREAS = {
    "disc": math.pi,
    "ellipse": 0.6 * math.pi,
    "heart": 2 + 0.5 * math.pi,
    "rect": 6.0,
    "shear": 4.0,
    "anvil": 5.5,
    "wedge": 4.0,
    # Chord trapezium, and two thirds of chord times height for each parabola.
    "rainbow": 5.5 - 2 / 3 * 2 * 0.2 + 2 / 3 * 3.5 * 0.5,
    "circle": 2 + 4 * 2 / 3 * math.sqrt(2) * (1 - math.sqrt(0.5)),
    # Two bands of width 0.4 along arcs of 240 degrees of radius 0.5.
    "letter-s": 2 * 0.4 * 0.5 * math.radians(240),
}


def _l_shape() -> Outline:
    points = np.array([[0, 0], [3, 0], [3, 1], [1, 1], [1, 2], [0, 2], [0, 0.0]])
    return Outline.from_curve(straight(points), "L")


@pytest.mark.parametrize("name", sorted(AREAS))
def test_area_is_that_of_the_formula(name: str) -> None:
    np.testing.assert_allclose(outline(name).area, AREAS[name], rtol=4e-15)


@pytest.mark.parametrize("name", names())
def test_polygon_has_nearly_the_area_and_the_order_is_counter_clockwise(name: str) -> None:
    found = outline(name)
    assert found.polygon.is_valid
    np.testing.assert_allclose(found.polygon.area, found.area, rtol=3e-3)
    errors = [abs(_area(found.polyline(found.diagonal / n)) - found.area) for n in (100, 200, 400)]
    if errors[0] > 1e-12:
        assert errors[2] < errors[0] / 8


def _area(points: np.ndarray) -> float:
    x, y = points.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def test_length_is_that_of_the_circle() -> None:
    np.testing.assert_allclose(outline("disc").length, 2 * math.pi, rtol=1e-14)
    np.testing.assert_allclose(outline("heart").length, 2 * math.sqrt(2) + math.pi * math.sqrt(2), rtol=1e-14)


@pytest.mark.parametrize("name", names())
def test_sides_join_and_corners_are_their_starts(name: str) -> None:
    found = outline(name)
    for k, side in enumerate(found.sides):
        np.testing.assert_allclose(side.end, found.sides[(k + 1) % found.n_sides].start, atol=1e-14)
    assert found.corners.shape == (found.n_corners, 2)
    assert found.n_corners == (0 if found.is_smooth else found.n_sides)
    for corner, side in zip(found.corners, found.sides, strict=False):
        np.testing.assert_array_equal(corner, side.start)


@pytest.mark.parametrize("name", names())
def test_polyline_is_on_the_curve_and_has_the_corners(name: str) -> None:
    found = outline(name)
    points = found.polyline(0.03)
    assert np.abs(found.project(points).distances).max() < 1e-14 * found.diagonal
    steps = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    assert steps.max() < 0.03 * 1.05 and steps.min() > 0.015
    for corner in found.corners:
        assert np.linalg.norm(points - corner, axis=1).min() == 0


@pytest.mark.parametrize("name", names())
def test_similarities_carry_the_outline_along(name: str) -> None:
    found = outline(name)
    turn, factor, shift = 2.3, 0.17, np.array([-40.0, 3.0])
    matrix = factor * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    image = found.transformed(matrix, shift)
    np.testing.assert_allclose(image.area, factor**2 * found.area, rtol=1e-11)
    np.testing.assert_allclose(image.length, factor * found.length, rtol=1e-13)
    np.testing.assert_allclose(image.corners, found.corners @ matrix.T + shift, atol=1e-13)
    moved = found.moved(np.array([1.0, 2.0])).scaled(2.0)
    np.testing.assert_allclose(moved.corners, 2 * (found.corners + np.array([1, 2])), rtol=1e-15)


@pytest.mark.parametrize("name", ["shear", "letter-s", "disc", "heart"])
def test_a_mirror_image_runs_counter_clockwise_too(name: str) -> None:
    found = outline(name)
    image = found.transformed(np.diag([-1.0, 1.0]))
    np.testing.assert_allclose(image.area, found.area, rtol=1e-13)
    outside = np.array([[3.0, 0.3], [0.1, 4.0]])
    np.testing.assert_allclose(image.project(outside * [-1, 1]).distances, found.project(outside).distances, rtol=1e-13)


def test_a_stretched_circle_is_the_ellipse() -> None:
    image = outline("disc").transformed(np.diag([1.0, 0.6]))
    points = np.random.default_rng(0).uniform(-2, 2, (200, 2))
    np.testing.assert_allclose(
        image.project(points).distances, outline("ellipse").project(points).distances, atol=1e-15
    )


def test_clockwise_sides_are_turned() -> None:
    square = np.array([[0, 0], [0, 1], [1, 1], [1, 0], [0, 0.0]])
    found = Outline.from_sides([straight(square[k : k + 2]) for k in range(4)])
    np.testing.assert_allclose(found.area, 1.0, rtol=1e-15)
    assert found.n_corners == 4


def test_corners_are_found_where_the_curve_turns() -> None:
    found = _l_shape()
    assert found.n_corners == 6
    assert {tuple(corner) for corner in found.corners.tolist()} == {(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)}
    # A semicircle on a square: tangent where it begins, so that two corners are left.
    parts = [straight(np.array([[0, 1], [0, 0], [1, 0], [1, 1.0]])), arc([0.5, 1.0], 0.5, 0.0, math.pi)]
    assert Outline.from_curve(joined(parts)).n_corners == 2
    assert outline("disc").with_corners(outline("disc").find_corners()).is_smooth


@pytest.mark.parametrize("degrees", [15.0, 19.0, 21.0, 60.0])
def test_corner_angle_decides(degrees: float) -> None:
    rise = math.tan(math.radians(degrees))
    points = np.array([[0, 0], [1, 0], [2, rise], [2, 3], [0, 3], [0, 0.0]])
    assert Outline.from_curve(straight(points)).n_corners == (5 if degrees > 20 else 4)
    whole = Outline.from_curve(straight(points))
    assert len(whole.find_corners(math.radians(5))) == 5


@pytest.mark.parametrize("name", names())
def test_new_corners_change_nothing_but_the_sides(name: str) -> None:
    found = outline(name)
    marks = np.random.default_rng(1).uniform(0, found.curve.n_pieces, 5)
    marked = found.with_corners(marks)
    assert marked.n_corners == 5
    np.testing.assert_allclose(marked.area, found.area, rtol=1e-13)
    np.testing.assert_allclose(marked.length, found.length, rtol=1e-12)
    points = np.random.default_rng(2).uniform(-2, 2, (200, 2))
    np.testing.assert_allclose(marked.project(points).distances, found.project(points).distances, atol=1e-14)
    again = found.with_corners(marked.corners)
    assert np.abs(again.corners[:, None] - marked.corners).sum(axis=2).min(axis=1).max() < 1e-12


def test_an_outline_without_corners_is_smooth_and_may_have_one() -> None:
    found = outline("rainbow").with_corners(np.zeros(0))
    assert found.is_smooth and found.n_sides == 1 and found.corners.shape == (0, 2)
    drop = outline("disc").with_corners(np.array([[1.0, 0.0]]))
    assert drop.n_corners == 1 and not drop.is_smooth
    np.testing.assert_allclose(drop.corners, [[1, 0]], atol=1e-15)


@pytest.mark.parametrize("name", names())
def test_four_sides_are_bottom_right_top_left(name: str) -> None:
    sided, note = outline(name).four_sides()
    assert sided.n_sides == 4 and note.endswith(".")
    np.testing.assert_allclose(sided.area, outline(name).area, rtol=1e-13)
    if name not in ("letter-s", "shear", "heart"):
        bottom, right, top, left = (side.points(side.evenly(2))[1] for side in sided.sides)
        assert bottom[1] < min(right[1], left[1]) and top[1] > max(right[1], left[1])
        assert left[0] < min(bottom[0], top[0]) and right[0] > max(bottom[0], top[0])


def test_four_sides_of_a_circle_are_its_quarters() -> None:
    sided, note = outline("disc").four_sides()
    half = math.sqrt(0.5)
    np.testing.assert_allclose(sided.corners, [[-half, -half], [half, -half], [half, half], [-half, half]], atol=1e-14)
    assert "0 sharp corners" in note and "smallest rectangle" in note


def test_four_corners_of_a_turned_ellipse_turn_with_it() -> None:
    turn = math.radians(30)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    flat = outline("ellipse").four_sides()[0].corners
    turned = outline("ellipse").transformed(matrix).four_sides()[0].corners
    np.testing.assert_allclose(turned, flat @ matrix.T, atol=5e-3)


def test_four_given_corners_are_taken() -> None:
    points = np.array([[3, 0], [0, 0], [0, 2], [1, 1.0]])
    sided, note = _l_shape().four_sides(points)
    assert note == "The four given corners are those of the pattern."
    np.testing.assert_allclose(sided.corners, [[0, 0], [3, 0], [1, 1], [0, 2]], atol=1e-15)
    by_parameter, _ = outline("disc").four_sides(np.array([0.0, 1.0, 2.0, 3.0]))
    np.testing.assert_allclose(by_parameter.corners, [[0, -1], [1, 0], [0, 1], [-1, 0]], atol=1e-15)
    with pytest.raises(UnusableError, match="expected four corners, got 3"):
        _l_shape().four_sides(points[:3])
    with pytest.raises(UnusableError, match="expected 4 different places"):
        _l_shape().four_sides(points[[0, 1, 2, 2]])


def test_an_outline_without_four_corners_gets_those_of_its_rectangle() -> None:
    sided, note = _l_shape().four_sides()
    np.testing.assert_allclose(sided.corners[[0, 1]], [[0, 0], [3, 0]], atol=1e-15)
    assert "6 sharp corners, not four" in note


def test_crossing_curves_are_refused_with_the_place() -> None:
    bow = np.array([[0, 0], [2, 2], [2, 0], [0, 2], [0, 0.0]])
    with pytest.raises(UnusableError, match=r"does not cross itself, got one that does at \(1, 1\)"):
        Outline.from_curve(straight(bow), "bow")
    touching = np.array([[0, 0], [2, 0], [1, 1], [2, 2], [0, 2], [1, 1], [0, 0.0]])
    with pytest.raises(UnusableError, match=r"at \(1, 1\)"):
        Outline.from_curve(straight(touching))
    loop = bezier(np.array([[0, 0], [4, 3], [-3, 3], [1, 0.0]]))
    with pytest.raises(UnusableError, match=r"cross itself"):
        Outline.from_sides([loop, straight(np.array([[1, 0], [0, 0.0]]))])


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[0, 0], [1, 0], [1, 1.0]], r"expected consecutive sides to meet, got a gap of 1.41 at \(1, 1\)"),
        ([[0, 0], [1, 0], [0, 0.0]], "expected a curve"),
        ([[0, 0], [1, 0], [2, 1e-12], [0, 0.0]], "expected a curve"),
    ],
)
def test_curves_without_an_inside_are_refused(points: list[list[float]], message: str) -> None:
    with pytest.raises(UnusableError, match=message):
        Outline.from_sides([straight(np.array(points))])


def test_wrong_parameters_are_refused() -> None:
    found = outline("rect")
    for factor in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ParameterError, match="expected a positive number"):
            found.scaled(factor)
    with pytest.raises(ParameterError, match="has an inverse"):
        found.transformed(np.array([[1.0, 2.0], [2.0, 4.0]]))
    for spacing in (0.0, -1.0, math.nan, 1e-12):
        with pytest.raises(ParameterError, match="spacing"):
            found.polyline(spacing)
    with pytest.raises(UnusableError, match="expected finite"):
        found.with_corners(np.array([0.5, math.nan]))
    with pytest.raises(UnusableError, match="expected sides"):
        Outline.from_sides([])
    with pytest.raises(UnusableError, match="at most 1000 corners"):
        outline("disc").with_corners(np.linspace(0, 3.9, 1001))


def test_curves_keep_their_points_when_cut_and_turned() -> None:
    rng = np.random.default_rng(3)
    curve = joined([spline(rng.uniform(0, 1, (6, 2))), arc([1, 2], np.array([[1, 0.5], [0, 2]]), 0.3, 4.0)])
    u = rng.uniform(1.3, 6.9, 50)
    part = curve.part(1.3, 6.9)
    pieces, s = curve.located(u)
    here = np.where(pieces == 1, (s - 0.3) / 0.7, np.where(pieces == 6, 5 + s / 0.9, pieces - 1 + s))
    np.testing.assert_allclose(part.points(here), curve.points(u), atol=1e-13)
    np.testing.assert_allclose(curve.turned().points(curve.n_pieces - u), curve.points(u), atol=1e-13)
    np.testing.assert_allclose(curve.turned().length, curve.length, rtol=1e-13)


def test_even_parameters_are_even_along_the_length() -> None:
    side = outline("star").sides[0]
    u = side.evenly(40)
    lengths = [side.part(a, b).length for a, b in pairwise(u.tolist())]
    assert u[0] == 0 and u[-1] == side.n_pieces
    np.testing.assert_allclose(lengths, side.length / 40, rtol=5e-3)


def test_derivatives_have_slope_two() -> None:
    rng = np.random.default_rng(4)
    curve = joined([spline(rng.uniform(0, 1, (5, 2))), arc([1, 2], np.array([[1, 0.5], [0, 2]]), 0.3, 4.0)])
    pieces = np.arange(curve.n_pieces)
    s, step = rng.uniform(0.2, 0.8, len(pieces)), 1e-4
    (x, first, second), (y, after, _) = (curve.evaluated(pieces, s + k * step) for k in (0, 1))
    np.testing.assert_allclose(y, x + step * first + 0.5 * step**2 * second, atol=1e-10)
    np.testing.assert_allclose(after, first + step * second, atol=1e-6)


def test_curvature_is_that_of_the_formula() -> None:
    # Of the parabola y = x^2: 2 / (1 + 4 x^2)^(3/2), turning left.
    curve = spline(np.array([[-1, 1], [0, 0], [1, 1.0]]))
    u = np.linspace(0, 2, 21)
    x = curve.points(u)[:, 0]
    np.testing.assert_allclose(curve.curvatures(*curve.located(u)), 2 / (1 + 4 * x**2) ** 1.5, rtol=1e-13)


def test_control_points_on_the_chord_make_a_line() -> None:
    line = bezier(np.array([[0, 0], [0, 0], [2, 2], [2, 2.0]]))
    np.testing.assert_array_equal(line.polynomials[:, 2:], 0)
    wave = bezier(np.array([[0, 0], [1, 1], [2, 2], [2, 3.0]]))
    assert wave.polynomials[:, 2:].any()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: straight(np.zeros((1, 2))), "two or more"),
        (lambda: straight(np.zeros((2, 2))), "twice"),
        (lambda: bezier(np.zeros((4, 2))), "one place"),
        (lambda: bezier(np.zeros((5, 2))), "expected 2 to 4"),
        (lambda: spline(np.array([[0, math.nan], [1, 1]])), "finite"),
        (lambda: arc([0, 0], 0.0, 0.0, 1.0), "radius"),
        (lambda: arc([0, 0], 1.0, 0.0, 0.0), "angle"),
        (lambda: arc([0, 0], 1.0, 0.0, math.inf), "finite"),
    ],
)
def test_curves_that_are_none_are_refused(make: object, message: str) -> None:
    with pytest.raises(UnusableError, match=message):
        make()  # type: ignore[operator]
