"""A small sheet to look at: the regular quad pattern lifted onto z = 0.5 x y, with fields from formulas."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.pattern import quad_pattern
from kirisurf.surface import Surface
from viewers.sheet import Sheet


def height_field(height, count: int = 13) -> Surface:
    """Mesh z = height(x, y) over [-1, 1]^2 with normals up."""
    grid = np.linspace(-1.0, 1.0, count)
    x, y = np.meshgrid(grid, grid, indexing="ij")
    number = np.arange(count * count).reshape(count, count)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    faces = np.vstack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return Surface.from_arrays(np.stack([x.ravel(), y.ravel(), height(x, y).ravel()], axis=1), faces, "hypar")


@pytest.fixture(scope="session")
def sheet() -> Sheet:
    pattern = quad_pattern(3, 3)
    low, high = pattern.deployed.min(axis=0), pattern.deployed.max(axis=0)
    flat = (pattern.deployed - 0.5 * (low + high)) * 1.8 / (high - low).max()
    deployed = np.column_stack([flat, 0.5 * flat[:, 0] * flat[:, 1]])
    x, y = np.array([flat[hole].mean(axis=0) for hole in pattern.holes]).T
    scale = 1.0 + 0.25 * (x**2 + y**2)
    fields = {
        ("vertex", "distance"): 0.01 * np.sin(7.0 * flat[:, 0]),
        ("tile", "planarity"): np.linspace(0.0, 1e-12, pattern.n_tiles),
        ("hole", "mean_curvature"): -0.125 * x * y / scale**1.5,
        ("hole", "gaussian_curvature"): -0.25 / scale**2,
        ("hole", "target_mean_curvature"): -0.125 * x * y / scale**1.5,
        ("hole", "target_gaussian_curvature"): -0.25 / scale**2 * 1.1,
        ("hole", "flag"): np.zeros(len(pattern.holes)),
    }
    target = height_field(lambda x, y: 0.5 * x * y)
    return Sheet.from_arrays(
        pattern.tiles, pattern.holes, deployed, pattern.contracted, target, fields, units="mm", name="hypar"
    )


@pytest.fixture(scope="session")
def patches(sheet: Sheet) -> np.ndarray:
    """Bilinear 4 x 5 grids over the holes, (h, 4, 5, 3)."""
    u, v = np.meshgrid(np.linspace(0, 1, 4), np.linspace(0, 1, 5), indexing="ij")
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=2)
    return np.array([weights @ sheet.deployed[hole] for hole in sheet.holes])


@pytest.fixture
def no_open_plotter():
    """Fail a test that leaves a plotter open; one that another test left is not its fault."""
    import gc

    from pyvista.plotting import plotter

    def still_open() -> set[str]:
        return {name for name, each in plotter._ALL_PLOTTERS.items() if not each._closed}

    before = still_open()
    yield
    gc.collect()
    left = still_open() - before
    assert not left, f"{len(left)} plotters were left open"
