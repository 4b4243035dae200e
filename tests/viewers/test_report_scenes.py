"""Maps of a report: equal colors are equal curvatures, signs have their colors, and what is not known is gray."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from viewers.report_scenes import (
    accuracy_scenes,
    curvature_range,
    curvature_scenes,
    ranged,
    residence_scenes,
    residual_scenes,
)
from viewers.sheet import Sheet


@pytest.fixture
def full(sheet: Sheet) -> Sheet:
    h, t, n = len(sheet.holes), len(sheet.tiles), len(sheet.deployed)
    apart = {
        ("hole", f"{name}_difference"): sheet.fields["hole", name] - sheet.fields["hole", f"target_{name}"]
        for name in ("mean_curvature", "gaussian_curvature")
    }
    more = {
        ("tile", "angle_excess"): np.full(t, 1e-15),
        ("hole", "gauss_image_area"): np.linspace(-0.2, 0.1, h),
        ("tile", "target_integrated_gaussian_curvature"): np.linspace(-0.1, 0.1, t),
        ("hole", "target_integrated_gaussian_curvature"): np.linspace(-0.1, 0.1, h),
        ("tile", "isometry"): np.zeros(t),
        ("vertex", "closure_gap"): np.linspace(0, 1e-13, n),
    }
    return replace(sheet, fields={**sheet.fields, **apart, **more})


def test_holes_and_target_share_one_symmetric_range_and_the_difference_has_its_own(full):
    scenes = curvature_scenes(full)
    assert list(scenes) == [
        form.format(name)
        for name in ("mean_curvature", "gaussian_curvature")
        for form in ("{}", "target_{}", "{}_difference")
    ]
    for name in ("mean_curvature", "gaussian_curvature"):
        holes, target, apart = (scenes[f.format(name)].field for f in ("{}", "target_{}", "{}_difference"))
        assert holes.limits == target.limits and holes.limits[0] == -holes.limits[1]
        assert holes.unit == target.unit == apart.unit and holes.signed and apart.signed
        assert apart.limits == curvature_range(full.fields, name, difference=True).limits
        assert np.array_equal(target.values, full.fields["hole", f"target_{name}"])
    assert len({scene.view for scene in scenes.values()}) == 1


def test_flagged_holes_are_gray_and_do_not_set_the_range(full):
    flag = np.zeros(len(full.holes))
    flag[3] = 1
    wild = full.fields["hole", "gaussian_curvature"].copy()
    wild[3] = 1e9
    fields = {**full.fields, ("hole", "flag"): flag, ("hole", "gaussian_curvature"): wild}
    scenes = curvature_scenes(replace(full, fields=fields))
    assert np.isnan(scenes["gaussian_curvature"].field.values[3])
    assert np.isnan(scenes["gaussian_curvature_difference"].field.values[3])
    assert scenes["gaussian_curvature"].field.limits[1] < 1.0
    assert "1 of 25 holes" in scenes["gaussian_curvature"].note


def test_what_a_sheet_does_not_know_has_no_map(sheet, full):
    assert list(curvature_scenes(sheet)) == [
        "mean_curvature",
        "target_mean_curvature",
        "gaussian_curvature",
        "target_gaussian_curvature",
    ]
    assert residence_scenes(sheet) == [] and len(residence_scenes(full)) == 2
    bare = replace(sheet, fields={})
    assert curvature_scenes(bare) == {} and accuracy_scenes(bare) == {} and residual_scenes(bare) == []


def test_residuals_that_are_zero_everywhere_are_left_out(full):
    names = [scene.field.name for scene in residual_scenes(full)]
    assert names == ["planarity", "closure_gap"]


def test_residence_is_colored_on_tiles_and_holes_at_one_scale(full):
    for scene, (on_tiles, on_holes) in zip(
        residence_scenes(full),
        (("target_integrated_gaussian_curvature",) * 2, ("angle_excess", "gauss_image_area")),
        strict=True,
    ):
        items = {item.name: item for item in scene.items}
        assert items["tiles"].field.name == on_tiles and items["holes"].field.name == on_holes
        assert items["tiles"].field.limits == items["holes"].field.limits
        assert np.array_equal(items["tiles"].field.values, full.fields["tile", on_tiles])


def test_the_distance_lies_on_the_sheet_alone(full):
    scene = accuracy_scenes(full)["distance"]
    assert [item.name for item in scene.items] == ["tiles", "holes", "tile edges"]
    assert scene.field.name == "distance" and scene.field.signed


def test_a_planar_sheet_has_residuals_and_no_curvature(full):
    level = [1.0, 1.0, 0.0]
    target = type(full.target).from_arrays(full.target.vertices * level, full.target.faces)
    planar = replace(full, deployed=full.deployed * level, target=target)
    assert curvature_scenes(planar) == {} and accuracy_scenes(planar) == {} and residence_scenes(planar) == []
    assert len(residual_scenes(planar)) == 2


def test_a_given_range_changes_nothing_else(full):
    scene = curvature_scenes(full)["mean_curvature"]
    wide = ranged(scene, (-9.0, 9.0), "as beside")
    assert wide.field.limits == (-9.0, 9.0) and wide.field.range_note == "as beside"
    assert wide.field.values is scene.field.values and wide.view == scene.view
    assert [item.name for item in wide.items] == [item.name for item in scene.items]
