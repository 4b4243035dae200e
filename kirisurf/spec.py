"""The spec of a fit: every input of a run, checked once, and its exact round trip through TOML."""

from __future__ import annotations

import difflib
import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, no_type_check

from kirisurf.errors import ParameterError, UnreadableError
from kirisurf.naming import is_file_name
from kirisurf.tessellation_names import tessellation_names
from kirisurf.units import UNITS

CLOSENESS = ("best", "exact")
INITIALS = ("auto", "standard", "rescaled", "conformal", "teichmuller", "analytic", "flat")
SOLVERS = ("auto", "newton", "slsqp", "trust-constr", "ipopt", "uno")
DEFAULT_TILES = 300
RECTANGLE = "rectangle"
LEAST_TOLERANCE = 1e-12
"""What double precision lets a certificate of several hundred tiles promise."""

PREFERENCES = ("balanced", "smoothest", "nearest", "curvature", "open", "uniform")
"""Secondary objectives, which choose among the sheets that meet every row."""


# No checks of the hints: values arrive unchecked from TOML and callers, and __post_init__ is what checks them.
@no_type_check
@dataclass(frozen=True)
class FitSpec:
    """Every input of a fit.

    Attributes
    ----------
    target : str
        Path of a mesh file or of a planar outline (SVG, DXF, CSV), or the name of a sample surface or outline.
    tessellation : str
        A name of the catalog (:mod:`kirisurf.unit_cells.catalog`), or the file of a unit cell.
    cells : (int, int) or None
        Columns and rows of unit cells: 4x4 quad cells are 8x8 tiles. Excludes `tiles`.
    tiles : int or None
        About this many tiles, trimmed to the outline. Where neither is given: `DEFAULT_TILES`.
    closeness : str
        best: rigid rows exact, distance to the target minimized. exact: every vertex on the target.
    initial : str
        Start of the solve, one of `INITIALS`.
    contracted : str
        Shape of the flat sheet: free, rectangle, rectangle:RATIO (width over height), or the file or name of a
        closed planar outline, whose size is free.
    solver : str
        One of `SOLVERS`.
    tolerance : float
        Largest rigid row of the certificate (dimensionless: lengths over the tile edge, radians).
    max_seconds : float or None
        Limit of the solve in seconds; the best point so far is saved.
    max_steps : int or None
        Limit of the solver's steps; None leaves it to the solver.
    repair : bool
        Repair the target first (in a child process).
    remesh : bool
        Remesh the target first (in a child process).
    remesh_edge : float or None
        Edge length of the remeshed target, in its units; None chooses it from the tile size.
    min_edge : float
        Smallest tile edge over the median tile edge.
    min_angle : float
        Smallest opening between neighboring tiles, in degrees.
    max_opening : float or None
        Largest opening between neighboring tiles, in degrees; None leaves it free.
    min_corner : float or None
        Smallest interior angle of a tile, in degrees; None leaves it free.
    prefer : str
        Which of the sheets that meet every row is wanted, one of `PREFERENCES`: smoothest (neighboring tiles alike),
        nearest (the outer vertices near the target's outline, or all near the surface), curvature (holes curved as
        the target is), open (slits as wide as in the open regular pattern), uniform (tiles of one size), or a balance.
    hinge_width : float or None
        Material left at every hinge of the cut pattern, in the target's units; None is 4 % of the
        median contracted tile edge.
    kerf : float
        Width of the cut, in the target's units, less than the hinge width; the cut pattern is compensated
        for it (see :mod:`kirisurf.kerf`).
    units : str or None
        Length unit of the target's coordinates, one of `UNITS`; None is taken as mm, and said.
    opening : float or 'auto'
        Opening of the slits in the start, in degrees: 0 closed, 90 fully open (quad).
    orientation : float or 'auto'
        Rotation of the pattern on the flattened target, in degrees.

    Raises
    ------
    ParameterError
        Where a value is out of its range.
    UnreadableError
        Where the path of a file is no UTF-8.

    Examples
    --------
    >>> FitSpec(target="hypar", cells=(4, 4)).tiles is None
    True
    """

    target: str
    tessellation: str = "quad"
    cells: tuple[int, int] | None = None
    tiles: int | None = None
    closeness: str = "best"
    initial: str = "auto"
    contracted: str = "free"
    solver: str = "auto"
    tolerance: float = 1e-9
    max_seconds: float | None = None
    max_steps: int | None = None
    repair: bool = False
    remesh: bool = False
    remesh_edge: float | None = None
    min_edge: float = 0.1
    min_angle: float = 3.0
    max_opening: float | None = None
    min_corner: float | None = None
    prefer: str = "balanced"
    hinge_width: float | None = None
    kerf: float = 0.0
    units: str | None = None
    opening: float | str = "auto"
    orientation: float | str = "auto"

    def __post_init__(self) -> None:
        if not isinstance(self.target, str) or not self.target.strip():
            raise ParameterError(f"target: expected a mesh file or the name of a sample surface, got {self.target!r}")
        if "\0" in self.target:
            raise ParameterError("target: expected a path without NUL characters, got one with")
        for name in ("target", "tessellation", "contracted"):
            _check_can_be_written(name, getattr(self, name))
        choices = {"closeness": CLOSENESS, "initial": INITIALS, "solver": SOLVERS, "prefer": PREFERENCES}
        for name, allowed in choices.items():
            _check_choice(name, getattr(self, name), allowed)
        self._check_tessellation()
        object.__setattr__(self, "contracted", _checked_contracted(self.contracted))
        self._check_numbers()
        if self.units is not None:
            _check_choice("units", self.units, UNITS)

    def _check_tessellation(self) -> None:
        if not isinstance(self.tessellation, str) or not is_file_name(self.tessellation):
            _check_choice("tessellation", self.tessellation, tessellation_names(), " or a file")
        if self.cells is not None and self.tiles is not None:
            raise ParameterError(f"--cells and --tiles: expected one of them, got both ({self.cells}, {self.tiles})")
        if self.cells is not None:
            object.__setattr__(self, "cells", _checked_cells(self.cells))
        else:
            tiles = DEFAULT_TILES if self.tiles is None else self.tiles
            object.__setattr__(self, "tiles", _checked_integer("tiles", tiles, 4, 10**7))

    def _check_numbers(self) -> None:
        def store(name: str, low: float, high: float, allowed: Any = None, open_low: bool = False) -> None:
            value = getattr(self, name)
            if allowed is not None and value == allowed and isinstance(value, str):
                return
            hint = f" or {allowed!r}" if allowed else ""
            object.__setattr__(self, name, _checked_number(name, value, low, high, open_low, hint))

        store("tolerance", LEAST_TOLERANCE, 1e-3)
        store("min_edge", 0.0, 1.0)
        store("min_angle", 0.0, 90.0)
        if self.max_opening is not None:
            store("max_opening", 0.0, 180.0, open_low=True)
            if self.max_opening <= self.min_angle:
                raise ParameterError(
                    f"--max-opening: expected more than the smallest opening, {self.min_angle:g}, "
                    f"got {self.max_opening:g}"
                )
        if self.min_corner is not None:
            store("min_corner", 0.0, 60.0)
        store("kerf", 0.0, math.inf)
        store("opening", 0.0, 90.0, allowed="auto")
        store("orientation", -360.0, 360.0, allowed="auto")
        if self.cells is not None and self.orientation != "auto":
            raise ParameterError(
                "--orientation: expected with --tiles only (--cells follows the corners of the outline), "
                f"got {self.orientation} with --cells"
            )
        for name in ("max_seconds", "hinge_width", "remesh_edge"):
            if getattr(self, name) is not None:
                store(name, 0.0, math.inf, open_low=True)
        if self.max_steps is not None:
            object.__setattr__(self, "max_steps", _checked_integer("max-steps", self.max_steps, 1, 10**9))
        for name in ("repair", "remesh"):
            if not isinstance(getattr(self, name), bool):
                raise ParameterError(f"--{name}: expected true or false, got {getattr(self, name)!r}")
        if self.remesh_edge is not None and not self.remesh:
            raise ParameterError(f"--remesh-edge: expected together with --remesh, got {self.remesh_edge} alone")
        if self.hinge_width is not None and self.kerf >= self.hinge_width:
            raise ParameterError(
                f"--kerf: expected less than the hinge width {self.hinge_width:.6g}, got {self.kerf:.6g}"
            )

    def changed(self, **values: Any) -> FitSpec:
        """Return a copy with some values changed; a new `cells` clears `tiles` and the other way round."""
        if values.get("cells") is not None:
            values.setdefault("tiles", None)
        if values.get("tiles") is not None:
            values.setdefault("cells", None)
        return replace(self, **values)

    def as_dict(self) -> dict[str, Any]:
        """Return the values as plain TOML or JSON values; options that are None are left out."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        if self.cells is not None:
            values["cells"] = f"{self.cells[0]}x{self.cells[1]}"
        return {name: value for name, value in values.items() if value is not None}

    def to_toml(self) -> str:
        """Return the spec as TOML text; `FitSpec.from_toml` returns an equal spec."""
        import tomli_w

        return tomli_w.dumps(self.as_dict())

    @classmethod
    def from_dict(cls, values: Mapping[str, Any], source: str = "spec") -> FitSpec:
        """Build a spec from plain values (the inverse of `as_dict`).

        Raises
        ------
        ParameterError
            Where a name is unknown, the target is missing or a value is wrong.
        """
        known = [field.name for field in fields(cls)]
        for name in values:
            if name not in known:
                near = difflib.get_close_matches(str(name), known, n=1)
                hint = f" (did you mean {near[0]!r}?)" if near else f" (known: {', '.join(known)})"
                raise ParameterError(f"{source}: expected names of fit options, got {name!r}{hint}")
        if "target" not in values:
            raise ParameterError(f"{source}: expected a target, got none")
        values = dict(values)
        if isinstance(values.get("cells"), str):
            values["cells"] = parse_cells(values["cells"])
        return cls(**values)

    @classmethod
    def from_toml(cls, text: str, source: str = "spec") -> FitSpec:
        """Parse TOML text.

        Raises
        ------
        ParameterError
            Where the text is not TOML or the spec is wrong.
        """
        return cls.from_dict(parse_toml(text, source), source)


def parse_toml(text: str, source: str = "spec") -> dict[str, Any]:
    """Return the values of TOML text, unchecked (see `FitSpec.from_dict`)."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as problem:
        raise ParameterError(f"{source}: expected TOML, got {problem}") from None


def parse_cells(text: str) -> tuple[int, int]:
    """Return (columns, rows) of text such as 4x4.

    Raises
    ------
    ParameterError
        Where the text has another form.
    """
    match = re.fullmatch(r"\s*(\d{1,9})\s*[xX×]\s*(\d{1,9})\s*", text)
    if not match:
        raise ParameterError(f"--cells: expected WxH such as 4x4, got {text!r}")
    return _checked_cells((int(match[1]), int(match[2])))


def _check_can_be_written(name: str, value: Any) -> None:
    """Refuse a path of bytes that are no UTF-8: neither TOML nor JSON could hold it, and no run could be repeated."""
    if isinstance(value, str) and not value.isascii():
        try:
            value.encode("utf-8")
        except UnicodeEncodeError:
            raise UnreadableError(
                f"{name}: expected a path in UTF-8, got {value!a}: rename the file, or its folder, or set PYTHONUTF8=1 "
                "where the system's language makes Python take names for ASCII"
            ) from None


def _checked_cells(cells: Any) -> tuple[int, int]:
    try:
        width, height = (_checked_integer("cells", side, 1, 10**4) for side in cells)
    except (TypeError, ValueError):
        raise ParameterError(f"--cells: expected WxH with sides from 1 to 10000, got {cells!r}") from None
    return width, height


def _checked_integer(name: str, value: Any, low: int, high: int) -> int:
    if isinstance(value, bool) or not hasattr(value, "__index__") or not low <= value <= high:
        raise ParameterError(f"--{name}: expected a whole number from {low} to {high}, got {value!r}")
    return int(value)


def _checked_number(name: str, value: Any, low: float, high: float, open_low: bool, hint: str) -> float:
    option = "--" + name.replace("_", "-")
    start = f"a number above {low:g}" if open_low else f"a number from {low:g}"
    wanted = start + ("" if math.isinf(high) else f" up to {high:g}") + hint
    try:
        number = float(value) if not isinstance(value, (bool, str)) else math.nan
    except (TypeError, ValueError):
        number = math.nan
    if not (math.isfinite(number) and low <= number <= high) or (open_low and number == low):
        raise ParameterError(f"{option}: expected {wanted}, got {value!r}")
    return number


def _check_choice(name: str, value: Any, choices: tuple[str, ...], more: str = "") -> None:
    if value not in choices:
        near = difflib.get_close_matches(str(value), choices, n=1)
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        raise ParameterError(f"--{name}: expected one of {', '.join(choices)}{more}, got {value!r}{hint}")


def _checked_contracted(value: Any) -> str:
    """The shape of the flat sheet in one spelling; files are looked for when they are read."""
    if not isinstance(value, str) or not value.strip():
        raise ParameterError(f"--contracted: expected free, rectangle, rectangle:RATIO or an outline, got {value!r}")
    name, colon, ratio = value.partition(":")
    if name != RECTANGLE or not colon:
        return value
    try:
        number = float(ratio)
    except ValueError:
        number = math.nan
    if not (math.isfinite(number) and 0.01 <= number <= 100):
        raise ParameterError(f"--contracted: expected rectangle:RATIO with a number from 0.01 to 100, got {value!r}")
    return f"{RECTANGLE}:{number:.17g}"
