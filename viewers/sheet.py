"""The sheet: all that a picture can show of one design, in both of its states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from kirisurf.arrays import checked, frozen
from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from kirisurf.surface import Surface
from viewers.fields import Field, describe_field
from viewers.framing import FROM_ABOVE, View, choose_view
from viewers.way import Way

_OF_CURVATURE = ("angle_defect", "gauss_image_area", "angle_excess")
"""Fields of curvature that are called otherwise."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """All that a picture can show of one design.

    Attributes
    ----------
    tiles, holes : Loops
    deployed : (n, 3)
    contracted : (n, 3)
        In the plane z = 0.
    target : Surface or None
    fields : mapping of (where, name) to (k,)
        where is vertex, tile or hole.
    patches : (h, k, m, 3) or None
        Points of a curved patch over every hole; rows of NaN where there is none.
    asked_stretch : (v,) or None
        Stretch that the target asks of the sheet, at the target's vertices.
    possible_stretch : (float, float) or None
        Least and most that the tessellation has to give.
    units, name : str
    way : Way or None
        Computed states between contracted and deployed.
    """

    tiles: Loops
    holes: Loops
    deployed: Float[np.ndarray, "n 3"]
    contracted: Float[np.ndarray, "n 3"]
    target: Surface | None = None
    fields: Mapping[tuple[str, str], np.ndarray] = field(default_factory=dict)
    patches: Float[np.ndarray, "h k m 3"] | None = None
    asked_stretch: Float[np.ndarray, " v"] | None = None
    possible_stretch: tuple[float, float] | None = None
    units: str = "unit"
    name: str = "design"
    way: Way | None = None

    @property
    def is_planar(self) -> bool:
        """Whether sheet and target lie in one plane z = const, so that there is no curvature to show."""
        points = self.deployed if self.target is None else np.vstack([self.deployed, self.target.vertices])
        size = np.ptp(points, axis=0) if len(points) else np.zeros(3)
        return bool(size[2] <= 1e-9 * max(size[0], size[1]))

    @property
    def colorings(self) -> tuple[tuple[str, str], ...]:
        """Fields worth looking at as (where, name): no flags, and of a planar sheet no curvatures."""
        is_planar = self.is_planar

        def says_nothing(name: str) -> bool:
            return name == "flag" or (is_planar and ("curvature" in name or name in _OF_CURVATURE))

        return tuple((where, name) for where, name in self.fields if not says_nothing(name))

    @classmethod
    def from_arrays(
        cls,
        tiles: Loops,
        holes: Loops,
        deployed: ArrayLike,
        contracted: ArrayLike,
        target: Surface | None = None,
        fields: Mapping[tuple[str, str], ArrayLike] | None = None,
        patches: ArrayLike | None = None,
        asked_stretch: ArrayLike | None = None,
        possible_stretch: tuple[float, float] | None = None,
        units: str = "unit",
        name: str = "design",
    ) -> Sheet:
        """Validate the sizes and freeze the arrays; `contracted` may be (n, 2) or (n, 3).

        Raises
        ------
        UnusableError
            Where points are not finite or the two states have different sizes.
        ParameterError
            Where a field or the asked stretch has another length than what it lies on.
        """
        space = checked(deployed, f"deployed vertices of {name}", (None, 3))
        flat = np.asarray(contracted, float)
        if flat.ndim == 2 and flat.shape[1] == 2:
            flat = np.column_stack([flat, np.zeros(len(flat))])
        flat = checked(flat, f"contracted vertices of {name}", (len(space), 3))
        lengths = {"vertex": len(space), "tile": len(tiles), "hole": len(holes)}
        known = {}
        for (where, key), values in (fields or {}).items():
            array = frozen(np.asarray(values, float).ravel())
            if lengths.get(where) != len(array):
                raise ParameterError(
                    f"field {key} on {where}: expected {lengths.get(where, 'vertex, tile or hole')} values, "
                    f"got {len(array)}"
                )
            known[where, key] = array
        grid = None if patches is None else frozen(np.asarray(patches, float))
        if grid is not None and (grid.ndim != 4 or grid.shape[0] != len(holes) or grid.shape[3] != 3):
            raise ParameterError(f"patches: expected shape ({len(holes)}, k, m, 3), got {grid.shape}")
        asked = None if asked_stretch is None else frozen(np.asarray(asked_stretch, float).ravel())
        if asked is not None and (target is None or len(asked) != len(target.vertices)):
            count = "a target" if target is None else f"{len(target.vertices)} values on its target's vertices"
            raise ParameterError(f"asked stretch: expected {count}, got {len(asked)} values")
        return cls(tiles, holes, space, flat, target, known, grid, asked, possible_stretch, units, name)

    def described(self, where: str, name: str) -> Field | None:
        """Return a field ready to color by, or None where the sheet has none of that name.

        Curvatures of flagged holes (no trustworthy patch) become NaN: they are drawn gray and do not
        stretch the range.
        """
        values = self.fields.get((where, name))
        if values is None:
            return None
        flag = self.fields.get(("hole", "flag"))
        if where == "hole" and flag is not None and "curvature" in name and not name.startswith("target"):
            values = np.where(flag == 0, values, np.nan)
        return describe_field(name, where, values, self.units)


def sheet_view(sheet: Sheet) -> View:
    """Return the line of sight for every spatial picture of a sheet: chosen from its target where it has one.

    What is planar is seen from above.
    """
    if sheet.is_planar:
        return FROM_ABOVE
    if sheet.target is not None:
        return choose_view(sheet.target)
    return choose_view(_fan(sheet))


def laid_flat(sheet: Sheet) -> np.ndarray:
    """Contracted vertices laid beside the deployed ones, (n, 3): same middle, turned to match them best.

    The sheet lies level, or stands upright where the target is looked at from the side.
    """
    middle = _middle(sheet.deployed)
    axes = sheet_view(sheet).axes
    upright = abs(axes[2, 2]) < 0.5
    plane = np.stack([axes[0], [0.0, 0.0, 1.0]]) if upright else np.eye(3)[:2]
    flat = (sheet.contracted - _middle(sheet.contracted))[:, :2]
    u, _, vt = np.linalg.svd(flat.T @ ((sheet.deployed - middle) @ plane.T))
    return frozen(flat @ (u @ vt) @ plane + middle)


def blended(contracted: Float[np.ndarray, "n 3"], deployed: Float[np.ndarray, "n 3"], share: float) -> np.ndarray:
    """Points a straight way between two states, (n, 3): for the eye, not a mechanical path.

    Parameters
    ----------
    contracted, deployed : (n, 3)
    share : float
        0 is contracted, 1 is deployed.
    """
    return frozen((1.0 - share) * contracted + share * deployed)


def _fan(sheet: Sheet) -> Surface:
    """Triangles of the tiles, only to choose a line of sight."""
    fans = [
        np.column_stack([np.repeat(group[:, 0], k - 2), group[:, 1:-1].ravel(), group[:, 2:].ravel()])
        for k, (_, group) in sheet.tiles.by_size().items()
        if k > 2
    ]
    return Surface(sheet.deployed, frozen(np.vstack(fans), np.int64), sheet.name)


def _middle(points: np.ndarray) -> np.ndarray:
    return 0.5 * (points.min(axis=0) + points.max(axis=0))
