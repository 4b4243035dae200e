"""Feasibility: the stretch that a target asks for, against what a tessellation can give, before anything is solved.

A conformal map says by how much a flat sheet has to grow at every point of the target, up to one factor for the whole
sheet. A pattern of tiles of one size can grow between its closed and its open state. Where a target asks for more,
tiles of different sizes can make up for some of it, and what they cannot make up for is strain or distance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.motion import Motion, motion_of
from kirisurf.surface import Surface
from kirisurf.unit_cells.catalog import catalog

PLAY = 1.05
"""Ratio of stretches that a snapping sheet is said to give near either of its states."""

MET = 0.02
"""Part of the area that may ask for more before a target is said to ask for too much: the tips of its scale."""


@dataclass(frozen=True)
class Range:
    """The stretch that a tessellation gives.

    Attributes
    ----------
    name : str
    most : float
        Open, the geometric mean over all directions; 1 is closed.
    along, across : float
        Open, in the directions of the largest and the smallest stretch.
    snaps : bool
        Whether only the two ends are free of strain.
    """

    name: str
    most: float
    along: float
    across: float
    snaps: bool

    @classmethod
    def of(cls, motion: Motion) -> Range:
        """Return the range of a motion."""
        along, across = motion.stretches(float(motion.table[0][-1]))
        return cls(motion.cell.name, motion.most, float(along), float(across), motion.snaps)

    @property
    def ends(self) -> tuple[float, float]:
        """Least and largest stretch that a sheet can have at once while it is open."""
        return (self.most / PLAY if self.snaps else 1.0), self.most

    @property
    def is_even(self) -> bool:
        """Whether the sheet stretches alike in all directions, as conformal maps do."""
        return self.along - self.across < 1e-6

    def __str__(self) -> str:
        if not self.is_even:
            return f"{self.name} (1 to {self.along:.3g} one way and {self.across:.3g} the other)"
        return f"{self.name} (1 {'or' if self.snaps else 'to'} {self.most:.3g})"


@dataclass(frozen=True, eq=False)
class Feasibility:
    """What a target asks of a tessellation.

    Attributes
    ----------
    given : Range
    asked : (v,)
        Stretch asked for at every vertex of the target, at the size of the sheet for which the least area asks for
        what the tessellation does not give.
    outside : float
        Part of the area that does.
    spread : float
        Ratio of the stretches asked for, without the extreme 2 % of the area on either side.
    """

    given: Range
    asked: Float[np.ndarray, " v"]
    outside: float
    spread: float

    @property
    def is_met(self) -> bool:
        """Whether tiles of one size can follow the target, but for tips."""
        return self.outside <= MET

    @property
    def sentence(self) -> str:
        """Say what the target asks for and what the tessellation gives."""
        asks = f"The target asks for stretches that differ by a factor of {self.spread:.2f}"
        if self.given.snaps:
            gives = (
                f"{self.given.name} tiles of one size give nearly {self.given.most:.3g} (or 1, closed) and nothing "
                "between, since the pattern snaps"
            )
        elif not self.given.is_even:
            gives = (
                f"{self.given.name} tiles of one size give 1 to {self.given.along:.3g} one way and 1 to "
                f"{self.given.across:.3g} the other"
            )
        else:
            gives = f"{self.given.name} tiles of one size give 1 to {self.given.most:.3g}"
        end = (
            "that is enough"
            if self.is_met
            else f"that is not enough on {100 * self.outside:.0f} % of its area, even at the best size"
        )
        return f"{asks}; {gives}: {end}."

    @property
    def advice(self) -> str:
        """Say what would help; empty where nothing needs to."""
        if self.is_met:
            return ""
        names = " or ".join(str(other) for other in wide_enough(self.spread, self.given.name)[:2])
        other = f"Of the other tessellations {names} would do" if names else "No named tessellation gives that much"
        return f"{other}; a smaller part of the target, or one cut open where it asks for most, would ask for less."


def feasibility(surface: Surface, log_scale: Float[np.ndarray, " v"], given: Range) -> Feasibility:
    """Compare a target with a tessellation.

    The size of the sheet is chosen so that the largest area finds its stretch within the range: a window of fixed
    width over the logarithms of the scale; what is in it is then centered.

    Parameters
    ----------
    surface : Surface
    log_scale : (v,)
        Logarithm of length on the surface over length on a conformal flattening.
    given : Range
    """
    low, high = np.log(given.ends)
    area = np.bincount(surface.faces.ravel(), np.repeat(surface.face_areas / 3, 3), len(log_scale))
    order = np.argsort(log_scale, kind="stable")
    scale, total = log_scale[order], np.r_[0.0, np.cumsum(area[order])]
    total /= total[-1]
    slack = 1e-12
    end = np.searchsorted(scale, scale + (high - low) + slack, side="right")
    inside = total[end] - total[:-1]
    first = int(np.argmax(inside >= inside.max() - slack))
    middle = 0.5 * (scale[first] + scale[end[first] - 1])
    least, most = np.interp([0.02, 0.98], 0.5 * (total[1:] + total[:-1]), scale)
    return Feasibility(
        given=given,
        asked=frozen(np.exp(log_scale - middle + 0.5 * (low + high))),
        outside=float(max(0.0, 1 - inside[first])),
        spread=float(np.exp(most - least)),
    )


def wide_enough(spread: float, name: str) -> tuple[Range, ...]:
    """Return the other named tessellations that give a ratio of stretches, the narrowest first.

    Examples
    --------
    >>> [other.name for other in wide_enough(1.5, "quad")]
    ['kagome', 'right-triangles']
    """
    wide = [other for other in ranges() if other.is_even and not other.snaps and other.most >= spread]
    wide = [other for other in wide if other.name != name]
    return tuple(sorted(wide, key=lambda other: other.most))


@cache
def ranges() -> tuple[Range, ...]:
    """Return what the named tessellations give.

    Examples
    --------
    >>> [str(found) for found in ranges()][:2]
    ['quad (1 to 1.41)', 'kagome (1 to 2)']
    """
    return tuple(Range.of(motion_of(entry.cell())) for entry in catalog())
