"""Scenes and items are right without a window."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest

from kirisurf.errors import ParameterError, UnusableError
from viewers.fields import describe_field
from viewers.items import hole_item, segments, sheet_items
from viewers.scenes import (
    deployed_scene,
    field_scenes,
    holes_scene,
    pattern_scene,
    standard_scenes,
    stretch_scene,
    target_scene,
)
from viewers.sheet import Sheet, blended, laid_flat


def names(scene):
    return [item.name for item in scene.items]


def test_standard_scenes_are_the_rows_of_the_figure(sheet):
    scenes = standard_scenes(sheet)
    assert list(scenes) == ["target", "pattern", "deployed", "mean_curvature", "gaussian_curvature"]
    assert names(scenes["target"]) == ["target", "rim"]
    assert names(scenes["pattern"]) == ["tiles", "tile edges"]
    assert names(scenes["deployed"]) == ["target", "rim", "tiles", "tile edges"]
    assert names(scenes["mean_curvature"]) == ["tiles", "holes", "tile edges"]
    assert scenes["gaussian_curvature"].field.name == "gaussian_curvature"
    assert scenes["pattern"].field is None
    assert "36 tiles" in scenes["pattern"].note and "mm" in scenes["pattern"].note


def test_spatial_scenes_share_view_and_frame(sheet):
    scenes = standard_scenes(sheet)
    spatial = [scenes[name] for name in ("target", "deployed", "mean_curvature")]
    assert len({scene.view for scene in spatial}) == 1
    assert all(np.array_equal(scene.frame, spatial[0].frame) for scene in spatial)


def test_every_index_is_in_range_and_nothing_can_be_changed(sheet, patches):
    curved = replace(sheet, patches=patches)
    for scene in [*standard_scenes(curved).values(), *field_scenes(curved).values()]:
        with pytest.raises(FrozenInstanceError):
            scene.title = "other"
        for item in scene.items:
            assert not item.points.flags.writeable
            assert item.loops.indices.min() >= 0 and item.loops.indices.max() < len(item.points)
            if item.field is not None:
                count = len(item.points) if item.field.where == "vertex" else len(item.loops)
                assert len(item.field.values) == count


def test_without_target_and_fields_there_are_fewer_scenes(sheet):
    bare = replace(sheet, target=None, fields={})
    assert list(standard_scenes(bare)) == ["pattern", "deployed"]
    assert deployed_scene(bare).title == "Deployed"


def test_a_flat_design_is_seen_from_above(sheet):
    flat = sheet.deployed * [1.0, 1.0, 0.0]
    assert deployed_scene(replace(sheet, target=None, deployed=flat)).view.direction == (0.0, 0.0, 1.0)


def test_colored_scenes(sheet):
    assert deployed_scene(sheet, coloring=("vertex", "distance")).title == "Distance to the target"
    assert deployed_scene(sheet, coloring=("tile", "planarity")).items[2].field.name == "planarity"
    assert set(field_scenes(sheet)) == {f"{w}_{n}" for w, n in sheet.fields if n != "flag"}
    with pytest.raises(ParameterError, match=r"expected one of distance \(vertex\).*got hue \(tile\)"):
        deployed_scene(sheet, coloring=("tile", "hue"))
    with pytest.raises(ParameterError, match="got hue"):
        holes_scene(sheet, "hue")


def test_flagged_holes_are_gray_and_do_not_set_the_range(sheet):
    flag = np.zeros(len(sheet.holes))
    flag[3] = 1
    wild = sheet.fields["hole", "gaussian_curvature"].copy()
    wild[3] = 1e9
    scene = holes_scene(
        replace(sheet, fields={**sheet.fields, ("hole", "flag"): flag, ("hole", "gaussian_curvature"): wild}),
        "gaussian_curvature",
    )
    assert np.isnan(scene.field.values[3])
    assert scene.field.limits[1] < 1.0
    assert "1 of 25 holes" in scene.note


def test_curved_patches_replace_the_polygons_of_their_holes(sheet, patches):
    some = patches.copy()
    some[2] = np.nan
    values = describe_field("mean_curvature", "hole", np.arange(len(sheet.holes), dtype=float))
    item = hole_item(sheet.deployed, sheet.holes, some, values)
    assert len(item.loops) == (len(sheet.holes) - 1) * 3 * 4 + 1
    assert np.array_equal(item.field.values[:12], np.zeros(12))
    assert item.field.values[-1] == 2.0
    last = item.points[item.loops[len(item.loops) - 1]]
    assert np.array_equal(last, sheet.deployed[sheet.holes[2]])
    # Every quad of a grid is small and turns the same way: the grid is not scrambled.
    quads = item.points[item.loops.indices[: 12 * 4].reshape(12, 4)]
    normals = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0])
    assert (normals @ normals[0] > 0).all()
    assert np.allclose(np.linalg.norm(normals, axis=1).sum(), np.linalg.norm(normals[0]) * 12, rtol=0.05)


def test_patches_belong_to_the_deployed_state_alone(sheet, patches):
    curved = replace(sheet, patches=patches)
    deployed, moved = (
        {item.name: item for item in sheet_items(curved, points)}["holes"]
        for points in (sheet.deployed, sheet.deployed + 1.0)
    )
    assert len(deployed.loops) > len(sheet.holes)
    assert len(moved.loops) == len(sheet.holes)


def test_blend_joins_the_two_states(sheet):
    flat = laid_flat(sheet)
    assert np.array_equal(blended(flat, sheet.deployed, 1.0), sheet.deployed)
    assert np.array_equal(blended(flat, sheet.deployed, 0.0), flat)


def test_the_sheet_is_laid_flat_without_changing_it(sheet):
    flat = laid_flat(sheet)
    assert np.ptp(flat[:, 2]) < 1e-12
    pairs = sheet.tiles.edges
    before, after = (np.linalg.norm(p[pairs[:, 0]] - p[pairs[:, 1]], axis=1) for p in (sheet.contracted, flat))
    assert np.allclose(before, after)


@pytest.mark.parametrize("angle", [0.3, 2.0, -2.5])
def test_the_flat_sheet_turns_with_the_deployed_one(sheet, angle):
    c, s = np.cos(angle), np.sin(angle)
    turned = replace(sheet, contracted=sheet.contracted @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
    assert np.allclose(laid_flat(turned), laid_flat(sheet), atol=1e-9)


def test_wrong_sizes_are_refused(sheet):
    arguments = (sheet.tiles, sheet.holes, sheet.deployed)
    with pytest.raises(UnusableError, match="contracted vertices of thing: expected shape"):
        Sheet.from_arrays(*arguments, sheet.contracted[1:], name="thing")
    with pytest.raises(ParameterError, match="field area on tile: expected 36 values, got 3"):
        Sheet.from_arrays(*arguments, sheet.contracted, fields={("tile", "area"): np.zeros(3)})
    with pytest.raises(ParameterError, match="expected vertex, tile or hole values"):
        Sheet.from_arrays(*arguments, sheet.contracted, fields={("face", "area"): np.zeros(3)})
    with pytest.raises(ParameterError, match="patches: expected shape"):
        Sheet.from_arrays(*arguments, sheet.contracted, patches=np.zeros((2, 3, 3, 3)))


def test_segments():
    assert [list(loop) for loop in segments(np.array([[0, 1], [4, 2]]))] == [[0, 1], [4, 2]]


def test_single_scenes_have_names(sheet):
    assert target_scene(sheet.target).name == "target"
    assert pattern_scene(sheet).name == "pattern"
    assert deployed_scene(sheet).name == "deployed"
    assert holes_scene(sheet, "mean_curvature").name == "holes_mean_curvature"


def test_asked_stretch_is_a_scene_that_marks_what_is_possible(sheet):
    asked = 1.2 + 0.4 * sheet.target.vertices[:, 0]
    scenes = standard_scenes(replace(sheet, asked_stretch=asked, possible_stretch=(1.0, 2.0)))
    assert list(scenes)[-1] == "asked_stretch"
    scene = scenes["asked_stretch"]
    assert names(scene) == ["target", "rim"]
    assert np.array_equal(scene.field.values, asked)
    assert scene.field.marks == (1.0, 2.0)
    assert 0.7 < scene.field.limits[0] < 0.85 and 2.0 < scene.field.limits[1] < 2.1
    assert "1 to 2" in scene.note
    plain = stretch_scene(replace(sheet, asked_stretch=asked))
    assert plain.field.marks == () and plain.note == ""
    assert plain.field.limits[0] < plain.field.limits[1]
    with pytest.raises(ParameterError, match="asked stretch: expected a sheet with a target"):
        stretch_scene(sheet)


@pytest.mark.parametrize("asked", [np.ones(169), np.full(169, np.nan)])
def test_asked_stretch_has_a_range_whatever_it_is(sheet, asked):
    low, high = stretch_scene(replace(sheet, asked_stretch=asked)).field.limits
    assert low < high


def test_asked_stretch_has_the_length_of_the_target(sheet):
    arguments = (sheet.tiles, sheet.holes, sheet.deployed, sheet.contracted)
    known = Sheet.from_arrays(*arguments, sheet.target, asked_stretch=np.ones(169), possible_stretch=(1.0, 1.4))
    assert known.possible_stretch == (1.0, 1.4) and not known.asked_stretch.flags.writeable
    with pytest.raises(ParameterError, match="asked stretch: expected 169 values on its target's vertices, got 3"):
        Sheet.from_arrays(*arguments, sheet.target, asked_stretch=np.ones(3))
    with pytest.raises(ParameterError, match="asked stretch: expected a target, got 3 values"):
        Sheet.from_arrays(*arguments, asked_stretch=np.ones(3))


def test_a_planar_design_has_no_curvature_and_lies_under_its_outline(sheet):
    level = [1.0, 1.0, 0.0]
    target = type(sheet.target).from_arrays(sheet.target.vertices * level, sheet.target.faces)
    planar = replace(sheet, deployed=sheet.deployed * level, target=target)
    assert planar.is_planar and not sheet.is_planar and not replace(planar, target=sheet.target).is_planar
    scenes = standard_scenes(planar)
    assert list(scenes) == ["target", "pattern", "deployed"]
    assert all(scene.view.direction == (0.0, 0.0, 1.0) for scene in scenes.values())
    layers = {item.name: item.layer for item in scenes["deployed"].items}
    assert layers["rim"] > layers["tile edges"] > layers["tiles"] > layers["target"]
    assert "outline" in scenes["deployed"].title
    assert set(field_scenes(planar)) == {"vertex_distance", "tile_planarity"}
