"""Distances both ways between a sheet and its target."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.accuracy import reach, root_mean_square, sample_uniformly, signed_distances
from kirisurf.closest import ClosestPoints


def test_samples_are_uniform_by_area(grid_surface):
    surface = grid_surface(lambda x, y: np.where(x > 0, 2 * x, 0 * x), 21)
    samples = sample_uniformly(surface, 20_000)
    # the sloping half has sqrt(5) times the area of the level one
    assert (samples[:, 0] > 0).mean() == pytest.approx(np.sqrt(5) / (1 + np.sqrt(5)), abs=2e-3)
    assert samples[samples[:, 0] < 0].mean(axis=0) == pytest.approx([-0.5, 0, 0], abs=3e-3)
    assert np.array_equal(samples, sample_uniformly(surface, 20_000))


def test_samples_have_the_moments_of_a_triangle():
    from kirisurf.surface import Surface

    triangle = Surface.from_arrays(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    x, y, _ = sample_uniformly(triangle, 20_000).T
    assert [x.mean(), y.mean()] == pytest.approx([1 / 3, 1 / 3], abs=1e-3)
    assert [np.mean(x * x), np.mean(x * y)] == pytest.approx([1 / 6, 1 / 12], abs=1e-3)
    assert min(x.min(), y.min(), (1 - x - y).min()) >= 0


@pytest.mark.parametrize("height", [0.3, -0.2])
def test_distance_is_signed_by_the_side_of_the_normals(grid_surface, height):
    points = np.array([[0.1, 0.2, height], [-0.4, 0.7, height]])
    assert signed_distances(points, ClosestPoints(grid_surface(n=4))) == pytest.approx([height, height])


def test_reach_of_a_parallel_sheet_is_the_height(flat_design, grid_surface):
    design, target = flat_design(), grid_surface(n=6, size=1.0)
    distances = reach(design.deployed + np.array([0, 0, 0.125]), design.tessellation, target)
    # tiles and holes together leave no opening over this target
    assert distances == pytest.approx(np.full(20_000, 0.125))


def test_reach_finds_what_the_sheet_misses(flat_design, grid_surface):
    design, target = flat_design(), grid_surface(n=6, size=4.0)
    distances = reach(design.deployed, design.tessellation, target)
    corner = np.linalg.norm(np.array([4.0, 4.0, 0]) - design.deployed, axis=1).min()
    assert distances.max() == pytest.approx(corner, rel=0.03)
    assert root_mean_square(distances) < distances.max()


def test_reach_of_a_closed_sheet_needs_no_hole_patches(flat_design, grid_surface):
    design = flat_design()
    closed = np.pad(design.contracted - design.contracted.mean(axis=0), ((0, 0), (0, 1)))
    assert reach(closed, design.tessellation, grid_surface(n=3)).max() <= 1e-12
