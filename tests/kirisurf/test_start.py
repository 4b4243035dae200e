"""Starts: the maps by name, what is said about them, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import sample_surfaces
from kirisurf.errors import ParameterError
from kirisurf.spec import FitSpec
from kirisurf.start import Start, make_start
from tests.kirisurf.test_layout import square


def start(target: str = "vault", **options: object) -> Start:
    return make_start(sample_surfaces.load(target, resolution=24), FitSpec(target=target, **options))


def dilatation(found: Start) -> float:
    """Ratio of the stretches that the lattice undergoes when it is laid on the flat map."""
    assert found.layout is not None
    matrix = found.layout.placement.matrix @ np.linalg.inv(found.layout.regular.lattice.T)
    large, small = np.linalg.svd(matrix)[1]
    return float(large / small)


@pytest.mark.parametrize("tessellation", ["quad", "kagome", "hexagon"])
def test_maps_differ_by_what_they_keep(tessellation: str) -> None:
    """Standard and conformal keep the pattern's shape, Teichmueller's stretches it as much as proportions differ."""
    found = {
        name: start(cells=(5, 2), tessellation=tessellation, initial=name)
        for name in ("auto", "standard", "rescaled", "conformal", "teichmuller")
    }
    assert dilatation(found["standard"]) == pytest.approx(1, abs=1e-12)
    assert dilatation(found["conformal"]) == pytest.approx(1, abs=1e-12)
    layout = found["teichmuller"].layout
    assert layout is not None
    width, height = np.ptp(layout.flattening.uv, axis=0)
    across, up = layout.regular.box(layout.placement.mask)[1]
    stretch = max(width / across, height / up) / min(width / across, height / up)
    # but for the inset, which is alike for every cell
    assert dilatation(found["teichmuller"]) == pytest.approx(stretch, rel=0.03)
    assert dilatation(found["auto"]) == pytest.approx(1 if stretch > 1.25 else stretch, rel=0.03)
    for name in ("standard", "rescaled"):
        assert np.ptp(found[name].layout.way) < 1e-7
        assert f"--initial {name}" in found[name].notes[0]
    assert dilatation(found["rescaled"]) > 1.2
    assert not found["rescaled"].warnings and not found["teichmuller"].warnings


def test_the_standard_start_has_the_area_of_the_flattened_target() -> None:
    found = start(cells=(3, 3), initial="standard").layout
    assert found is not None
    extent = found.regular.box(found.placement.mask)[1]
    scale = found.placement.matrix @ np.linalg.inv(found.regular.lattice.T)
    assert np.prod(extent) * np.linalg.det(scale) == pytest.approx(found.flattening.outline.area, rel=1e-9)


def test_all_maps_agree_where_nothing_is_to_be_mapped() -> None:
    """A flat square and a square pattern: every map is the same similarity, but for the inset."""
    points = []
    for name in ("standard", "rescaled", "conformal", "teichmuller", "auto", "analytic"):
        found = make_start(square(), FitSpec(target="square", cells=(3, 3), opening=40.0, initial=name)).points
        assert np.ptp(found[:, 2]) == pytest.approx(0, abs=1e-12)
        points.append(np.ptp(found, axis=0)[:2])
    for size in points[2:]:
        np.testing.assert_allclose(size, points[1], rtol=1e-6)
    np.testing.assert_allclose(points[0], points[1], rtol=0.03)


@pytest.mark.parametrize("name", ["rescaled", "teichmuller"])
def test_maps_of_rectangles_are_refused_for_trimmed_sheets(name: str) -> None:
    with pytest.raises(ParameterError, match=f"--initial {name}: expected together with --cells"):
        start(tiles=60, initial=name)


def test_what_is_said_names_the_tessellation_and_its_range() -> None:
    assert any("a kagome sheet can stretch from 1 to 2.00" in note for note in start(tessellation="kagome").notes)
    assert any("islamic-quad pattern snaps" in note for note in start(tessellation="islamic-quad").notes)
    (warning,) = start("peaks", tessellation="hexagon", tiles=150).warnings
    assert "hexagon tiles of one size give at most 1.15" in warning
    hint = start("dome", tessellation="truncated-square", tiles=150).warnings
    assert any("trihexagonal (1 to 1.37)" in warning for warning in hint)


def test_directions_that_are_tried_follow_the_symmetry() -> None:
    for name, tried in (
        ("quad", "0, 22.5, 45 and 67.5"),
        ("kagome", "0, 15, 30 and 45"),
        ("islamic-quad", "0, 22.5, 45 and 67.5"),
        ("rotating-rectangles", "0, 45, 90 and 135"),
    ):
        assert any(tried in note for note in start("dome", tessellation=name, tiles=100).notes)
