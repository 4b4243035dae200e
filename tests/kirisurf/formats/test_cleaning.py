"""Welding joins exact copies and nothing else; faces without area go without tearing the surface."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.formats.cleaning import merged_positions, surface_of
from kirisurf.formats.flat import without_flat_faces
from kirisurf.formats.polygons import Polygons
from kirisurf.gate import check_native
from kirisurf.loops import Loops
from kirisurf.surface import Surface
from kirisurf.topology import examine


def grid(n: int, height: float = 0.3) -> tuple[np.ndarray, np.ndarray]:
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    points = np.stack([x.ravel(), y.ravel(), height * (x * y).ravel()], axis=1)
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, 1:].ravel(), at[1:, :-1].ravel()
    return points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def _polygons(points: np.ndarray, faces: np.ndarray) -> Polygons:
    return Polygons(points, Loops.from_lists(faces))


@pytest.mark.parametrize("is_split", [True, False])
def test_a_soup_becomes_the_sheet_it_came_from(is_split: bool) -> None:
    points, faces = grid(9)
    soup = _polygons(points[faces.ravel()], np.arange(faces.size).reshape(-1, 3))
    surface, _ = surface_of(soup, "soup", is_split)
    assert len(surface.vertices) == len(points)
    assert np.array_equal(surface.vertices[surface.faces], points[faces])
    assert examine(surface).is_disk


def test_near_is_not_the_same() -> None:
    points, faces = grid(5)
    corners = points[faces.ravel()]
    corners[7] += np.spacing(corners[7])
    surface, _ = surface_of(_polygons(corners, np.arange(faces.size).reshape(-1, 3)), "soup", True)
    assert len(surface.vertices) == len(points) + 1


def test_merged_positions_against_the_slow_way() -> None:
    points = np.random.default_rng(0).integers(0, 3, (200, 3)).astype(float)
    points[::5] *= -0.0 + 1
    points[3] = [-0.0, 0.0, -0.0]
    points[4] = 0.0
    first, position = merged_positions(points)
    seen: dict[tuple, int] = {}
    slow = [seen.setdefault(tuple(p + 0.0), len(seen)) for p in points]
    assert position.tolist() == slow
    assert np.array_equal(points[first][position], points)


def test_a_cut_that_makes_a_sheet_is_kept_open() -> None:
    """A tube, cut along a line: both sides of the cut are in one place, and merging them would close it."""
    n, m = 16, 5
    angle = np.linspace(0, 2 * np.pi, n)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    ring[-1] = ring[0]
    points = np.concatenate([np.column_stack([ring, np.full(n, h)]) for h in np.linspace(0, 1, m)])
    at = np.arange(n * m).reshape(m, n)
    loops = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 4)
    for is_split in (True, False):
        surface, notes = surface_of(_polygons(points, loops), "tube", is_split)
        assert len(surface.vertices) == n * m and examine(surface).is_disk
        assert not is_split or notes == ("5 vertices kept apart from another in one place: a cut is there.",)


def test_a_seam_that_makes_no_difference_is_closed_for_formats_that_split() -> None:
    points, faces = grid(6)
    doubled = np.concatenate([points, points[14:16]])
    split = faces.copy()
    split[:25][split[:25] == 14] = 36
    split[:25][split[:25] == 15] = 37
    surface, notes = surface_of(_polygons(doubled, split), "seam", True)
    assert len(surface.vertices) == len(points) and examine(surface).is_disk
    assert "merged" in notes[0]


def test_quads_with_a_repeated_corner_are_triangles() -> None:
    points, faces = grid(4)
    loops = np.column_stack([faces, faces[:, 2]])
    surface, notes = surface_of(_polygons(points, loops), "quads", True)
    assert np.array_equal(surface.faces, faces) and notes == ()


def test_a_needle_and_a_cap_go_without_tearing() -> None:
    points, faces = grid(6, height=0.0)
    before = Surface.from_arrays(points, faces)
    # A cap: a new vertex in the middle of an inner edge, with a flat face between the edge and itself.
    k, edge = 7, faces[7, [0, 1]]
    middle = len(points)
    points = np.vstack([points, points[edge].mean(axis=0)])
    other = next(f for f in range(len(faces)) if f != k and set(edge) <= set(faces[f]))
    a, b, c = faces[k]
    split = np.vstack([np.delete(faces, k, axis=0), [[a, middle, c], [middle, b, c], [a, b, middle]]])
    assert set(edge) <= set(faces[other])
    cleaned, found = without_flat_faces(points, split)
    assert found == 1 and len(cleaned) == len(faces) + 2
    surface = Surface.from_arrays(points, cleaned)
    assert examine(surface).is_disk and surface.area == pytest.approx(before.area, rel=1e-14)
    assert (surface.face_normals[:, 2] > 0).all()
    check_native(points, cleaned)


def test_a_cap_at_the_rim_is_dropped() -> None:
    points = np.array([[0, 0, 0], [2, 0, 0], [1, 0, 0], [1, 1, 0]], dtype=float)
    cleaned, found = without_flat_faces(points, np.array([[0, 1, 2], [0, 2, 3], [2, 1, 3]]))
    assert found == 1 and cleaned.tolist() == [[0, 2, 3], [2, 1, 3]]
