"""Named outlines: the published ones are those of the repository."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from kirisurf.errors import ParameterError
from kirisurf.outlines import is_published, names, outline, spline, title

PUBLISHED = ("circle", "egg", "rainbow", "anvil", "shear", "wedge", "star", "wavy", "rect")


def test_names_have_titles_and_outlines_of_sensible_size() -> None:
    assert names()[: len(PUBLISHED)] == PUBLISHED
    assert [name for name in names() if is_published(name)] == list(PUBLISHED)
    for name in names():
        assert title(name) and "\n" not in title(name)
        size = np.ptp(outline(name).box, axis=0)
        assert size.min() > 1.0 and size.max() < 4.1
        assert outline(name).units is None and outline(name).name == name


def test_unknown_names_are_refused_with_a_hint() -> None:
    for call in (outline, title, is_published):
        with pytest.raises(ParameterError, match="did you mean 'rainbow'"):
            call("rainbov")
    with pytest.raises(ParameterError, match="outlines: circle, egg"):
        outline("xyz123")


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_outlines_are_those_of_the_repository(name: str, reference: Path) -> None:
    sides = json.loads((reference / "reference" / "choi2019" / "planar_targets.json").read_text())[name]
    found = outline(name)
    for side, key in zip(found.sides, ("bottom", "right", "top", "left"), strict=True):
        expected = spline(np.array(sides[key], dtype=float))
        u = np.linspace(0, side.n_pieces, 101)
        np.testing.assert_allclose(side.points(u), expected.points(u), atol=4e-15)


@pytest.mark.parametrize("name", ["circle", "star", "wavy"])
def test_quarter_turns_leave_symmetric_outlines_as_they_are(name: str) -> None:
    found = outline(name)
    turned = found.polyline(0.1) @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    assert np.abs(found.project(turned).distances).max() < 1e-14


@pytest.mark.parametrize("name", ["egg", "rainbow", "anvil", "wedge", "rect", "heart", "disc", "ellipse"])
def test_mirrors_leave_symmetric_outlines_as_they_are(name: str) -> None:
    found = outline(name)
    assert np.abs(found.project(found.polyline(0.1) * [-1, 1]).distances).max() < 1e-14
