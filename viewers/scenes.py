"""Scenes: frozen descriptions of what is drawn, made by pure functions and tested without a window.

Window, snapshot and report draw the same scenes. Nothing is measured here: curvatures, areas and distances
arrive as named fields.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.errors import ParameterError
from kirisurf.surface import Surface
from viewers.fields import Field, describe_field, name_unit
from viewers.framing import FROM_ABOVE, View, choose_view
from viewers.items import BEHIND, LINES, Item, sheet_items, target_items
from viewers.sheet import Sheet, sheet_view

__all__ = [
    "Scene",
    "Sheet",
    "deployed_scene",
    "field_scenes",
    "holes_scene",
    "pattern_scene",
    "standard_scenes",
    "stretch_scene",
    "target_scene",
]


@dataclass(frozen=True, eq=False)
class Scene:
    """Items with the line of sight to look at them.

    Attributes
    ----------
    name, title : str
    items : tuple of Item
        Back to front.
    view : View
    frame : (k, 3)
        Points that the picture has to show; the same for scenes that stand side by side at one scale.
    units : str
        The user's unit of length, for the scale bar.
    note : str
        One line below the picture.
    """

    name: str
    title: str
    items: tuple[Item, ...]
    view: View
    frame: Float[np.ndarray, "k 3"]
    units: str = "unit"
    note: str = ""

    @property
    def field(self) -> Field | None:
        """The field that colors the scene, or None."""
        return next((item.field for item in self.items if item.field is not None), None)


def target_scene(surface: Surface, units: str = "unit", view: View | None = None) -> Scene:
    """The target surface alone, smoothly shaded, with its rim."""
    return Scene("target", "Target", target_items(surface), view or choose_view(surface), surface.vertices, units)


def pattern_scene(sheet: Sheet) -> Scene:
    """The flat, contracted cut pattern seen from above."""
    items = sheet_items(sheet, sheet.contracted, holes=False)
    width, height = np.ptp(sheet.contracted[:, :2], axis=0) if len(sheet.contracted) else (0.0, 0.0)
    note = f"{len(sheet.tiles)} tiles, {width:.4g} \u00d7 {height:.4g} {name_unit(sheet.units, height)}"
    return Scene("pattern", "Cut pattern, flat", items, FROM_ABOVE, sheet.contracted, sheet.units, note)


def deployed_scene(sheet: Sheet, view: View | None = None, coloring: tuple[str, str] | None = None) -> Scene:
    """The deployed sheet on its target; with `coloring` = (where, name), colored by a field.

    Raises
    ------
    ParameterError
        Where the sheet has no such field.
    """
    found = None if coloring is None else _field(sheet, coloring)
    behind = target_items(sheet.target, BEHIND) if sheet.target is not None else ()
    if sheet.is_planar:
        # the outline is what a planar sheet is held against: it lies on top
        behind = tuple(replace(item, layer=2 * LINES) if item.name == "rim" else item for item in behind)
    items = behind + sheet_items(sheet, sheet.deployed, found, holes=found is not None and found.where == "hole")
    where = " in its outline" if sheet.is_planar else " on the target"
    title = "Deployed" + (where if sheet.target is not None else "")
    if found is not None:
        title = found.label[:1].upper() + found.label[1:]
    name = "deployed" if found is None else f"{found.where}_{found.name}"
    return Scene(name, title, items, view or sheet_view(sheet), _frame(sheet), sheet.units)


def holes_scene(sheet: Sheet, name: str, view: View | None = None) -> Scene:
    """The deployed sheet in gray with its holes filled and colored by a hole field; no target.

    Raises
    ------
    ParameterError
        Where the sheet has no such field.
    """
    found = _field(sheet, ("hole", name))
    missing = int(np.isnan(found.values).sum())
    note = f"gray: {missing} of {len(sheet.holes)} holes without a trustworthy patch" if missing else ""
    return Scene(
        f"holes_{name}",
        f"Holes: {found.label}",
        sheet_items(sheet, sheet.deployed, found),
        view or sheet_view(sheet),
        _frame(sheet),
        sheet.units,
        note,
    )


def stretch_scene(sheet: Sheet, view: View | None = None) -> Scene:
    """The target colored by the stretch that it asks of the sheet; the color bar marks what is possible.

    Raises
    ------
    ParameterError
        Where the sheet does not know it.
    """
    if sheet.target is None or sheet.asked_stretch is None:
        raise ParameterError("asked stretch: expected a sheet with a target that knows it, got none")
    asked = sheet.asked_stretch[np.isfinite(sheet.asked_stretch)]
    marks = () if sheet.possible_stretch is None else sheet.possible_stretch
    ends = [*(np.percentile(asked, (2, 98)).tolist() if len(asked) else ()), *marks] or [1.0]
    room = 0.04 * (max(ends) - min(ends)) or 0.1
    limits = (min(ends) - room, max(ends) + room)
    found = describe_field("asked_stretch", "vertex", sheet.asked_stretch, sheet.units, limits)
    found = replace(found, marks=marks)
    note = "possible: {:.3g} to {:.3g}, between the marks".format(*marks) if marks else ""
    items = tuple(replace(item, field=found) if item.name == "target" else item for item in target_items(sheet.target))
    return Scene("asked_stretch", "Asked stretch", items, view or sheet_view(sheet), _frame(sheet), sheet.units, note)


def standard_scenes(sheet: Sheet) -> dict[str, Scene]:
    """Return the rows of the paper's Fig. 4, those that the sheet has data for, in order.

    Keys: target, pattern, deployed, mean_curvature, gaussian_curvature, asked_stretch. A planar sheet has no
    curvature to show.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> space = np.column_stack([pattern.deployed, pattern.deployed.prod(axis=1)])
    >>> list(standard_scenes(Sheet.from_arrays(pattern.tiles, pattern.holes, space, pattern.contracted)))
    ['pattern', 'deployed']
    """
    view = sheet_view(sheet)
    scenes = {}
    if sheet.target is not None:
        scenes["target"] = replace(target_scene(sheet.target, sheet.units, view), frame=_frame(sheet))
    scenes["pattern"] = pattern_scene(sheet)
    scenes["deployed"] = deployed_scene(sheet, view)
    for name in ("mean_curvature", "gaussian_curvature"):
        if ("hole", name) in sheet.fields and not sheet.is_planar:
            scenes[name] = holes_scene(sheet, name, view)
    if sheet.asked_stretch is not None:
        scenes["asked_stretch"] = stretch_scene(sheet, view)
    return scenes


def field_scenes(sheet: Sheet) -> dict[str, Scene]:
    """Return one scene for every field worth looking at (see `Sheet.colorings`), keyed where_name."""
    view = sheet_view(sheet)
    scenes = {}
    for where, name in sheet.colorings:
        make = holes_scene(sheet, name, view) if where == "hole" else deployed_scene(sheet, view, (where, name))
        scenes[f"{where}_{name}"] = make
    return scenes


def _field(sheet: Sheet, coloring: tuple[str, str]) -> Field:
    found = sheet.described(*coloring)
    if found is None:
        known = ", ".join(f"{name} ({where})" for where, name in sheet.fields) or "none"
        raise ParameterError(f"field to color by: expected one of {known}, got {coloring[1]} ({coloring[0]})")
    return found


def _frame(sheet: Sheet) -> np.ndarray:
    if sheet.target is None:
        return sheet.deployed
    return frozen(np.vstack([sheet.target.vertices, sheet.deployed]))
