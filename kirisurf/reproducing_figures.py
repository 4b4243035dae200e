"""The designs of the paper's figures, and the law of Fig. 2c."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from kirisurf.published import LARGEST
from kirisurf.reproducing import Reproduced, Wanted, exponent
from kirisurf.spec import FitSpec

SQUARE = "rectangle:1"
_SIDES = (2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 18, 20)


def _wanted(target: str, cells: int, contracted: str, prefer: str = "smoothest") -> Wanted:
    spec = FitSpec(target=target, cells=(cells, cells), contracted=contracted, prefer=prefer)
    return Wanted(f"{target}_{cells}x{cells}", spec)


FIGURES: Mapping[str, tuple[Wanted, ...]] = MappingProxyType(
    {
        "fig1": (_wanted("circle", 4, SQUARE),),
        "fig2a": (_wanted("circle", 6, SQUARE), _wanted("egg", 6, SQUARE, "balanced")),
        "fig2b": (
            _wanted("rainbow", 6, SQUARE, "balanced"),
            _wanted("wavy", 8, "rectangle"),
            _wanted("anvil", 6, SQUARE),
            _wanted("rect", 6, "rectangle"),
        ),
        "fig3": (_wanted("circle", 4, SQUARE),),
        # negative, positive, mixed and sharply changing curvature; the last has no published rectangle
        "fig4": (
            _wanted("hypar", 6, "rectangle"),
            _wanted("paraboloid", 4, SQUARE, "balanced"),
            _wanted("peaks", 5, SQUARE, "balanced"),
            _wanted("mexicanhat2", 4, "free", "balanced"),
        ),
    }
)
"""What every figure shows, but for Fig. 2c (:func:`circling`) and for what is regular in Fig. 1."""


def circling(largest: int = LARGEST) -> tuple[Wanted, ...]:
    """Return the squares that open into the circle, up to `largest` cells a side.

    The smoothest sheet of every size is taken: those have the same shape up to their size, and only then is there
    a law. Sheets that are merely feasible close their notches unevenly, and the more so the more tiles there are.
    """
    return tuple(_wanted("circle", side, SQUARE) for side in _SIDES if side <= largest)


@dataclass(frozen=True)
class Law:
    """How the accuracy of the circled square grows with the number of tiles (Fig. 2c).

    Attributes
    ----------
    tiles : tuple of int
        Of every sheet.
    area, base, height : tuple of float
        Area of the boundary layer over that of the target; mean base and height of a gap.
    """

    tiles: tuple[int, ...]
    area: tuple[float, ...]
    base: tuple[float, ...]
    height: tuple[float, ...]

    @classmethod
    def of(cls, results: Sequence[Reproduced]) -> Law:
        """Return the law of the designs that converged, smallest first."""
        good = sorted((r for r in results if not r.shortcomings), key=lambda r: r.tiles)
        names = ("boundary_layer_area", "gap_base_mean", "gap_height_mean")
        area, base, height = (tuple(float(r.measures[name]) for r in good) for name in names)
        return cls(tuple(r.tiles for r in good), area, base, height)

    @property
    def area_exponent(self) -> float:
        """Exponent of the area in the number of tiles: -1/2 in the paper."""
        return exponent(self.tiles, self.area)

    @property
    def base_exponent(self) -> float:
        """Exponent of the base of a gap in the number of tiles along a side: -1."""
        return exponent([tiles**0.5 for tiles in self.tiles], self.base)

    @property
    def height_exponent(self) -> float:
        """Exponent of the height of a gap in the number of tiles along a side: -1."""
        return exponent([tiles**0.5 for tiles in self.tiles], self.height)
