"""How a run is made: scale, sheet, hinges, kerf and thickness, and the cut pattern or solid that follows."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, no_type_check

import numpy as np

from kirisurf.contours import contours, welded_points
from kirisurf.cuts import Cuts, cuts
from kirisurf.errors import ParameterError
from kirisurf.kerf import compensated_contours
from kirisurf.runs import Run
from kirisurf.sheet import Sheet
from kirisurf.solid import Solid, solid
from kirisurf.units import checked_unit

LARGEST = "max"


# No checks of the hints: values arrive unchecked from callers, and __post_init__ is what checks them.
@no_type_check
@dataclass(frozen=True)
class Fabrication:
    """Choices of how a run is made. Lengths are those of the finished part, in the units of the target.

    Attributes
    ----------
    hinge_width : float, optional
        Material left at every hinge; by default that of the run, scaled with the pattern.
    kerf : float, optional
        Width of the cut; by default that of the run's pattern, not scaled.
    units : str, optional
        Length unit of the coordinates; by default that of the run.
    scale : float or 'max'
        Factor on all points of the pattern; max is the largest that fits the sheet.
    sheet : Sheet, optional
        Sheet that the pattern has to fit, turned by 90 degrees where needed.
    thickness, hinge_thickness, gap : float, optional
        Of the solid, as in :func:`kirisurf.solid.solid`.

    Raises
    ------
    ParameterError
        Where a value is out of its range, or does not go with the others.
    """

    hinge_width: float | None = None
    kerf: float | None = None
    units: str | None = None
    scale: float | str = 1.0
    sheet: Sheet | None = None
    thickness: float | None = None
    hinge_thickness: float | None = None
    gap: float | None = None

    def __post_init__(self) -> None:
        for name in ("hinge_width", "kerf", "thickness", "hinge_thickness", "gap"):
            if getattr(self, name) is not None:
                _check_length("--" + name.replace("_", "-"), getattr(self, name), zero=name == "kerf")
        if self.units is not None:
            checked_unit(self.units, "--units")
        if self.scale != LARGEST:
            _check_length("--scale", self.scale, hint=f" or {LARGEST}")
        elif self.sheet is None:
            raise ParameterError("--scale max: expected together with --fit-sheet, got no sheet")
        if self.hinge_width is not None and self.kerf is not None and self.kerf >= self.hinge_width:
            raise ParameterError(f"--kerf: expected less than the hinge width {self.hinge_width:g}, got {self.kerf:g}")
        for name in ("hinge_thickness", "gap"):
            if getattr(self, name) is not None and self.thickness is None:
                option = "--" + name.replace("_", "-")
                raise ParameterError(f"{option}: expected together with --thickness, got {option} alone")
        if self.hinge_thickness is not None and self.thickness is not None and self.hinge_thickness > self.thickness:
            raise ParameterError(
                f"--hinge-thickness: expected at most the thickness {self.thickness:g}, got {self.hinge_thickness:g}"
            )

    @property
    def is_scaled(self) -> bool:
        """Whether the part differs in size or place from the run's own points."""
        return self.scale != 1.0 or self.sheet is not None


@dataclass(frozen=True)
class SheetPlace:
    """Where the pattern lies on the sheet.

    Attributes
    ----------
    scale : float
    turned : bool
        Turned by 90 degrees.
    size : (width, height)
        Of what is cut, kerf included.
    """

    scale: float
    turned: bool
    size: tuple[float, float]


def cut_lines(run: Run, making: Fabrication) -> tuple[Cuts, SheetPlace]:
    """Return the cut lines of a run as they are made; on a sheet, in its middle, the sheet's corner at 0.

    Raises
    ------
    ParameterError
        Where the pattern does not fit the sheet (with the largest scale that does), or a length is wrong.
    """
    kerf = making.kerf if making.kerf is not None else float(run.result.get("kerf", 0.0))
    factor, turned, size = _placed(run, making, kerf)
    points = factor * (quarter_turned(run.contracted) if turned else run.contracted)
    lines = cuts(run.tessellation, points, _width(run, making, factor), kerf)
    if making.sheet is not None:
        low, high = lines.box
        lines = cuts(
            run.tessellation,
            points + 0.5 * (np.array(making.sheet.size) - low - high),
            _width(run, making, factor),
            kerf,
        )
    return lines, SheetPlace(factor, turned, size)


def solid_part(run: Run, making: Fabrication) -> tuple[Solid, SheetPlace]:
    """Return the run's flat sheet as a solid; raises as :func:`cut_lines` and :func:`kirisurf.solid.solid`."""
    if making.thickness is None:
        raise ParameterError("--thickness: expected a number above 0 for a solid, got none")
    factor, turned, size = _placed(run, making, 0.0)
    points = factor * (quarter_turned(run.contracted) if turned else run.contracted)
    width = _width(run, making, factor)
    made = solid(run.tessellation, points, making.thickness, width, making.hinge_thickness, making.gap)
    if made.n_pieces > 1:
        made = replace(made, warnings=(*made.warnings, f"The solid falls into {made.n_pieces} pieces."))
    return made, SheetPlace(factor, turned, size)


def quarter_turned(points: np.ndarray) -> np.ndarray:
    """Return points (n, 2) turned counter-clockwise by 90 degrees."""
    return np.stack([-points[:, 1], points[:, 0]], axis=1)


def _width(run: Run, making: Fabrication, factor: float) -> float:
    """Hinge width of the finished part."""
    return making.hinge_width if making.hinge_width is not None else factor * float(run.result["hinge_width"])


def _placed(run: Run, making: Fabrication, kerf: float) -> tuple[float, bool, tuple[float, float]]:
    """Scale, turn and size (kerf included) of the pattern on its sheet."""
    points = welded_points(run.tessellation, run.contracted)
    rim = points[contours(run.tessellation)[0]]
    unit = 1.0 if making.scale == LARGEST else float(making.scale)
    extent = _size(rim)
    # What the kerf adds does not scale: half a kerf of compensation and half a kerf of the cut on every side.
    margin = _size(compensated_contours(unit * rim, (), kerf)[0]) + kerf - unit * extent
    sheet = making.sheet
    if sheet is None:
        return unit, False, _pair(unit * extent + margin)
    largest = sheet.largest_scale(_pair(extent), _pair(margin))
    factor = largest if making.scale == LARGEST else unit
    size = factor * extent + margin
    turned = sheet.is_turned_for(_pair(size)) if factor > 0 else None
    if turned is None:
        hint = f"the largest --scale that fits is {_rounded_down(largest):g}" if largest > 0 else "no scale fits"
        raise ParameterError(
            f"--fit-sheet: expected a sheet of at least {size[0]:.6g}x{size[1]:.6g} (or turned by 90 degrees), "
            f"got {sheet.width:g}x{sheet.height:g}; {hint}"
        )
    return factor, turned, _pair(size[::-1] if turned else size)


def _size(points: np.ndarray) -> np.ndarray:
    return np.ptp(points, axis=0)


def _pair(size: np.ndarray) -> tuple[float, float]:
    return float(size[0]), float(size[1])


def _rounded_down(value: float) -> float:
    """Four digits, never more than the value: what is printed also fits."""
    digits = 3 - math.floor(math.log10(value))
    return math.floor(value * 10.0**digits) / 10.0**digits


def _check_length(option: str, value: Any, zero: bool = False, hint: str = "") -> None:
    is_number = isinstance(value, (int, float, np.floating, np.integer)) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value) or value < 0 or (value == 0 and not zero):
        raise ParameterError(f"{option}: expected a number {'from' if zero else 'above'} 0{hint}, got {value!r}")
