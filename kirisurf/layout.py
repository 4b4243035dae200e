"""A layout: a pattern laid on a flattening with an opening that follows a planned stretch, fine or coarse."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from kirisurf.flattening import Flattening
from kirisurf.guess import lay_quads, tile_centers
from kirisurf.pattern import tile_pattern
from kirisurf.placement import Placement
from kirisurf.tessellation import Tessellation
from kirisurf.trimming import sound_mask
from kirisurf.unit_cell import quad_cell

LEAST_OPENING, MOST_OPENING = 6.0, 84.0
"""Range of the slits' opening in a start, in degrees; 0 is closed, 90 fully open."""


@dataclass(frozen=True, eq=False)
class Layout:
    """A quad pattern on a flattening.

    Attributes
    ----------
    flattening : Flattening
    placement : Placement
    log_stretch : (v,)
        Logarithm of the planned stretch (deployed over contracted length) at every vertex of the surface.
    """

    flattening: Flattening
    placement: Placement
    log_stretch: Float[np.ndarray, " v"]

    @cached_property
    def tessellation(self) -> Tessellation:
        """The pattern."""
        return tile_pattern(quad_cell(0.5), self.placement.mask)

    @cached_property
    def points(self) -> Float[np.ndarray, "n 3"]:
        """The laid pattern, in the target's units."""
        stretch = self.flattening.interpolate(self.log_stretch, tile_centers(self.tessellation, self.placement))
        least, most = np.radians(LEAST_OPENING), np.radians(MOST_OPENING)
        points = lay_quads(self.tessellation, self.placement, self.flattening, stretch, least, most)
        # tiles may be smaller than the triangles: the formula then says more than they do
        smooth = self.flattening.surface.smooth
        return points if smooth is None else smooth.project(points)[0]

    @cached_property
    def flat(self) -> Float[np.ndarray, "n 2"]:
        """Place of every vertex of the contracted lattice on the flattening."""
        return self.tessellation.contracted @ self.placement.matrix.T + self.placement.origin

    @property
    def spacing(self) -> float:
        """Side of a unit cell on the flattening: the root of its area."""
        return float(np.sqrt(abs(np.linalg.det(self.placement.matrix))))

    def coarser(self) -> Layout | None:
        """Return the layout with cells of about twice the size; None where too little of the pattern is left."""
        mask = self.placement.mask
        columns, rows = mask.shape[:2]
        if mask.all():
            size = np.array([(columns + 1) // 2, (rows + 1) // 2])
            matrix = self.placement.matrix * (np.array([columns, rows]) / size)
            coarse = np.ones((*size, 4), bool)
        else:
            matrix = 2 * self.placement.matrix
            coarse = _halved(mask)
            if coarse.sum() < 0.8 * mask.sum() / 4:
                return None
        return replace(self, placement=replace(self.placement, matrix=matrix, mask=coarse))


def _halved(mask: np.ndarray) -> np.ndarray:
    """Tiles (columns, rows, 4) of a lattice of half the resolution, each standing for the 2x2 tiles of a cell."""
    columns, rows = mask.shape[:2]
    kept = np.zeros((columns + columns % 2, rows + rows % 2), bool)
    kept[:columns, :rows] = mask.sum(axis=2) >= 2
    kept = sound_mask(kept)
    return np.stack([kept[0::2, 0::2], kept[1::2, 0::2], kept[0::2, 1::2], kept[1::2, 1::2]], axis=-1)
