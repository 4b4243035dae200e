"""Poses: where the sheet of a workbench lies in its two views, for every share of its deployment."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from jaxtyping import Float

from analysis.interpolation import Interpolation
from analysis.similarity import laid_on
from kirisurf.surface import Surface
from viewers.framing import View, choose_view
from viewers.sheet import Sheet, laid_flat, sheet_view
from viewers.workbench.events import Shape


@lru_cache(maxsize=4)
def target_view(target: Surface) -> View:
    """Return the line of sight to a target, the same for every fit of it: what was looked at stays where it is."""
    return choose_view(target)


@dataclass(frozen=True, eq=False)
class Poses:
    """What the two views of a sheet are made from; everything is found when it is first asked for.

    Attributes
    ----------
    sheet : Sheet
    """

    sheet: Sheet

    @cached_property
    def view(self) -> View:
        """Line of sight of both views."""
        target = self.sheet.target
        return sheet_view(self.sheet) if target is None or self.sheet.is_planar else target_view(target)

    @cached_property
    def flat(self) -> Float[np.ndarray, "n 3"]:
        """Contracted vertices, laid where the deployed ones are and turned to match them."""
        # without the target, whose faces take longer to look at than the sheet takes to lay
        return laid_flat(replace(self.sheet, target=None))

    @cached_property
    def interpolation(self) -> Interpolation:
        """States between the two."""
        return Interpolation.between(self.sheet.tiles, self.flat, self.sheet.deployed)

    def at(self, share: float) -> Float[np.ndarray, "n 3"]:
        """Vertices at a share of the deployment: on the computed path, where there is one, else interpolated."""
        if share >= 1.0:
            return self.sheet.deployed
        if self.sheet.way is not None:
            return self.sheet.way.at(share)
        return self.flat if share <= 0.0 else self.interpolation.at(share)

    def pattern(self, shape: Shape) -> Float[np.ndarray, "n 3"] | None:
        """Vertices of the regular pattern, laid on the contracted sheet; None where that is of another pattern."""
        if len(shape.flat) != len(self.flat):
            return None
        return laid_on(np.column_stack([shape.flat, np.zeros(len(shape.flat))]), self.flat)
