"""The options of a fit as a panel shows them: labels, kinds, ranges, and how a value changes a spec."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from kirisurf.spec import CLOSENESS, DEFAULT_TILES, INITIALS, PREFERENCES, FitSpec
from kirisurf.tessellation_names import tessellation_names
from kirisurf.units import UNITS

FIRST_CELLS = (8, 8)
"""Unit cells that are taken where a trimmed pattern is exchanged for a rectangular one."""


@dataclass(frozen=True)
class Option:
    """One option of a fit.

    Attributes
    ----------
    name : str
        As in `FitSpec`.
    label, group, help : str
    kind : str
        choice, number, whole, pair or switch.
    choices : tuple of str
        Of a choice; a text beside them is allowed where `is_open` (a file).
    least, most, step : float
        Of a number.
    digits : int
        Decimals of a number.
    unit : str
    without : str
        What a number says where it has no value (auto, none); empty where it always has one.
    without_value : str or None
        The value that stands for that.
    is_open : bool
    """

    name: str
    label: str
    group: str
    kind: str
    help: str
    choices: tuple[str, ...] = ()
    least: float | int = 0.0
    most: float | int = 1e9
    step: float | int = 1.0
    digits: int = 0
    unit: str = ""
    without: str = ""
    without_value: str | None = None
    is_open: bool = False


def options() -> tuple[Option, ...]:
    """Return every option that a panel offers, in order; those of one group stand together.

    Examples
    --------
    >>> [option.name for option in options()][:4]
    ['tessellation', 'cells', 'tiles', 'orientation']
    """
    auto: dict[str, Any] = {"without": "auto", "without_value": "auto", "unit": "\N{DEGREE SIGN}"}
    none: dict[str, Any] = {"without": "none", "unit": "\N{DEGREE SIGN}"}
    contracted = ("free", "rectangle", "rectangle:1", "rectangle:1.5", "rectangle:2", "circle")
    return (
        Option("tessellation", "Tessellation", "Pattern", "choice", "Unit cell of the pattern.", tessellation_names()),
        Option("cells", "Unit cells", "Pattern", "pair", "Columns and rows, stretched to the four corners.", most=200),
        Option("tiles", "Tiles, about", "Pattern", "whole", "Trimmed to the outline.", least=4, most=40000, step=20),
        Option(
            "orientation",
            "Orientation",
            "Pattern",
            "number",
            "Of a trimmed pattern, from the long side of the outline. Or drag it: Place pattern.",
            least=-180,
            most=180,
            step=5,
            digits=1,
            **auto,
        ),
        Option("initial", "Start", "Pattern", "choice", "How the pattern is laid on the target.", INITIALS),
        Option(
            "opening",
            "Opening",
            "Pattern",
            "number",
            "Of the slits at the start: 0 closed, 90 open.",
            most=90,
            step=5,
            digits=1,
            **auto,
        ),
        Option(
            "closeness",
            "Closeness",
            "Fit",
            "choice",
            "best: as near as rigid tiles get. exact: every vertex on the target, which few targets allow.",
            CLOSENESS,
        ),
        Option("prefer", "Prefer", "Fit", "choice", "Which of the sheets that meet every bound.", PREFERENCES),
        Option(
            "contracted",
            "Flat outline",
            "Fit",
            "choice",
            "Shape of the closed sheet; needs unit cells.",
            contracted,
            is_open=True,
        ),
        Option(
            "min_angle",
            "Smallest opening",
            "Bounds",
            "number",
            "Between neighboring tiles.",
            most=90,
            step=1,
            digits=1,
            unit="\N{DEGREE SIGN}",
        ),
        Option(
            "max_opening",
            "Largest opening",
            "Bounds",
            "number",
            "Between neighboring tiles.",
            least=1,
            most=180,
            step=5,
            digits=1,
            **none,
        ),
        Option(
            "min_corner",
            "Smallest corner",
            "Bounds",
            "number",
            "Interior angle of a tile.",
            most=60,
            step=5,
            digits=1,
            **none,
        ),
        Option(
            "min_edge",
            "Smallest edge",
            "Bounds",
            "number",
            "Of a tile, over the median edge.",
            most=1,
            step=0.05,
            digits=2,
        ),
        Option("units", "Units", "Making", "choice", "Of the target's coordinates.", ("", *UNITS)),
        Option(
            "hinge_width",
            "Hinge width",
            "Making",
            "number",
            "Material left at a hinge, in units; saved files only.",
            least=1e-6,
            step=0.1,
            digits=3,
            without="4 % of an edge",
        ),
        Option(
            "kerf", "Kerf", "Making", "number", "Width of the cut, in units; saved files only.", step=0.05, digits=3
        ),
    )


def changed(spec: FitSpec, name: str, value: Any) -> FitSpec:
    """Return a spec with one option changed, and with it those that do not go together with the new value.

    Raises
    ------
    ParameterError
        Where the value is out of its range.

    Examples
    --------
    >>> spec = FitSpec(target="hypar", tiles=200, orientation=30.0)
    >>> changed(spec, "cells", (4, 4)).orientation
    'auto'
    """
    values: dict[str, Any] = {name: value}
    if name == "cells" and value is not None:
        # a rectangular pattern follows the corners of the outline
        values["orientation"] = "auto"
    if name == "tiles" and value is not None:
        values["contracted"] = "free"
        if spec.initial in ("rescaled", "teichmuller"):
            values["initial"] = "auto"
    if name == "units":
        values[name] = value or None
    return spec.changed(**values)


def is_offered(option: Option, spec: FitSpec) -> bool:
    """Whether an option means something beside the others: of unit cells and tiles only one is asked for.

    Examples
    --------
    >>> rectangular = FitSpec(target="hypar", cells=(4, 4))
    >>> [option.name for option in options() if not is_offered(option, rectangular)]
    ['tiles', 'orientation']
    """
    trimmed = {"tiles", "orientation"}
    rectangular = {"cells", "contracted"}
    return option.name not in (trimmed if spec.cells is not None else rectangular)


def with_cells(spec: FitSpec) -> FitSpec:
    """Return a spec with a rectangular pattern instead of a trimmed one."""
    return spec if spec.cells is not None else changed(spec, "cells", FIRST_CELLS)


def with_tiles(spec: FitSpec) -> FitSpec:
    """Return a spec with a trimmed pattern of about as many tiles as a rectangular one, taken as quads."""
    if spec.cells is None:
        return spec
    return changed(spec, "tiles", max(4, 4 * spec.cells[0] * spec.cells[1]) or DEFAULT_TILES)


def turned(spec: FitSpec, degrees: float) -> FitSpec:
    """Return a spec with its trimmed pattern turned; a rectangular one follows its corners and stays as it is.

    Examples
    --------
    >>> turned(FitSpec(target="hypar", tiles=200, orientation=170.0), 20.0).orientation
    -170.0
    """
    if spec.cells is not None:
        return spec
    before = 0.0 if isinstance(spec.orientation, str) else float(spec.orientation)
    return changed(spec, "orientation", round((before + degrees + 180.0) % 360.0 - 180.0, 1))


def resized(spec: FitSpec, factor: float) -> FitSpec:
    """Return a spec whose tiles are longer by a factor, so that there are fewer of them.

    Examples
    --------
    >>> resized(FitSpec(target="hypar", cells=(8, 6)), 2.0).cells
    (4, 3)
    """
    if spec.cells is not None:
        columns, rows = (max(1, round(count / factor)) for count in spec.cells)
        return changed(spec, "cells", (columns, rows))
    return changed(spec, "tiles", max(4, round((spec.tiles or DEFAULT_TILES) / factor**2)))


def in_labels(words: str) -> str:
    """Return a sentence on options of the command line with the labels of the options instead.

    Examples
    --------
    >>> in_labels("--max-opening: expected more than the smallest opening, 20, got 10")
    'Largest opening: expected more than the smallest opening, 20, got 10'
    """
    for option in options():
        words = re.sub(rf"--{option.name.replace('_', '-')}(?![\w-])", option.label, words)
    return words
