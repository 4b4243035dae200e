"""Planar surfaces: topology, rim on the curve, area of second order, well-shaped triangles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirisurf.errors import ParameterError
from kirisurf.outlines import Outline, names, outline, planar_surface, straight
from kirisurf.surface import Surface
from kirisurf.topology import require_disk


def _quality(surface: Surface) -> np.ndarray:
    corners = surface.vertices[surface.faces]
    squares = ((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=(1, 2))
    return 4 * math.sqrt(3) * surface.face_areas / squares


def _check(surface: Surface, found: Outline) -> None:
    require_disk(surface)
    edges = np.unique(np.sort(surface.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    assert len(surface.vertices) - len(edges) + len(surface.faces) == 1
    assert (surface.vertices[:, 2] == 0).all()
    a, b, c = (surface.vertices[surface.faces[:, k], :2] for k in range(3))
    u, w = b - a, c - a
    assert (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]).min() > 0
    (loop,) = surface.boundary_loops
    rim = surface.vertices[loop, :2]
    assert np.abs(found.project(rim).distances).max() < 1e-14 * found.diagonal
    for corner in found.corners:
        assert np.linalg.norm(rim - corner, axis=1).min() < 1e-14 * found.diagonal
    inner = np.setdiff1d(np.arange(len(surface.vertices)), loop)
    if len(inner):
        assert found.project(surface.vertices[inner, :2]).distances.max() < 0


@pytest.mark.parametrize("name", names())
@pytest.mark.parametrize("parts", [8, 25, 80])
def test_mesh_is_a_disk_with_its_rim_on_the_curve(name: str, parts: int) -> None:
    found = outline(name)
    surface = planar_surface(found, found.diagonal / parts)
    _check(surface, found)
    if parts == 80:
        np.testing.assert_array_equal(planar_surface(found).vertices, surface.vertices)
        assert _quality(surface).min() > 0.5 and _quality(surface).mean() > 0.97


@pytest.mark.parametrize("name", names())
def test_area_converges_to_second_order(name: str) -> None:
    found = outline(name)
    edges = found.diagonal / np.array([40, 160])
    errors = [abs(planar_surface(found, float(edge)).area / found.area - 1) for edge in edges]
    assert errors[1] < 1e-14 or math.log(errors[0] / errors[1]) / math.log(4) > 1.7 or errors[1] < 1e-5


def _polygon(points: list[list[float]]) -> Outline:
    return Outline.from_curve(straight(np.array([*points, points[0]], dtype=float)), "polygon")


@pytest.mark.parametrize(
    "found",
    [
        _polygon([[0, 0], [10, 0], [10, 0.05], [0, 0.05]]),
        _polygon([[0, 0], [10, 0.3], [10, -0.3]][::-1]),
        _polygon([[0, 0], [4, 0], [4, 1], [2.01, 1], [2, 0.02], [1.99, 1], [0, 1]]),
        _polygon([[0, 0], [1, 0], [0.05, 0.05], [0, 1]]),
        outline("letter-s").moved(np.array([1e4, -2e4])),
    ],
    ids=["strip", "spike", "slit", "boomerang", "far away"],
)
@pytest.mark.parametrize("parts", [5, 30])
def test_thin_and_hollow_outlines_are_filled(found: Outline, parts: int) -> None:
    surface = planar_surface(found, found.diagonal / parts)
    require_disk(surface)
    polygon_area = 0.5 * abs(
        float(np.cross(*(surface.vertices[np.roll(surface.boundary_loops[0], k)] for k in (0, -1)))[:, 2].sum())
    )
    np.testing.assert_allclose(surface.area, polygon_area, rtol=1e-6)
    assert surface.face_areas.min() > 0


def test_scale_does_not_matter() -> None:
    found = outline("heart")
    small, large = planar_surface(found, 0.1), planar_surface(found.scaled(1024.0), 102.4)
    np.testing.assert_array_equal(small.faces, large.faces)
    np.testing.assert_allclose(large.vertices, 1024.0 * small.vertices, rtol=1e-12, atol=1e-11)


@pytest.mark.parametrize("edge", [0.0, -1.0, math.nan, math.inf, 1e-9])
def test_senseless_edges_are_refused(edge: float) -> None:
    with pytest.raises(ParameterError, match="edge: expected more than"):
        planar_surface(outline("disc"), edge)
