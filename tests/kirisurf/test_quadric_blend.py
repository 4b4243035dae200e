"""The smooth surface that stands for a mesh: through its vertices, near the formula, a closest-point map."""

from __future__ import annotations

import numpy as np
import pytest

import sample_surfaces
from kirisurf.pipeline import fit_surface
from kirisurf.quadric_blend import QuadricBlend
from kirisurf.spec import FitSpec
from kirisurf.status import Status
from kirisurf.surface import Surface


def mesh(name: str, resolution: int) -> Surface:
    surface = sample_surfaces.load(name, resolution=resolution)
    return Surface.from_arrays(surface.vertices, surface.faces, name)


def test_it_passes_through_the_vertices() -> None:
    surface = mesh("peaks", 16)
    foot, normals, shape = QuadricBlend(surface).project(surface.vertices)
    np.testing.assert_allclose(foot, surface.vertices, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", shape, normals), 0.0, atol=1e-9)


def test_it_comes_to_the_formula_faster_than_the_triangles_do() -> None:
    off, flat = [], []
    for resolution in (12, 24, 48):
        known = sample_surfaces.load("paraboloid", resolution=resolution)
        surface = Surface.from_arrays(known.vertices, known.faces, "paraboloid")
        middles = surface.vertices[surface.faces].mean(axis=1)
        inner = np.abs(middles[:, :2]).max(axis=1) < 0.7
        foot, _, _ = QuadricBlend(surface).project(middles[inner])
        exact, _, _ = known.smooth.project(foot)
        off.append(np.abs(foot - exact).max())
        flat.append(np.linalg.norm(known.smooth.project(middles[inner])[0] - middles[inner], axis=1).max())
    assert (np.array(off) < 0.2 * np.array(flat)).all()
    assert np.log2(off[0] / off[2]) / 2 > 2.0


def test_projecting_twice_changes_nothing_within_a_triangle() -> None:
    surface = mesh("sphere", 20)
    blend = QuadricBlend(surface)
    inner = surface.vertices[surface.faces].mean(axis=1)
    first = inner
    for _ in range(20):
        first, _, _ = blend.project(first)
    np.testing.assert_allclose(blend.project(first)[0], first, atol=1e-12)


@pytest.mark.parametrize("name", ["hypar", "peaks"])
def test_exact_fits_to_a_mesh_lie_on_it(name: str) -> None:
    surface = mesh(name, 20)
    result = fit_surface(surface, FitSpec(target=name, cells=(3, 3), closeness="exact"))
    assert result.fit.status is Status.CONVERGED
    foot, _, _ = QuadricBlend(surface).project(result.fit.points)
    assert np.linalg.norm(foot - result.fit.points, axis=1).max() <= 1e-9 * result.fit.edge_length
    assert any("Exact" in note for note in result.notes)
