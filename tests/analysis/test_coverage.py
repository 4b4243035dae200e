"""The disk embedding is a bijection, and coverage is the area that it should be."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.coverage import measure_coverage
from analysis.embedding import DiskEmbedding, is_disk
from kirisurf.closest import ClosestPoints
from kirisurf.surface import Surface


def peaks(x, y):
    return 0.5 * np.sin(np.pi * x) * np.cos(np.pi * y)


def test_embedding_flips_no_face(grid_surface):
    surface = grid_surface(lambda x, y: 3 * peaks(x, y), 25)
    points = DiskEmbedding(surface).points[surface.faces]
    u, v = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    assert (area > 0).all()
    assert area.sum() / 2 <= np.pi


def test_disks_are_told_from_other_surfaces(grid_surface):
    disk = grid_surface(n=6)
    assert is_disk(disk)
    tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    assert not is_disk(Surface.from_arrays(np.eye(4)[:, :3], tetrahedron))
    assert is_disk(Surface.from_arrays(np.eye(4)[:, :3], tetrahedron[:3]))
    two = np.concatenate([disk.faces, disk.faces + 36])
    assert not is_disk(Surface.from_arrays(np.concatenate([disk.vertices, disk.vertices + 9]), two))
    turned = disk.faces.copy()
    turned[0] = turned[0, ::-1]
    assert not is_disk(Surface.from_arrays(disk.vertices, turned))
    assert not is_disk(Surface.from_arrays(disk.vertices, np.delete(disk.faces, [20], axis=0)[:, ::-1][:-1]))


@pytest.mark.parametrize("turn", [0.0, 0.3, np.pi / 4])
@pytest.mark.parametrize("n", [4, 23])
def test_enclosed_area_of_a_polygon_on_a_plane(grid_surface, turn, n):
    surface = grid_surface(n=n)
    closest = ClosestPoints(surface)
    embedding = DiskEmbedding(surface)
    c, s = 0.6 * np.cos(turn), 0.6 * np.sin(turn)
    corners = np.array([[c, s], [-s, c], [-c, -s], [s, -c]])
    t = np.arange(400)[:, None] / 400
    loop = np.concatenate([a + t * (b - a) for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)])
    placed = embedding.place(*closest.locate(np.pad(loop, ((0, 0), (0, 1)))))
    segments = np.stack([placed, np.roll(placed, -1, axis=0)], axis=1)
    assert embedding.enclosed_fraction(segments) == pytest.approx(2 * 0.36 / 4, rel=2e-4)
    assert embedding.enclosed_fraction(segments[:, ::-1]) == pytest.approx(2 * 0.36 / 4, rel=2e-4)


def test_coverage_of_a_flat_pattern_is_its_area(flat_design, grid_surface):
    design = flat_design(3, 3, np.pi / 4)
    points = design.deployed / np.abs(design.deployed).max() * 0.9
    covered = measure_coverage(points, design.tessellation, ClosestPoints(grid_surface(n=12)))
    # fully open: a square of 6 x 6 tile diagonals less its corners, with 20 dents of a quarter diagonal squared
    # along its sides, of which half are notches (a slit that ends at the rim), and count as filled
    diagonal = 1.8 / 6
    filled = (6 * diagonal) ** 2 - 4 * diagonal**2 / 8 - 10 * diagonal**2 / 4
    outline = points[design.tessellation.outline]
    shoelace = 0.5 * np.sum(outline[:, 0] * np.roll(outline[:, 1], -1) - outline[:, 1] * np.roll(outline[:, 0], -1))
    assert shoelace == pytest.approx(filled)
    strict = (6 * 6 + 5 * 5) * diagonal**2 / 2
    assert covered.filled == pytest.approx(filled / 4, rel=1e-3)
    assert covered.strict == pytest.approx(strict / 4, rel=1e-3)


def test_sheet_beyond_the_rim_covers_everything(flat_design, grid_surface):
    design = flat_design(3, 3, 0.5)
    covered = measure_coverage(design.deployed * 2, design.tessellation, ClosestPoints(grid_surface(n=9)))
    assert covered.filled == pytest.approx(1, abs=1e-3)


def test_coverage_does_not_depend_on_frame_or_mesh(flat_design, grid_surface, rotation):
    design = flat_design(3, 3, 0.5)
    points = design.deployed * 0.4
    coarse = measure_coverage(points, design.tessellation, ClosestPoints(grid_surface(n=5)))
    fine = measure_coverage(points, design.tessellation, ClosestPoints(grid_surface(n=30)))
    assert fine.filled == pytest.approx(coarse.filled, rel=2e-3)
    assert fine.strict == pytest.approx(coarse.strict, rel=2e-3)
    surface = grid_surface(n=5)
    moved = Surface.from_arrays(1e4 * surface.vertices @ rotation.T + 7.0, surface.faces)
    again = measure_coverage(1e4 * points @ rotation.T + 7.0, design.tessellation, ClosestPoints(moved))
    assert again.filled == pytest.approx(coarse.filled, rel=1e-6)
