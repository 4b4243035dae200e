"""Coarse to fine: layouts halve, displacements carry over, and a fine sheet needs few steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sample_surfaces
from analysis.certificate import certify
from kirisurf.cascade import FEW, layouts
from kirisurf.layout import Layout
from kirisurf.pipeline import fit_surface
from kirisurf.prolongation import prolonged, vertex_roles
from kirisurf.spec import FitSpec
from kirisurf.start import make_start
from kirisurf.status import Status


def layout_of(name: str, **options: object) -> Layout:
    layout = make_start(sample_surfaces.load(name), FitSpec(target=name, **options)).layout
    assert layout is not None
    return layout


@pytest.mark.parametrize(("name", "options"), [("peaks", {"cells": (9, 6)}), ("dome", {"tiles": 700})])
def test_a_coarser_layout_covers_the_same_place_with_cells_twice_as_large(name: str, options: dict) -> None:
    fine = layout_of(name, **options)
    coarse = fine.coarser()
    assert coarse is not None
    assert coarse.spacing == pytest.approx(2 * fine.spacing, rel=0.06)
    assert coarse.tessellation.n_tiles == pytest.approx(fine.tessellation.n_tiles / 4, rel=0.15)
    reach = np.abs(np.concatenate([coarse.flat.min(0) - fine.flat.min(0), coarse.flat.max(0) - fine.flat.max(0)])).max()
    assert reach <= 1.01 * fine.spacing


def test_layouts_end_where_the_tiles_are_few() -> None:
    found = layouts(layout_of("peaks", cells=(24, 24)))
    assert [layout.tessellation.n_tiles for layout in found] == [2304, 576, 144]
    assert found[-1].tessellation.n_tiles <= FEW < found[-2].tessellation.n_tiles


def test_a_role_is_a_place_in_the_unit_cell() -> None:
    """Inside the sheet, vertices of one role are apart by whole cells, and every cell has each role once."""
    layout = layout_of("hypar", cells=(4, 4))
    roles = vertex_roles(layout.tessellation)
    for role in np.unique(roles):
        place = layout.tessellation.contracted[roles == role]
        steps = place - place[0]
        np.testing.assert_allclose(steps, np.round(steps), atol=1e-12)
        assert len(np.unique(np.round(steps), axis=0)) == len(steps)


def test_displacements_carry_over_in_the_frame_of_the_surface() -> None:
    """One displacement per role, along, across and normal, scales with the cells; on a curved surface it turns."""
    fine = layout_of("dome", tiles=700)
    coarse = fine.coarser()
    assert coarse is not None
    normal = 0.3 * np.sin(1.0 + np.arange(64.0))

    def field(layout: Layout) -> np.ndarray:
        surface = layout.flattening.surface
        face, weights, _ = layout.flattening.locate(layout.flat)
        n = np.einsum("nk,nki->ni", weights, surface.normals[surface.faces[face]])
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        return layout.spacing * normal[vertex_roles(layout.tessellation)][:, None] * n

    found = prolonged(coarse, field(coarse), fine)
    np.testing.assert_allclose(found, field(fine), atol=1e-10 * fine.spacing)


def test_a_carried_field_gets_better_with_the_cells() -> None:
    """A smooth field is carried over with an error that falls with the size of the cells."""

    def field(layout: Layout) -> np.ndarray:
        x, y = layout.points[:, 0], layout.points[:, 1]
        return layout.spacing * np.stack([np.sin(2 * x + y), np.cos(x - y), 0 * x], axis=1)

    flat = layout_of("hypar", cells=(24, 24))
    surface = replace(flat.flattening.surface, vertices=flat.flattening.surface.vertices * [1, 1, 1e-9])
    flat = replace(flat, flattening=replace(flat.flattening, surface=surface))
    errors = []
    fine = flat
    for _ in range(3):
        coarse = fine.coarser()
        assert coarse is not None
        difference = np.abs(prolonged(coarse, field(coarse), fine) - field(fine)) / fine.spacing
        errors.append(np.median(difference))
        fine = coarse
    assert errors[0] < 0.6 * errors[1] < 0.36 * errors[2]


@pytest.mark.parametrize(("name", "options"), [("peaks", {"cells": (12, 12)}), ("car_hood", {"tiles": 900})])
def test_a_fine_sheet_starts_from_a_coarse_one(name: str, options: dict) -> None:
    surface = sample_surfaces.load(name)
    result = fit_surface(surface, FitSpec(target=name, **options))
    direct = fit_surface(surface, FitSpec(target=name, **options, max_steps=120))
    assert result.fit.status is direct.fit.status is Status.CONVERGED
    assert any("from coarse to fine" in note for note in result.notes)
    assert not any("from coarse to fine" in note for note in direct.notes)
    certificates = [
        certify(r.fit.points, r.contracted.points, r.tessellation.tiles, r.surface) for r in (result, direct)
    ]
    assert all(c.passed for c in certificates)
    if name == "peaks":
        assert len(result.fit.history) < len(direct.fit.history)
    assert certificates[0].rows["distance_rms"] <= certificates[1].rows["distance_rms"]


def test_an_interrupted_coarse_solve_gives_the_start_of_the_fine_sheet() -> None:
    result = fit_surface(sample_surfaces.load("peaks"), FitSpec(target="peaks", cells=(12, 12)), None, lambda: True)
    assert result.fit.status is Status.INTERRUPTED
    assert result.tessellation.n_tiles == 576
    np.testing.assert_allclose(result.fit.points, result.initial, atol=1e-12)
