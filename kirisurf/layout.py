"""A layout: a pattern laid on a flattening with an opening that follows a planned stretch, fine or coarse."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from kirisurf.coarsening import coarser_placement
from kirisurf.flattening import Flattening
from kirisurf.guess import fractions, lay_tiles, lift, tile_centers
from kirisurf.pattern import tile_pattern
from kirisurf.placement import Placement
from kirisurf.regular import Regular
from kirisurf.tessellation import Tessellation

LEAST_WAY, MOST_WAY = 1 / 15, 14 / 15
"""Parts of the way from closed to fully open that starts keep to: slits of quads open by 6 to 84 of 90 degrees."""


@dataclass(frozen=True, eq=False)
class Layout:
    """A pattern on a flattening.

    Attributes
    ----------
    flattening : Flattening
    placement : Placement
    log_stretch : (v,)
        Logarithm of the planned stretch (deployed over contracted length) at every vertex of the surface.
    regular : Regular
        The pattern, in the state whose lattice is laid.
    """

    flattening: Flattening
    placement: Placement
    log_stretch: Float[np.ndarray, " v"]
    regular: Regular

    @cached_property
    def tessellation(self) -> Tessellation:
        """The pattern's topology."""
        return tile_pattern(self.regular.motion.cell, self.placement.mask)

    @cached_property
    def centers(self) -> Float[np.ndarray, "t 2"]:
        """Flat middle of every contracted tile."""
        return tile_centers(self.tessellation, self.placement, self.regular)

    @cached_property
    def way(self) -> Float[np.ndarray, " t"]:
        """State of every tile, see :class:`kirisurf.motion.Motion`."""
        motion = self.regular.motion
        if motion.snaps:
            # between its ends the hinges do not hold
            return np.ones(len(self.centers))
        stretch = np.exp(self.flattening.interpolate(self.log_stretch, self.centers))
        return np.clip(motion.way(stretch), LEAST_WAY, MOST_WAY)

    @cached_property
    def laid(self) -> Float[np.ndarray, "n 2"]:
        """The laid pattern on the flattening."""
        return lay_tiles(self.tessellation, self.placement, self.regular, self.way)

    @cached_property
    def points(self) -> Float[np.ndarray, "n 3"]:
        """The laid pattern, in the target's units."""
        return lift(self.flattening, self.laid)

    @cached_property
    def flat(self) -> Float[np.ndarray, "n 2"]:
        """Place of every vertex of the contracted lattice on the flattening."""
        return fractions(self.tessellation, self.regular) @ self.placement.matrix.T + self.placement.origin

    @property
    def spacing(self) -> float:
        """Side of a unit cell on the flattening: the root of its area."""
        return float(np.sqrt(abs(np.linalg.det(self.placement.matrix))))

    def coarser(self) -> Layout | None:
        """Return the layout with cells of about twice the size; None where too little of the pattern is left."""
        placement = coarser_placement(self.placement, self.regular)
        return None if placement is None else replace(self, placement=placement)
