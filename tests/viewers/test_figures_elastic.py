"""The figure of an elastic check: its numbers are those of the table file, and it shows what differs."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from kirisurf.elastic.driven_work import DrivenWork
from kirisurf.elastic.sheet_mesh import sheet_mesh
from kirisurf.pattern import quad_pattern
from viewers.figures_elastic import DEEP_CRACK, ElasticCheck, elastic_figure


@pytest.fixture(scope="module")
def check() -> ElasticCheck:
    """Squares that turn evenly, and work that is just that of their ligaments beside a crack."""
    pattern = quad_pattern(2, 2)
    flat = np.array(pattern.contracted)
    width, thickness = 0.05, 0.02
    mesh = sheet_mesh(pattern, flat, width, 2)
    n = len(np.unique(pattern.outline))
    openings = np.repeat(np.array([0.4, 0.8])[:, None], len(mesh.ligaments), axis=1)
    work = 0.5 * DEEP_CRACK * thickness * width**2 * (openings**2).sum(axis=1)
    ends = np.stack([part * np.pad(pattern.deployed - flat, ((0, 0), (0, 1))) for part in (0.5, 1.0)])
    none = np.zeros((2, n, 3))
    found = DrivenWork(np.array([1.0, 2.0]), none, none, work, ends)
    return ElasticCheck(mesh, pattern.tiles, pattern.holes, found, openings, thickness)


def test_ligaments_beside_a_crack_lie_on_their_curve(check: ElasticCheck) -> None:
    expected = 0.5 * DEEP_CRACK * np.array([0.4, 0.8]) ** 2
    np.testing.assert_allclose(check.energies, expected, rtol=1e-9)
    np.testing.assert_allclose(replace(check, young=2.0, thickness=0.01).energies, expected, rtol=1e-9)


def test_states_begin_flat_and_end_open(check: ElasticCheck) -> None:
    pattern = quad_pattern(2, 2)
    assert not check.states[..., 2].any() and len(check.states) == 3
    np.testing.assert_allclose(check.states[0][:, :2], pattern.contracted, atol=1e-12)
    np.testing.assert_allclose(check.states[-1][:, :2], pattern.deployed, atol=1e-12)


def test_it_is_a_small_picture_that_tells_sheets_apart(check: ElasticCheck) -> None:
    drawn = elastic_figure(check, "sheet")
    assert drawn == elastic_figure(check, "sheet") and len(drawn) < 80_000
    picture = Image.open(io.BytesIO(drawn))
    assert picture.width > 2 * picture.height
    stiffer = replace(check.work, work=2 * check.work.work)
    closed = replace(check.work, vertices=0.5 * check.work.vertices)
    others = [elastic_figure(replace(check, work=work), "sheet") for work in (stiffer, closed)]
    assert len({drawn, *others}) == 3
