"""The main line on the published targets, its invariances, and its refusals."""

from __future__ import annotations

from pathlib import Path

import igl
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sample_surfaces
from analysis.certificate import certify
from kirisurf.errors import LimitError, ParameterError, UnusableError
from kirisurf.pipeline import FitResult, fit_surface, require_memory
from kirisurf.spec import FitSpec
from kirisurf.status import Status
from kirisurf.surface import Surface

RIGID = ("length", "angle", "planarity", "isometry", "closure")


def mesh(name: str, resolution: int = 24) -> Surface:
    """A sample surface as a mesh alone."""
    surface = sample_surfaces.load(name, resolution=resolution)
    return Surface.from_arrays(surface.vertices, surface.faces, name)


def certificate_of(result: FitResult):
    return certify(result.fit.points, result.contracted.points, result.tessellation.tiles, result.surface)


@pytest.mark.parametrize("name", ["hypar", "paraboloid", "peaks", "peaks2", "mexicanhat", "mexicanhat2", "sphere"])
def test_published_targets_at_4x4_cells(name: str) -> None:
    result = fit_surface(sample_surfaces.load(name), FitSpec(target=name, cells=(4, 4)))
    assert result.fit.status is Status.CONVERGED
    found = certificate_of(result)
    rows = found.rows
    assert all(rows[row] <= 1e-9 for row in RIGID), rows
    assert rows["intersections"] == 0 and rows["overlap_contracted"] <= 1e-9 and rows["gap_contracted"] <= 1e-9
    assert rows["distance_rms"] <= (0.08 if name == "mexicanhat" else 0.05)
    assert rows["min_edge"] >= 0.1
    assert rows["coverage"] >= 0.85
    if not name.startswith("mexicanhat"):
        assert rows["reach_max"] <= 1.5
    assert found.passed, found.failures


@pytest.mark.parametrize("name", ["hypar", "paraboloid", "peaks"])
def test_exact_mode_puts_every_vertex_on_the_formula(name: str) -> None:
    surface = sample_surfaces.load(name)
    result = fit_surface(surface, FitSpec(target=name, cells=(4, 4), closeness="exact"))
    found = certificate_of(result)
    assert all(found.rows[row] <= 1e-9 for row in RIGID), found.rows
    on_formula, _, _ = surface.smooth.project(result.fit.points)
    assert np.linalg.norm(on_formula - result.fit.points, axis=1).max() <= 1e-9 * found.edge_length


@pytest.mark.parametrize("name", ["dome", "car_hood", "face_mask", "vault"])
def test_practical_targets_trimmed(name: str) -> None:
    result = fit_surface(sample_surfaces.load(name), FitSpec(target=name, tiles=120))
    assert result.fit.status is Status.CONVERGED
    rows = certificate_of(result).rows
    assert all(rows[row] <= 1e-9 for row in RIGID), rows
    assert rows["distance_rms"] <= 0.05 and rows["coverage"] >= 0.9


MOTIONS = {
    "large": (1e6, np.eye(3), 0.0),
    "small": (1e-6, np.eye(3), 0.0),
    "turned": (1.0, Rotation.random(random_state=1).as_matrix(), 0.0),
    "far": (1.0, np.eye(3), 1e6),
    "all": (3.7e-3, Rotation.random(random_state=3).as_matrix(), 50.0),
}


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize(("name", "size"), [("hypar", "cells"), ("paraboloid", "cells"), ("dome", "tiles")])
def test_moving_and_scaling_the_target_moves_and_scales_the_design(name: str, size: str, motion: str) -> None:
    scale, turn, far = MOTIONS[motion]
    surface = mesh(name)
    spec = FitSpec(target=name, cells=(4, 4)) if size == "cells" else FitSpec(target=name, tiles=80)
    shift = far * scale * surface.diagonal * np.array([0.7, -0.5, 0.4])
    moved = Surface.from_arrays(scale * surface.vertices @ turn.T + shift, surface.faces, name)
    first, second = fit_surface(surface, spec), fit_surface(moved, spec)
    unit = scale * first.fit.edge_length
    expected = scale * first.fit.points @ turn.T + shift
    assert np.abs(second.fit.points - expected).max() <= 1e-6 * unit
    assert np.abs(second.contracted.points - scale * first.contracted.points).max() <= 1e-6 * unit


def test_a_flat_target_gives_the_regular_pattern() -> None:
    surface = mesh("hypar")
    flat = Surface.from_arrays(surface.vertices * [1, 1, 0], surface.faces, "flat")
    result = fit_surface(flat, FitSpec(target="flat", cells=(3, 3), opening=40.0))
    assert result.fit.status is Status.CONVERGED
    assert np.abs(result.fit.points[:, 2]).max() < 1e-9
    found = certificate_of(result)
    assert found.passed, found.failures
    assert found.rows["min_edge"] > 0.9


@pytest.mark.parametrize("initial", ["conformal", "standard", "analytic", "flat"])
def test_every_start_reaches_a_certified_sheet(initial: str) -> None:
    result = fit_surface(mesh("hypar"), FitSpec(target="hypar", cells=(3, 3), initial=initial))
    assert result.fit.status is Status.CONVERGED
    assert all(certificate_of(result).rows[row] <= 1e-9 for row in RIGID)


def test_choices_are_stated_with_their_reasons() -> None:
    result = fit_surface(mesh("dome"), FitSpec(target="dome", tiles=60))
    assert any("trimmed to the outline" in note for note in result.notes)
    assert any("Opening" in note for note in result.notes)


def test_the_opening_and_orientation_asked_for_are_used() -> None:
    surface = mesh("hypar")
    openings = {}
    for opening in (30.0, 70.0):
        result = fit_surface(surface, FitSpec(target="hypar", cells=(3, 3), opening=opening))
        t = result.tessellation
        ends = result.initial[t.hinges[t.slit_ends, :3]]
        u, v = ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 1]
        cosine = (u * v).sum(axis=1) / np.linalg.norm(u, axis=1) / np.linalg.norm(v, axis=1)
        openings[opening] = np.degrees(np.median(np.arccos(cosine)))
    assert openings[30.0] == pytest.approx(30, abs=5) and openings[70.0] == pytest.approx(70, abs=8)
    turned = fit_surface(surface, FitSpec(target="hypar", tiles=60, orientation=30.0))
    assert any("turned by 30.0 degrees" in note and "as asked" in note for note in turned.notes)


def test_a_needle_asks_for_more_stretch_than_tiles_have_and_is_told() -> None:
    result = fit_surface(sample_surfaces.load("mexicanhat"), FitSpec(target="mexicanhat", tiles=100, max_steps=3))
    assert any("factor" in warning for warning in result.warnings)
    assert result.fit.status is Status.STEP_LIMIT


def test_closed_and_broken_targets_are_refused() -> None:
    tetrahedron = Surface.from_arrays(
        np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    )
    with pytest.raises(UnusableError, match="closed"):
        fit_surface(tetrahedron, FitSpec(target="t", tiles=20))


def test_a_solver_too_small_for_the_problem_is_refused() -> None:
    with pytest.raises(ParameterError, match="slsqp"):
        fit_surface(mesh("hypar"), FitSpec(target="hypar", cells=(8, 8), solver="slsqp"))


def shuffled(surface: Surface) -> Surface:
    """The same triangles: vertices renumbered, faces in another order, each begun at another corner."""
    rng = np.random.default_rng(5)
    order = rng.permutation(len(surface.vertices))
    faces = np.argsort(order)[surface.faces][rng.permutation(len(surface.faces))]
    turns = (np.arange(3) + rng.integers(3, size=len(faces))[:, None]) % 3
    return Surface.from_arrays(surface.vertices[order], np.take_along_axis(faces, turns, axis=1), surface.name)


@pytest.mark.parametrize("name", ["dome", "terrain", "peaks", "mexicanhat"])
def test_the_same_target_remeshed_or_in_another_order(name: str) -> None:
    """Same status, and distances within 5 %, whatever the triangles and their order."""
    surface = mesh(name, 40)
    found = []
    finer = Surface.from_arrays(*igl.upsample(surface.vertices, surface.faces), name)
    for same in (surface, shuffled(surface), finer):
        result = fit_surface(same, FitSpec(target=name, tiles=200))
        assert result.fit.status is Status.CONVERGED
        found.append(certify(result.fit.points, result.contracted.points, result.tessellation.tiles, surface))
    rms = [certificate.rows["distance_rms"] for certificate in found]
    np.testing.assert_allclose(rms, rms[0], rtol=0.05)


def test_a_strip_that_is_too_narrow_for_the_tiles_is_said_before() -> None:
    """A comb: a wide back, and teeth of the width of a tile."""
    x, y = np.meshgrid(np.linspace(0, 8, 81), np.linspace(0, 6, 61), indexing="ij")
    number = np.arange(x.size).reshape(x.shape)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    middle_x, middle_y = x[:-1, :-1] + 0.05, y[:-1, :-1] + 0.05
    keep = (middle_y < 2) | (np.mod(middle_x, 1.0) < 0.5)
    faces = np.concatenate([np.stack([a, b, c], -1)[keep], np.stack([a, c, d], -1)[keep]])
    used, faces = np.unique(faces, return_inverse=True)
    points = np.stack([x, y, 0.1 * np.sin(x)], -1).reshape(-1, 3)[used]
    comb = Surface.from_arrays(points, faces.reshape(-1, 3), "comb")
    result = fit_surface(comb, FitSpec(target="comb", tiles=60, max_steps=1))
    assert any("narrower than two tiles" in warning for warning in result.warnings)


def test_exact_says_why_it_does_not_succeed() -> None:
    """Every vertex of 8x8 tiles on a Mexican hat asks for more than rigid tiles can."""
    result = fit_surface(
        sample_surfaces.load("mexicanhat"), FitSpec(target="mexicanhat", cells=(4, 4), closeness="exact", max_steps=60)
    )
    assert result.fit.status is not Status.CONVERGED
    assert any("--closeness best" in warning for warning in result.warnings)


def test_a_pattern_that_does_not_fit_into_memory_is_refused_before_it_is_laid() -> None:
    with pytest.raises(LimitError, match=r"expected at most about \d+ tiles .* got 36000000; ask for fewer"):
        fit_surface(sample_surfaces.load("hypar"), FitSpec(target="hypar", cells=(3000, 3000)))


@pytest.mark.skipif(not Path("/proc/meminfo").exists(), reason="memory that holds files was not tried: Linux only")
def test_memory_that_holds_files_counts_as_free(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.sysconf", lambda name: 1)  # as where a machine has run for long
    require_memory(FitSpec(target="hypar", cells=(8, 8)))
