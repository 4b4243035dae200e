"""The holes of a sheet that is known by its two states alone, ours or another program's, with their curvature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from analysis.curvature import hole_curvature
from analysis.fields import hole_openings
from analysis.measures import measure
from analysis.patches import hole_patches
from analysis.sheet import read_sheet
from kirisurf.arrays import frozen
from kirisurf.errors import UnusableError
from kirisurf.loops import Loops
from kirisurf.surface import Surface


@dataclass(frozen=True, eq=False)
class ForeignHoles:
    """Holes with their fields.

    Attributes
    ----------
    points : (n, 3), units
        Deployed vertices of the sheet.
    holes : Loops
    fields : mapping of str to (h,)
        Named as in :class:`analysis.measures.Measures`; those that need the target only where there was one.
    """

    points: Float[np.ndarray, "n 3"]
    holes: Loops
    fields: Mapping[str, np.ndarray]


def foreign_holes(
    deployed: ArrayLike, contracted: ArrayLike, tiles: Loops, target: Surface | None = None
) -> ForeignHoles:
    """Measure the holes of a sheet from the two states of its tiles.

    Parameters
    ----------
    deployed : (n, 3), units
    contracted : (n, 2) or (n, 3), units
    tiles : Loops
    target : Surface, optional

    Raises
    ------
    UnusableError
        Where an array has a wrong shape or a number that is not finite, or no sheet has this topology.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> x, y = pattern.deployed.T
    >>> found = foreign_holes(np.c_[x, y, 0.1 * x * y], pattern.contracted, pattern.tiles)
    >>> len(found.holes), bool((found.fields["gaussian_curvature"] < 0).all())
    (9, True)
    """
    sheet = read_sheet(deployed, contracted, tiles)
    tessellation = sheet.tessellation
    if tessellation is None:
        raise UnusableError(f"holes: expected the tiles of one sheet, got others: {sheet.problem}")
    if target is not None:
        measured = measure(tessellation, sheet.points, sheet.plane, target).fields
        fields = {name: values for (where, name), values in measured.items() if where == "hole"}
        return ForeignHoles(sheet.points, tessellation.holes, MappingProxyType(fields))
    patches = hole_patches(sheet.local, tessellation)
    curvature = hole_curvature(patches)
    smallest, average = hole_openings(tessellation, sheet.local)
    fields = {
        "mean_curvature": curvature.mean,
        "gaussian_curvature": curvature.gaussian,
        "mean_curvature_averaged": curvature.mean_averaged,
        "gaussian_curvature_averaged": curvature.gaussian_averaged,
        "area": curvature.areas,
        "opening_angle": smallest,
        "opening_angle_mean": average,
    }
    found = {name: frozen(values) for name, values in fields.items()}
    found["flag"] = frozen(patches.ill_conditioned, np.int64)
    return ForeignHoles(sheet.points, tessellation.holes, MappingProxyType(found))
