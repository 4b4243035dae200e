"""The way from a rectangle to an outline: its ends, its patches, its first problem; and steps that fail."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirisurf.asked import standard
from kirisurf.contracted_shape import ContractedShape, regular_ratio, welded
from kirisurf.errors import ParameterError
from kirisurf.following import STEPS_EACH, followed
from kirisurf.formulation import Weights
from kirisurf.four_sides import between, patch
from kirisurf.morphing import Morph
from kirisurf.outlines import outline
from kirisurf.pattern import quad_pattern
from kirisurf.planar import regular_layout
from kirisurf.prescribed import Prescribed, rectangle_of
from kirisurf.rim import cell_size, free_rim, rectangle_rim
from kirisurf.solvers.interior_point import InteriorPoint
from kirisurf.solvers.outcome import Limits, Outcome
from kirisurf.status import Status
from kirisurf.two_states import Shape
from tests.kirisurf.both_states import NAMES, regular

LOW, HIGH = np.array([-1.0, -2.0]), np.array([3.0, 1.0])


def morph(name: str = "star", contracted: str = "free") -> Morph:
    tessellation = quad_pattern(2, 2)
    layout, middle = regular_layout(tessellation, outline(name))
    shape = {
        "free": ContractedShape(),
        "rectangle": ContractedShape("rectangle", 1.7),
        "outline": ContractedShape("outline", None, standard(outline("egg"))),
    }[contracted]
    return Morph(tessellation, layout, outline(name).moved(-middle), shape, Shape())


@pytest.mark.parametrize("name", ["star", "egg", "wavy"])
def test_outlines_on_the_way_lie_between_its_ends(name: str) -> None:
    given, _ = outline(name).four_sides()
    assert between(LOW, HIGH, given, 1.0) is given
    first = between(LOW, HIGH, given, 0.0)
    assert first.area == pytest.approx(np.prod(HIGH - LOW))
    np.testing.assert_allclose(first.box, [LOW, HIGH], atol=1e-12)
    corner = between(LOW, HIGH, given, 0.3).corners
    np.testing.assert_allclose(corner, 0.7 * first.corners + 0.3 * given.corners, atol=1e-12)


@pytest.mark.parametrize("name", ["star", "egg", "rect"])
def test_patches_meet_their_sides_and_fill_a_rectangle_evenly(name: str) -> None:
    given, _ = outline(name).four_sides()
    u = np.linspace(0, 1, 9)
    sides = [np.stack(p, 1) for p in ((u, 0 * u), (0 * u + 1, u), (1 - u, 0 * u + 1), (0 * u, 1 - u))]
    for side, place in zip(given.sides, sides, strict=True):
        np.testing.assert_allclose(patch(given, place), side.points(u * side.n_pieces), atol=1e-12)
    rectangle = between(LOW, HIGH, given, 0.0)
    place = np.random.default_rng(0).random((20, 2))
    np.testing.assert_allclose(patch(rectangle, place), LOW + place * (HIGH - LOW), atol=1e-12)


@pytest.mark.parametrize("contracted", ["free", "rectangle", "outline"])
def test_the_way_begins_at_a_solution_and_its_moves_compose(contracted: str) -> None:
    way = morph(contracted=contracted)
    start = way.start()
    rows = way.at(start, 0.0, Weights())(start).equality_rows(start)
    np.testing.assert_allclose(rows, 0.0, atol=1e-9)
    before = start.copy()
    there = way.moved(start, 0.0, 0.6)
    np.testing.assert_array_equal(start, before)
    np.testing.assert_allclose(way.moved(way.moved(start, 0.0, 0.2), 0.2, 0.6), there, atol=1e-12)
    np.testing.assert_allclose(way.moved(there, 0.6, 0.0), start, atol=1e-12)


class Failing:
    """Solves nothing beyond a part of the way."""

    def __init__(self, limits: Limits, status: Status, asked: list[int]) -> None:
        self.limits, self.status, self.asked = limits, status, asked

    def solve(self, problem, start, refresh=None, progress=None, should_stop=None) -> Outcome:
        self.asked.append(self.limits.max_steps)
        return Outcome(start, self.status)


@pytest.mark.parametrize("status", [Status.STEP_LIMIT, Status.INFEASIBLE, Status.INTERRUPTED])
def test_a_way_that_cannot_be_followed_is_given_up_with_its_reason(status: Status) -> None:
    way, asked = morph(), []
    outcome, notes = followed(way, lambda limits: Failing(limits, status, asked), Limits)
    # its own limit of steps is none that a user could lift
    assert outcome.status is (Status.STALLED if status is Status.STEP_LIMIT else status)
    assert len(asked) == (1 if status is Status.INTERRUPTED else 5) and set(asked) == {STEPS_EACH}
    assert "0 % of the way" in notes[0]
    np.testing.assert_allclose(outcome.points, way.moved(way.start(), 0.0, 1.0))


def test_a_limit_of_steps_is_shared_by_all_parts() -> None:
    outcome, _ = followed(morph(), lambda limits: InteriorPoint(limits), Limits, max_steps=5)
    assert outcome.status is Status.STEP_LIMIT
    solves = sum(step.seconds < 1e-12 or step.step_length == 0.0 for step in outcome.history)
    assert len(outcome.history) - solves <= 5


@pytest.mark.parametrize("name", NAMES)
def test_rims_of_rectangles_are_what_lies_farthest_out(name: str) -> None:
    layout = regular(name).deployed
    rim = rectangle_rim(layout)
    assert rim.has_sides
    for k, (axis, sign) in enumerate(((1, -1), (0, 1), (1, 1), (0, -1))):
        values = sign * layout[:, axis]
        expected = np.flatnonzero(values >= values.max() - 1e-9)
        np.testing.assert_array_equal(np.sort(rim.side(k)), expected)


def test_tips_of_a_free_rim_are_exceeded_by_no_neighbor() -> None:
    tessellation = quad_pattern(3, 3)
    low, high = tessellation.deployed.min(axis=0), tessellation.deployed.max(axis=0)
    outside = np.maximum(low - tessellation.deployed, tessellation.deployed - high).max(axis=1)
    spacing = cell_size(tessellation, tessellation.deployed)
    assert spacing == pytest.approx(np.sqrt(2), rel=0.05)
    rim = free_rim(tessellation, outside, spacing, tessellation.deployed)
    assert not rim.has_sides and set(rim.vertices) <= set(tessellation.outline)
    farthest = np.unique(rectangle_rim(tessellation.deployed).vertices)
    assert set(rim.vertices) <= set(farthest)
    # of two along one side of a tile one is left: whatever else lies farthest out has a tip next to it
    sides = [set(side) for side in tessellation.tiles.edges.tolist()]
    assert not any(side <= set(rim.vertices.tolist()) for side in sides)
    for vertex in set(farthest) - set(rim.vertices):
        assert any(vertex in side and side & set(rim.vertices.tolist()) for side in sides)


def test_patterns_without_four_contracted_sides_are_refused() -> None:
    tessellation = quad_pattern(2, 2)
    c, s = np.cos(0.3), np.sin(0.3)
    leaning = replace(tessellation, contracted=tessellation.contracted @ np.array([[c, s], [-s, c]]))
    with pytest.raises(ParameterError, match="four sides"):
        ContractedShape("rectangle").rows(leaning)


def test_the_nearest_rectangle_and_distances_to_it() -> None:
    tessellation = quad_pattern(2, 2)
    points = tessellation.contracted * [3.0, 2.0]
    rim = rectangle_rim(points)
    found = rectangle_of(points, rim, None)
    np.testing.assert_allclose(found.box, [points.min(axis=0), points.max(axis=0)], atol=1e-12)
    assert Prescribed(rim.vertices, rim.sides, found).distances(points).max() < 1e-12
    other = rectangle_of(points, rim, 6.0)
    assert np.divide(*np.ptp(other.box, axis=0)) == pytest.approx(6.0)
    assert other.area == pytest.approx(found.area)
    # a vertex on another side than its own is not where it belongs
    wrong = Prescribed(rim.vertices[:1], np.array([2]), found)
    assert wrong.distances(points)[0] == pytest.approx(np.ptp(points[:, 1]))


def test_welded_copies_have_one_contracted_point() -> None:
    tessellation = regular("kagome", 3, 2)
    flat = welded(tessellation, tessellation.contracted)
    np.testing.assert_allclose(flat[tessellation.weld], tessellation.contracted, atol=1e-12)
    assert regular_ratio(quad_pattern(3, 2)) == pytest.approx(1.5)
