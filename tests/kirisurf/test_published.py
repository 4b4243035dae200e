"""The published configurations: the table against its own rules, and against the published files in place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kirisurf import outlines
from kirisurf.contracted_shape import regular_ratio
from kirisurf.formats import read_polygons
from kirisurf.motion import motion_of
from kirisurf.pattern import tile_pattern
from kirisurf.published import configurations
from kirisurf.targets import is_sample, samples
from kirisurf.trimming import rectangle_mask
from kirisurf.unit_cells.catalog import find_cell


def test_every_configuration_is_a_valid_fit_of_a_published_target() -> None:
    every = configurations()
    assert len({each.name for each in every}) == len(every) == 65
    published = {sample.name for sample in samples() if sample.published}
    for each in every:
        assert each.spec.cells == each.cells
        if each.kind == "2d":
            assert outlines.is_published(each.target)
        else:
            assert is_sample(each.target) and each.target in published


def test_the_table_names_the_published_files_and_no_other(reference: Path) -> None:
    for kind in ("2d", "3d"):
        folder = reference / "reference" / "choi2019" / kind
        files = {path.name.removesuffix("_deployed.obj") for path in folder.glob("*_deployed.obj")}
        assert {stem for each in configurations(kind) for stem in each.stems} == files


@pytest.mark.parametrize("cells", [(1, 2), (3, 4), (5, 2)])
def test_the_ratio_of_a_kagome_sheet_is_that_of_its_lower_row_widened(cells: tuple[int, int]) -> None:
    cell = find_cell("kagome")
    pattern = tile_pattern(cell, rectangle_mask(cell, motion_of(cell).adjacency, *cells))
    points = pattern.contracted
    low = points[points[:, 1] < points[:, 1].min() + 1e-9]
    published = np.ptp(low[:, 0]) / np.ptp(points[:, 1])
    assert regular_ratio(pattern) == pytest.approx(published * (1 + 1 / (4 * cells[0])))


def test_published_ratios_are_those_of_the_lower_side(reference: Path) -> None:
    checked = 0
    for each in configurations():
        if not each.contracted[0].isdigit():
            continue
        for stem in each.stems:
            path = reference / "reference" / "choi2019" / each.kind / f"{stem}_contracted.obj"
            points = read_polygons(path)[0][:, :2]
            height = np.ptp(points[:, 1])
            low = points[points[:, 1] < points[:, 1].min() + 1e-2 * height]
            assert np.ptp(low[:, 0]) / height == pytest.approx(float(each.contracted), rel=0.03)
            checked += 1
    assert checked == 23
