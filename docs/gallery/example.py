"""An example of the gallery: a sample, the fit that is made of it, and the one number that it is held against."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import kirisurf


@dataclass(frozen=True)
class Measured:
    """A number of a finished sheet beside what it has to be.

    Attributes
    ----------
    value : float
        Measured on the sheet.
    expected : float
        From the formula of the sample, without the sheet; or a law.
    tolerance : float
        By which they may differ: what the size of a tile leaves, or rounding.
    """

    value: float
    expected: float
    tolerance: float

    @property
    def is_met(self) -> bool:
        """Whether the number is within its tolerance."""
        return bool(abs(self.value - self.expected) <= self.tolerance)


@dataclass(frozen=True)
class Example:
    """A sample with its fit and its number.

    Attributes
    ----------
    name : str
        Of the sample surface or outline.
    options : mapping
        Of the fit, on top of those in the sample's spec.
    quantity, unit : str
        What is measured.
    derivation : str
        Where the expected value comes from.
    reason : str
        Why the tolerance is what it is.
    measure : callable
    """

    name: str
    options: Mapping[str, str | int | tuple[int, int]]
    quantity: str
    unit: str
    derivation: str
    reason: str
    measure: Callable[[kirisurf.Design], Measured]

    @property
    def command(self) -> str:
        """The line that makes the sheet.

        Examples
        --------
        >>> from docs.gallery.surfaces import SURFACES
        >>> SURFACES[0].command
        'kirisurf fit hypar -o runs/hypar --cells 4x4 --closeness exact'
        """
        words = [f"kirisurf fit {self.name} -o runs/{self.name}"]
        for name, value in self.options.items():
            words.append(f"--{name} {'x'.join(map(str, value)) if isinstance(value, tuple) else value}")
        return " ".join(words)

    def design(self) -> kirisurf.Design:
        """Make the sheet, as the command does."""
        return kirisurf.fit(self.name, **self.options)
