"""Views and frames."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.surface import Surface
from tests.viewers.conftest import height_field
from viewers.framing import FROM_ABOVE, choose_view, fit_frame, round_length


def test_view_axes_are_a_right_handed_frame():
    for view in (FROM_ABOVE, choose_view(height_field(lambda x, y: 0.5 * x * y))):
        assert np.allclose(view.axes @ view.axes.T, np.eye(3), atol=1e-14)
        assert np.linalg.det(view.axes) == pytest.approx(1.0)


@pytest.mark.parametrize("scale, offset", [(1e-6, 0.0), (1.0, 1e5), (1e6, -3.0)])
def test_view_does_not_depend_on_size_and_place(scale, offset):
    surface = height_field(lambda x, y: np.sin(2 * x) * np.cos(y))
    moved = Surface.from_arrays(scale * (surface.vertices + offset), surface.faces)
    assert np.allclose(choose_view(moved).direction, choose_view(surface).direction)


def test_height_fields_are_seen_from_above_whichever_way_their_normals_point():
    surface = height_field(lambda x, y: 0.3 * (x**2 + y**2))
    turned = Surface.from_arrays(surface.vertices, surface.faces[:, ::-1])
    for shape in (surface, turned):
        view = choose_view(shape)
        assert view.up == (0.0, 0.0, 1.0)
        assert 0.5 < view.direction[2] < 0.9


def test_a_steep_bowl_is_seen_from_higher_up_than_a_shallow_one():
    shallow, steep = (choose_view(height_field(lambda x, y, h=h: h * (x**2 + y**2))) for h in (0.1, 1.2))
    assert steep.direction[2] > shallow.direction[2]


@pytest.mark.parametrize("facing", [(0.0, -1.0), (1.0, 0.0), (0.6, 0.8)])
def test_a_facade_is_seen_from_its_front(facing):
    flat = height_field(lambda x, y: 0.1 * x * y)
    normal = np.array([*facing, 0.0])
    axes = np.stack([np.cross([0.0, 0.0, 1.0], normal), [0.0, 0.0, 1.0], normal])
    view = choose_view(Surface.from_arrays(flat.vertices @ axes, flat.faces))
    assert np.dot(view.direction, normal) > 0.8
    assert view.up == (0.0, 0.0, 1.0)


def test_the_longer_side_lies_across_the_picture():
    surface = height_field(lambda x, y: 0.1 * x * y)
    long = Surface.from_arrays(surface.vertices * [1.0, 6.0, 1.0], surface.faces)
    right = choose_view(long).axes[0]
    assert abs(right[1]) > 0.9


@pytest.mark.parametrize("aspect", [0.5, 1.0, 2.4])
def test_frame_shows_every_point_with_the_margin(aspect, sheet):
    view = choose_view(sheet.target)
    frame = fit_frame(view, sheet.deployed, aspect, margin=0.05)
    seen = (sheet.deployed - frame.center) @ view.axes.T
    reach = np.abs(seen[:, :2]).max(axis=0) / (frame.half_height * np.array([aspect, 1.0]))
    assert reach.max() == pytest.approx(0.9)


def test_frame_of_nothing_and_of_one_point():
    assert fit_frame(FROM_ABOVE, np.zeros((0, 3)), 1.0).half_height == 1.0
    assert fit_frame(FROM_ABOVE, np.ones((1, 3)), 1.0).half_height == 1.0


@pytest.mark.parametrize(
    "length, expected", [(1.0, 1.0), (0.99, 0.5), (7.3, 5.0), (2.0, 2.0), (3e-5, 2e-5), (0.0, 1.0)]
)
def test_round_lengths(length, expected):
    assert round_length(length) == pytest.approx(expected)
