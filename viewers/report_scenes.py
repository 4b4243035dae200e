"""The maps of a report: curvature of the holes beside that of the target, their difference, distances, residuals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from viewers.fields import Field, describe_field
from viewers.framing import View
from viewers.items import sheet_items
from viewers.scenes import Scene, deployed_scene, holes_scene
from viewers.sheet import Sheet, sheet_view

CURVATURES = ("mean_curvature", "gaussian_curvature")
RESIDUALS = (("tile", "planarity"), ("tile", "isometry"), ("vertex", "residual_ring"), ("vertex", "closure_gap"))

_SYMBOLS = {"mean_curvature": "H", "gaussian_curvature": "K"}


def curvature_range(
    fields: Mapping[tuple[str, str], np.ndarray], name: str, units: str = "unit", *, difference: bool = False
) -> Field:
    """Return a field that holds the values that a pair of curvature maps shows, with their one range.

    Parameters
    ----------
    fields : mapping of (where, name) to array
        With the holes' curvature `name` (h,), that of the target `target_NAME`, and `flag`, as far as known.
    name : str
        mean_curvature or gaussian_curvature.
    units : str
    difference : bool
        The range of the map of differences instead.

    Examples
    --------
    >>> holes, target = np.array([1.0, 2.0]), np.array([0.5, -3.0])
    >>> both = {("hole", "mean_curvature"): holes, ("hole", "target_mean_curvature"): target}
    >>> curvature_range(both, "mean_curvature").limits
    (-3.0, 3.0)
    """
    flag = fields.get(("hole", "flag"))
    hole = np.asarray(fields.get(("hole", name), np.zeros(0)), float)
    good = np.ones(len(hole), bool) if flag is None else np.asarray(flag) == 0
    if difference:
        apart = np.asarray(fields.get(("hole", f"{name}_difference"), np.zeros(0)), float)
        return describe_field(f"{name}_difference", "hole", apart[good[: len(apart)]], units)
    target = np.asarray(fields.get(("hole", f"target_{name}"), np.zeros(0)), float)
    return describe_field(name, "hole", np.concatenate([hole[good], target]), units)


def curvature_scenes(sheet: Sheet, view: View | None = None) -> dict[str, Scene]:
    """Return for mean and Gaussian curvature the maps of holes, target and difference, as far as the sheet has them.

    Holes and target share one range, so that equal colors are equal curvatures; the difference has its own. Keys:
    mean_curvature, target_mean_curvature, mean_curvature_difference, and the same for gaussian_curvature.
    """
    view = view or sheet_view(sheet)
    scenes = {}
    for name in () if sheet.is_planar else CURVATURES:
        if ("hole", name) not in sheet.fields:
            continue
        shared = curvature_range(sheet.fields, name, sheet.units)
        symbol = _SYMBOLS[name]
        for key, title in (
            (name, f"Holes: {shared.label}"),
            (f"target_{name}", f"Target: {symbol} at the same places"),
            (f"{name}_difference", f"{symbol}: holes \u2212 target"),
        ):
            if ("hole", key) not in sheet.fields:
                continue
            scene = holes_scene(sheet, key, view)
            if not key.endswith("_difference"):
                scene = ranged(scene, shared.limits, shared.range_note)
            scenes[key] = replace(scene, title=title)
    return scenes


def accuracy_scenes(sheet: Sheet, view: View | None = None) -> dict[str, Scene]:
    """Return the map of distances to the target; nothing for a planar sheet, which lies in its target."""
    if sheet.is_planar or ("vertex", "distance") not in sheet.fields:
        return {}
    return {"distance": sheet_scene(sheet, ("vertex", "distance"), view)}


def residual_scenes(sheet: Sheet, view: View | None = None) -> list[Scene]:
    """Return the maps of the residuals that are not zero everywhere, for one picture."""
    found = []
    for where, name in RESIDUALS:
        values = sheet.fields.get((where, name))
        if values is not None and np.nan_to_num(values).any():
            found.append(sheet_scene(sheet, (where, name), view))
    return found


def residence_scenes(sheet: Sheet, view: View | None = None) -> list[Scene]:
    """Return two maps at one color scale: integrated K of every tile and hole, of the target beneath and of the sheet.

    The second has the angle excess of tiles, and the curvature of the holes' cells by normals. Nothing for a planar
    sheet, or one without these fields.
    """
    names = ("target_integrated_gaussian_curvature",) * 2, ("angle_excess", "gauss_image_area")
    needed = [(where, name) for pair in names for where, name in zip(("tile", "hole"), pair, strict=True)]
    if sheet.is_planar or not all(key in sheet.fields for key in needed):
        return []
    everything = np.concatenate([sheet.fields[key] for key in needed])
    shared = describe_field("gauss_image_area", "hole", everything, sheet.units)
    scenes = []
    for (on_tiles, on_holes), title in zip(names, ("Target: K, integrated", "Sheet: K, integrated"), strict=True):
        scene = holes_scene(sheet, on_holes, view or sheet_view(sheet))
        tiles = describe_field(on_tiles, "tile", sheet.fields["tile", on_tiles], sheet.units)
        items = tuple(replace(item, field=tiles) if item.name == "tiles" else item for item in scene.items)
        colored = replace(scene, name=f"residence_{on_tiles}", title=title, items=items)
        scenes.append(ranged(colored, shared.limits, shared.range_note))
    return scenes


def sheet_scene(sheet: Sheet, coloring: tuple[str, str], view: View | None = None) -> Scene:
    """Return the deployed sheet alone, its tiles colored by a field of (where, name) and its holes gray.

    The shaded target between the tiles would pass for values.
    """
    scene = deployed_scene(sheet, view, coloring)
    return replace(scene, items=sheet_items(sheet, sheet.deployed, scene.field))


def ranged(scene: Scene, limits: tuple[float, float], note: str) -> Scene:
    """Return a scene whose color bar has the given ends, such as those of the map beside it."""
    items = tuple(
        item if item.field is None else replace(item, field=replace(item.field, limits=limits, range_note=note))
        for item in scene.items
    )
    return replace(scene, items=items)
