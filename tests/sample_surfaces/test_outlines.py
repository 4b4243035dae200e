"""Outlines: points lie on the curve, evenly, with every corner, counter-clockwise."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.errors import ParameterError
from sample_surfaces.outlines import (
    CurvedPolygon,
    Outline,
    PolarCurve,
    RoundedPolygon,
    outline_box,
    outline_from,
    outline_points,
)

ELLIPSE = PolarCurve(np.array([3.0, 2.0]), np.zeros((0, 3)))
BLOB = PolarCurve(np.array([3.0, 2.0]), np.array([[2, 0.1, 0.3], [5, 0.05, 1.0]]))
HEXAGON = RoundedPolygon(6, 2.0, 12.0)
PANEL = CurvedPolygon(np.array([[0.0, 0], [4, 0], [5, 3], [-1, 3]]), np.array([0.1, -0.05, 0.2, 0.0]))
OUTLINES = {"ellipse": ELLIPSE, "blob": BLOB, "hexagon": HEXAGON, "panel": PANEL}


@pytest.mark.parametrize("name", OUTLINES)
def test_points_are_even_and_counter_clockwise(name: str):
    """Distances between neighbors differ by little, their number follows the length, the area is positive."""
    outline: Outline = OUTLINES[name]
    points = outline_points(outline, 0.05)
    ahead = np.roll(points, -1, axis=0)
    edges = np.linalg.norm(ahead - points, axis=1)
    assert edges.max() < 1.06 * 0.05
    assert edges.min() > 0.94 * 0.05
    assert (points[:, 0] * ahead[:, 1] - points[:, 1] * ahead[:, 0]).sum() > 0


@pytest.mark.parametrize("name", OUTLINES)
def test_the_box_holds_the_curve_tightly(name: str):
    """The box of fine samples agrees with the outline's box to the sagitta of their spacing."""
    points = outline_points(OUTLINES[name], 1e-3)
    box = outline_box(OUTLINES[name])
    assert points.min(axis=0) == pytest.approx(box[0], abs=1e-5)
    assert points.max(axis=0) == pytest.approx(box[1], abs=1e-5)


def test_an_ellipse_is_an_ellipse():
    """(x / a)^2 + (y / b)^2 = 1, and the length is the complete elliptic integral's."""
    points = outline_points(ELLIPSE, 0.01)
    assert ((points / [3, 2]) ** 2).sum(axis=1) == pytest.approx(np.ones(len(points)), rel=1e-14)
    length = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1).sum()
    assert length == pytest.approx(15.865439589290589, rel=1e-5)


def test_a_rounded_polygon_keeps_its_symmetry_and_its_sides():
    """Its sides' midpoints lie an apothem away, up to the neighbors' small share; corners are cut off."""
    radii = np.linalg.norm(outline_points(HEXAGON, 0.01), axis=1)
    assert radii.min() == pytest.approx(2.0, rel=1e-3)
    assert 2.0 < radii.max() < 2.0 / np.cos(np.pi / 6)
    turned = HEXAGON.side(0, np.array([0.05, 0.05 + 1 / 6]))
    assert np.linalg.norm(turned, axis=1)[0] == pytest.approx(np.linalg.norm(turned, axis=1)[1], rel=1e-14)


def test_a_curved_polygon_keeps_its_corners_and_bulges():
    """Corners are among the points; a side's middle lies its bulge times its chord outside."""
    points = outline_points(PANEL, 0.1)
    for corner in PANEL.corners:
        assert (points == corner).all(axis=1).any()
    assert PANEL.side(0, np.array([0.5]))[0] == pytest.approx([2.0, -0.4])


def test_an_unknown_kind_is_refused():
    """The message names the kinds that there are."""
    with pytest.raises(ParameterError, match="expected curved_polygon, polar or rounded_polygon, got 'star'"):
        outline_from({"kind": "star"})
