"""The fields that can color a sheet, as a list for people: in groups, in words, with units and one line on each."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from viewers.fields import describe_field
from viewers.workbench.state import Coloring

WHERE = {"hole": "holes", "tile": "tiles", "vertex": "vertices"}

# (title, where, names in order); what no group names comes last in the group of its place
_GROUPS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    (
        "Holes: curvature",
        "hole",
        (
            "gaussian_curvature",
            "mean_curvature",
            "principal_curvature_1",
            "principal_curvature_2",
            "gaussian_curvature_averaged",
            "mean_curvature_averaged",
        ),
    ),
    (
        "Holes: Gaussian curvature against the target's",
        "hole",
        (
            "target_gaussian_curvature",
            "gaussian_curvature_difference",
            "gaussian_curvature_from_patch",
            "gaussian_curvature_from_fit",
        ),
    ),
    (
        "Holes: mean curvature against the target's",
        "hole",
        (
            "target_mean_curvature",
            "mean_curvature_difference",
            "mean_curvature_from_patch",
            "mean_curvature_from_fit",
        ),
    ),
    (
        "Holes: integrated Gaussian curvature",
        "hole",
        (
            "integrated_gaussian_curvature",
            "target_integrated_gaussian_curvature",
            "angle_defect",
            "gauss_image_area",
            "target_integrated_gaussian_curvature_cell",
        ),
    ),
    ("Holes: size and opening", "hole", ("opening_angle", "opening_angle_mean", "area")),
    (
        "Tiles: size and shape",
        "tile",
        (
            "area",
            "size_ratio",
            "smallest_edge",
            "corner_angle_min",
            "corner_angle_max",
            "tile_angle_deviation",
            "area_magnification",
        ),
    ),
    (
        "Tiles: rigidity and curvature",
        "tile",
        ("planarity", "isometry", "angle_excess", "target_integrated_gaussian_curvature"),
    ),
    ("Vertices", "vertex", ("distance", "distance_over_edge", "opening_angle", "opening_angle_mean", "closure_gap")),
)

_EXPLAINED = {
    "gaussian_curvature": "Product of the principal curvatures of the patch through the hole, at its center: positive "
    "like a dome, negative like a saddle.",
    "mean_curvature": "Mean of the principal curvatures of the patch through the hole, at its center: positive where "
    "it bends toward the target's normal.",
    "principal_curvature_1": "The larger principal curvature of the patch, at the hole's center.",
    "principal_curvature_2": "The smaller principal curvature of the patch, at the hole's center.",
    "gaussian_curvature_averaged": "Gaussian curvature of the patch, averaged over the hole's area.",
    "mean_curvature_averaged": "Mean curvature of the patch, averaged over the hole's area.",
    "target_gaussian_curvature": "Gaussian curvature of the target beneath the hole's center.",
    "target_mean_curvature": "Mean curvature of the target beneath the hole's center.",
    "gaussian_curvature_difference": "Gaussian curvature of the hole less that of the target beneath it.",
    "mean_curvature_difference": "Mean curvature of the hole less that of the target beneath it.",
    "gaussian_curvature_from_patch": "The part of that difference that a sheet lying exactly on the target would have "
    "too: holes are too coarse to follow the target. More tiles make it smaller.",
    "mean_curvature_from_patch": "The part of that difference that a sheet lying exactly on the target would have "
    "too: holes are too coarse to follow the target. More tiles make it smaller.",
    "gaussian_curvature_from_fit": "The rest of that difference: vertices lie off the target.",
    "mean_curvature_from_fit": "The rest of that difference: vertices lie off the target.",
    "integrated_gaussian_curvature": "Gaussian curvature of the patch, integrated over the hole's area.",
    "angle_defect": "Curvature of the hole and its share of the tiles round it, from the angles at its corners "
    "(Gauss-Bonnet). Gray: holes at the rim.",
    "gauss_image_area": "Curvature of the hole and its share of the tiles round it: the area on the unit sphere that "
    "the normals of those tiles enclose.",
    "target_integrated_gaussian_curvature_cell": "Gaussian curvature of the target integrated beneath the hole and "
    "its share of the tiles round it: what the two rows before should be.",
    "angle_excess": "Curvature within the tile, from its angles: zero for a flat one.",
    "planarity": "Distance of the tile's corners from one plane, over the tile edge: zero for a rigid sheet.",
    "isometry": "Change of the tile's lengths between the two states, over the tile edge: zero for a rigid sheet.",
    "closure_gap": "Spread of the copies of a vertex when the sheet is closed: zero for one that closes.",
    "residual_ring": "Sum of the tiles' angles round a vertex, less a full turn: zero for a sheet that closes.",
    "size_ratio": "Mean edge of the tile over the median edge of all tiles.",
    "smallest_edge": "Shortest edge of the tile over the median edge of all tiles.",
    "tile_angle_deviation": "Largest change of the tile's angles from those of the regular pattern.",
    "area_magnification": "Area of the tile and its share of the holes round it, open over closed. Gray: at the rim.",
    "distance": "Height above (+) or below (\u2212) the target.",
    "distance_over_edge": "Height above (+) or below (\u2212) the target, over the median tile edge.",
    "opening_angle": "Smallest angle between the two sides of a slit there.",
    "opening_angle_mean": "Mean of the angles between the two sides of the slits there.",
}
_EXPLAINED_AT = {
    (
        "hole",
        "target_integrated_gaussian_curvature",
    ): "Gaussian curvature of the target, integrated beneath the hole.",
    (
        "tile",
        "target_integrated_gaussian_curvature",
    ): "Gaussian curvature of the target, integrated beneath the tile: the flat tile cannot have it, the rims of the "
    "holes round it do.",
}


@dataclass(frozen=True)
class FieldChoice:
    """One field to color by.

    Attributes
    ----------
    where, name : str
    label : str
        In words, as on the color bar.
    unit : str
        Empty for a ratio.
    explained : str
        One line on what it is; empty for fields that say so by their label.
    """

    where: str
    name: str
    label: str
    unit: str
    explained: str

    @property
    def words(self) -> str:
        """Label and unit, as a row of a list."""
        label = self.label[:1].upper() + self.label[1:]
        return f"{label}  ({self.unit})" if self.unit else label


@dataclass(frozen=True)
class FieldGroup:
    """Fields that are looked for together."""

    title: str
    choices: tuple[FieldChoice, ...]


def field_groups(known: Iterable[Coloring], units: str = "unit") -> tuple[FieldGroup, ...]:
    """Return fields in groups, each once, those that a reader looks for first in front.

    Parameters
    ----------
    known : iterable of (str, str)
        Where each field lies, and its name.
    units : str
        The unit of length.

    Examples
    --------
    >>> groups = field_groups([("tile", "area"), ("hole", "gaussian_curvature")], "mm")
    >>> [(group.title, [choice.words for choice in group.choices]) for group in groups]
    [('Holes: curvature', ['Gaussian curvature K  (1/mm\u00b2)']), ('Tiles: size and shape', ['Area  (mm\u00b2)'])]
    """
    left = list(dict.fromkeys(known))
    found: list[tuple[str, list[Coloring]]] = []
    for title, where, names in _GROUPS:
        listed = [(where, name) for name in names if (where, name) in left]
        left = [coloring for coloring in left if coloring not in listed]
        found.append((title, listed))
    for where in WHERE:
        place = max(k for k, group in enumerate(_GROUPS) if group[1] == where)
        found[place][1].extend(coloring for coloring in left if coloring[0] == where)
    return tuple(
        FieldGroup(title, tuple(_choice(*each, units) for each in listed)) for title, listed in found if listed
    )


def _choice(where: str, name: str, units: str) -> FieldChoice:
    # only label and unit are wanted: no range is looked for
    field = describe_field(name, where, np.zeros(0), units, (0.0, 1.0))
    explained = _EXPLAINED_AT.get((where, name), _EXPLAINED.get(name, ""))
    return FieldChoice(where, name, field.label, field.unit, explained)
