"""What of a target does not depend on the pattern that is laid on it, computed once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from kirisurf.closest import ClosestPoints
from kirisurf.flattening import Flattening, flatten
from kirisurf.rectangle_map import map_to_rectangle, rectangle_corners
from kirisurf.surface import Surface


@dataclass(frozen=True, eq=False)
class Ground:
    """A target with its flat maps and its closest points, each made when it is first asked for.

    Attributes
    ----------
    surface : Surface
        A disk, consistently oriented.

    Raises
    ------
    UnusableError
        From the maps, where the surface cannot be flattened one to one.
    """

    surface: Surface

    @cached_property
    def flattening(self) -> Flattening:
        """The conformal map with a free outline."""
        return flatten(self.surface)

    @cached_property
    def has_corners(self) -> bool:
        """Whether the outline has four clear corners."""
        return rectangle_corners(self.flattening)[1]

    @cached_property
    def rectangle(self) -> Flattening:
        """The conformal map to a rectangle, corners to corners."""
        return map_to_rectangle(self.flattening, rectangle_corners(self.flattening)[0])

    @cached_property
    def closest(self) -> ClosestPoints:
        """Closest points of the target."""
        return ClosestPoints(self.surface)
