"""The sheet that is cut: does the pattern fit, turned by 90 degrees where needed, and how large may it be?"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import no_type_check

from kirisurf.errors import ParameterError

_ROUNDING = 1e-9


# No checks of the hints: sides arrive unchecked from callers, and __post_init__ is what checks them.
@no_type_check
@dataclass(frozen=True)
class Sheet:
    """A rectangle of material, in the units of the pattern.

    Attributes
    ----------
    width, height : float
    """

    width: float
    height: float

    def __post_init__(self) -> None:
        for side in (self.width, self.height):
            if not (isinstance(side, (int, float)) and math.isfinite(side) and side > 0):
                raise ParameterError(
                    f"--fit-sheet: expected WxH with sides above 0, got {self.width:g}x{self.height:g}"
                )

    @classmethod
    def parse(cls, text: str) -> Sheet:
        """Return the sheet of text such as 300x200.

        Raises
        ------
        ParameterError
            Where the text has another form.

        Examples
        --------
        >>> Sheet.parse("300x200")
        Sheet(width=300.0, height=200.0)
        """
        number = r"\s*([0-9.]+(?:[eE][+-]?[0-9]+)?)\s*"
        match = re.fullmatch(rf"{number}[xX×]{number}", text)
        try:
            if match is None:
                raise ValueError
            width, height = float(match[1]), float(match[2])
        except ValueError:
            raise ParameterError(f"--fit-sheet: expected WxH such as 300x200, got {text!r}") from None
        return cls(width, height)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height."""
        return self.width, self.height

    def is_turned_for(self, extent: Sequence[float]) -> bool | None:
        """Return whether a pattern of this extent (2,) fits only turned by 90 degrees; None where it never fits."""
        for turned in (False, True):
            if all(e <= s * (1 + _ROUNDING) for e, s in zip(_turned(extent, turned), self.size, strict=True)):
                return turned
        return None

    def largest_scale(self, extent: Sequence[float], margin: Sequence[float] = (0.0, 0.0)) -> float:
        """Return the largest factor on `extent` that fits with a `margin` (both (2,)) that does not scale.

        The margin is what the kerf adds to the extent. Zero where not even the margin fits.
        """
        return max(
            max(
                0.0, min((s - m) / e for s, e, m in zip(self.size, _turned(extent, t), _turned(margin, t), strict=True))
            )
            for t in (False, True)
        )


def _turned(pair: Sequence[float], turned: bool) -> tuple[float, float]:
    return (pair[1], pair[0]) if turned else (pair[0], pair[1])
