"""Flattenings: conformal to the expected order, one to one, exact where the surface is flat."""

from __future__ import annotations

import numpy as np
import pytest

import sample_surfaces
from kirisurf.errors import UnusableError
from kirisurf.flattening import checked_flattening, flatten, signed_areas
from kirisurf.placement import main_direction, rectangle_placement, trimmed_placement
from kirisurf.rectangle_map import map_to_rectangle, rectangle_corners, turned_by_a_quarter
from kirisurf.surface import Surface


def quasi_conformal_errors(surface: Surface, uv: np.ndarray) -> np.ndarray:
    """Ratio of the singular values of every face's map, minus 1."""
    solid = surface.vertices[surface.faces]
    u, v = solid[:, 1] - solid[:, 0], solid[:, 2] - solid[:, 0]
    first = u / np.linalg.norm(u, axis=1, keepdims=True)
    second = np.cross(surface.face_normals, first)
    local = np.stack([np.stack([(a * b).sum(1) for a in (u, v)], 1) for b in (first, second)], 1)
    flat = uv[surface.faces]
    edges = np.stack([flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]], axis=2)
    values = np.linalg.svd(edges @ np.linalg.inv(local), compute_uv=False)
    return values[:, 0] / values[:, 1] - 1


@pytest.mark.parametrize("name", ["hypar", "peaks", "sphere", "car_hood", "face_mask"])
def test_the_map_becomes_conformal_with_resolution(name: str) -> None:
    errors = []
    for resolution in (16, 32, 64):
        surface = sample_surfaces.load(name, resolution=resolution)
        flat = flatten(surface)
        assert signed_areas(flat.uv, surface.faces).min() > 0
        errors.append(np.median(quasi_conformal_errors(surface, flat.uv)))
    assert errors[2] < 0.03
    assert np.log2(errors[0] / errors[2]) / 2 > 0.8


def test_the_boundary_keeps_its_length() -> None:
    surface = sample_surfaces.load("dome", resolution=40)
    flat = flatten(surface)
    loop = surface.boundary_loops[0]
    solid, plane = (np.linalg.norm(p[loop] - p[np.roll(loop, -1)], axis=1) for p in (surface.vertices, flat.uv))
    np.testing.assert_allclose(plane, solid, rtol=0.02)


def test_scale_of_a_spherical_cap_is_the_stereographic_one() -> None:
    surface = sample_surfaces.load("sphere", resolution=60)
    flat = flatten(surface)
    center = int(np.argmin(np.linalg.norm(surface.vertices - [0, 0, -1], axis=1)))
    # lengths 2 / (1 + r^2): 1 at the rim, cos^-2 of half the half-angle (30 degrees) in the middle
    assert np.exp(flat.log_scale[center]) == pytest.approx(4 / 3, rel=0.01)


def test_a_flat_disk_is_only_moved() -> None:
    surface = sample_surfaces.load("terrain", resolution=20)
    plane = Surface.from_arrays(surface.vertices * [1, 1, 0], surface.faces)
    flat = flatten(plane)
    np.testing.assert_allclose(flat.log_scale, 0.0, atol=1e-10)
    a, b = plane.vertices[:, :2] - plane.vertices[0, :2], flat.uv - flat.uv[0]
    np.testing.assert_allclose(np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1), atol=1e-9 * plane.diagonal)


def test_lifting_inverts_the_flattening_and_continues_beyond_the_rim() -> None:
    surface = sample_surfaces.load("peaks", resolution=16)
    flat = flatten(surface)
    np.testing.assert_allclose(flat.lift(flat.uv), surface.vertices, atol=1e-9)
    plane = Surface.from_arrays(surface.vertices * [1, 1, 0], surface.faces)
    flat = flatten(plane)
    center = flat.uv.mean(axis=0)
    outside = center + 1.3 * (flat.uv[plane.boundary_loops[0]] - center)
    lifted = flat.lift(outside)
    middle = flat.lift(center[None])[0]
    # the continuation of a flat surface is that plane, with its lengths
    np.testing.assert_allclose(
        np.linalg.norm(lifted - middle, axis=1), np.linalg.norm(outside - center, axis=1), rtol=1e-6
    )


def test_overturned_faces_are_smoothed_away_and_counted() -> None:
    surface = sample_surfaces.load("hypar", resolution=12)
    uv = surface.vertices[:, :2].copy()
    inner = np.setdiff1d(np.arange(len(uv)), surface.boundary_loops[0])
    uv[inner[40]] += 0.4
    repaired = checked_flattening(surface, uv, "test")
    assert repaired.n_repaired > 0
    assert signed_areas(repaired.uv, surface.faces).min() > 0


def test_an_outline_that_crosses_itself_is_refused() -> None:
    surface = sample_surfaces.load("hypar", resolution=6)
    uv = surface.vertices[:, :2].copy()
    uv[:, 0] *= uv[:, 1]
    with pytest.raises(UnusableError, match="crosses itself"):
        checked_flattening(surface, uv, "test")


@pytest.mark.parametrize(("name", "ratio"), [("hypar", 1.0), ("peaks", 1.0), ("vault", None)])
def test_rectangle_maps_are_conformal_with_the_corners_at_the_corners(name: str, ratio: float | None) -> None:
    surface = sample_surfaces.load(name, resolution=40)
    flat = flatten(surface)
    corners, found = rectangle_corners(flat)
    assert found
    rectangle = map_to_rectangle(flat, corners)
    width, height = np.ptp(rectangle.uv, axis=0)
    np.testing.assert_allclose(
        rectangle.uv[corners], [[0, 0], [width, 0], [width, height], [0, height]], atol=1e-9 * width
    )
    if ratio is not None:
        assert width / height == pytest.approx(ratio, rel=1e-3)
    assert np.median(quasi_conformal_errors(surface, rectangle.uv)) < 0.05


@pytest.mark.parametrize("name", ["hypar", "car_hood"])
def test_a_quarter_turn_gives_the_map_that_the_next_corner_gives(name: str) -> None:
    flat = flatten(sample_surfaces.load(name, resolution=16))
    corners = rectangle_corners(flat)[0]
    turned = turned_by_a_quarter(map_to_rectangle(flat, corners))
    solved = map_to_rectangle(flat, np.roll(corners, -1))
    np.testing.assert_allclose(turned.uv, solved.uv, atol=1e-9 * np.ptp(solved.uv))
    np.testing.assert_allclose(turned.log_scale, solved.log_scale, atol=1e-9)


@pytest.mark.parametrize("tiles", [40, 300, 1500])
@pytest.mark.parametrize("name", ["dome", "terrain", "saddle_roof"])
def test_trimmed_lattices_have_about_the_tiles_asked_for(name: str, tiles: int) -> None:
    placement = trimmed_placement(flatten(sample_surfaces.load(name, resolution=30)), tiles)
    assert abs(placement.n_tiles - tiles) <= max(0.06 * tiles, 6)
    assert placement.overlap > 0.8


def test_an_outline_too_narrow_is_refused() -> None:
    x = np.linspace(0, 100, 200)
    vertices = np.concatenate([np.stack([x, 0 * x + y, 0 * x], axis=1) for y in (0.0, 0.1)])
    k = np.arange(199)
    faces = np.concatenate([np.stack([k, k + 1, k + 201], 1), np.stack([k, k + 201, k + 200], 1)])
    with pytest.raises(UnusableError, match="narrow"):
        trimmed_placement(flatten(Surface.from_arrays(vertices, faces)), 20)


def test_the_direction_of_a_turned_rectangle() -> None:
    import shapely

    angle = np.radians(27)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    outline = shapely.Polygon(np.array([[0, 0], [3, 0], [3, 2], [0, 2]]) @ turn)
    assert np.sin(2 * (main_direction(outline) - angle)) == pytest.approx(0, abs=1e-12)


def test_a_rectangle_of_other_proportions_lies_in_the_middle() -> None:
    flat = flatten(sample_surfaces.load("hypar", resolution=10))
    rectangle = map_to_rectangle(flat, rectangle_corners(flat)[0])
    placement = rectangle_placement(rectangle, 4, 1)
    size = np.ptp(rectangle.uv, axis=0)
    middle = placement.matrix @ [2.0, 0.5] + placement.origin
    np.testing.assert_allclose(middle, rectangle.uv.min(axis=0) + 0.5 * size, rtol=1e-9)
    assert placement.overlap < 0.3
