"""Reading outlines from drawings (SVG, DXF) and tables of points (CSV)."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats.source import read_bytes
from kirisurf.gate import check_size
from kirisurf.naming import printable
from kirisurf.outlines import csv_points, dxf_drawing, svg_drawing
from kirisurf.outlines.closing import closed_curves
from kirisurf.outlines.curve import Curve
from kirisurf.outlines.drawing import Drawing
from kirisurf.outlines.outline import Outline
from kirisurf.outlines.sampled import sides_through
from kirisurf.units import MILLIMETERS, checked_unit

FORMATS = (".svg", ".dxf", ".csv")
LIMIT_MB = 32

_READERS = {".svg": svg_drawing.read, ".dxf": dxf_drawing.read}


def read_outline(
    path: str | os.PathLike[str], units: str | None = None, *, limit_mb: int | float = LIMIT_MB
) -> tuple[Outline, tuple[str, ...]]:
    """Read the outline that a file holds, and a sentence on everything that was chosen or changed.

    Of several closed curves the one with the largest area is the outline. Curves of straight segments that turn
    little from one to the next are samples of smooth ones, see :mod:`kirisurf.outlines.sampled`.

    Parameters
    ----------
    path : path
        SVG, DXF or CSV, told by the suffix.
    units : str, optional
        Length unit of the result: um, mm, cm, m, in or ft. A file that says its own unit is converted, the
        coordinates of others are taken to be in it.
    limit_mb : float
        Largest file that is read, in megabytes.

    Returns
    -------
    outline : Outline
        `units` is None where neither the file nor the caller says it.
    notes : tuple of str

    Raises
    ------
    UnreadableError
        Where the file is missing, unsupported, damaged, unsafe or too large.
    UnusableError
        Where it holds no closed curve, or the largest one encloses no area or crosses itself.
    ParameterError
        Where the unit is unknown.
    """
    if units is not None:
        checked_unit(units)
    path = Path(path)
    suffix, name = path.suffix.lower(), printable(path.name)
    if suffix not in FORMATS:
        raise UnreadableError(f"{path}: expected an outline as {', '.join(FORMATS)}, got {suffix or 'no suffix'}")
    content = read_bytes(path, limit_mb)
    if not content.strip():
        raise UnusableError(f"{name}: expected an outline, got an empty file")
    if content.startswith(b"\x1f\x8b"):
        raise UnreadableError(f"{name}: expected {suffix[1:].upper()}, got a gzip archive: unpack it first")
    try:
        # What is finite may still be too far apart in size to be computed with: that ends here, not in a NaN.
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            return _read(content, name, suffix, units)
    except MemoryError:
        raise UnreadableError(f"{name}: expected an outline that fits into memory, got a larger one") from None
    except FloatingPointError as problem:
        raise UnusableError(
            f"{name}: expected an outline whose parts are of comparable size, got numbers that cannot be "
            f"computed with ({problem})"
        ) from None
    except UnusableError as problem:
        if str(problem).startswith(name):
            raise
        raise UnusableError(f"{name}: {problem}") from None


def _read(content: bytes, name: str, suffix: str, units: str | None) -> tuple[Outline, tuple[str, ...]]:
    if suffix == ".csv":
        outline, notes = csv_points.read(content, name)
        own = None
    else:
        drawing = _READERS[suffix](content, name)
        outline, notes = _largest(drawing, suffix == ".dxf")
        own = drawing.units
    return _in_units(outline, own, units, notes)


def _largest(drawing: Drawing, tells_direction: bool) -> tuple[Outline, list[str]]:
    name, notes = drawing.name, list(drawing.notes)
    if not drawing.curves:
        left = f" ({' '.join(notes)})" if notes else ""
        raise UnusableError(f"{name}: expected a closed curve, got a drawing without curves{left}")
    _check_extent(drawing.curves, name)
    closed, remaining, found = closed_curves(drawing.curves)
    notes += found
    if not closed:
        if not remaining:
            raise UnusableError(f"{name}: expected a curve round an area, got all points in one place")
        longest = max(remaining, key=lambda curve: curve.length)
        raise UnusableError(
            f"{name}: expected a closed curve, got {len(remaining)} open ones; the longest goes from "
            f"({longest.start[0]:.6g}, {longest.start[1]:.6g}) to ({longest.end[0]:.6g}, {longest.end[1]:.6g})"
        )
    areas = np.array([curve.green_area for curve in closed])
    k = int(np.argmax(np.abs(areas)))
    outline, is_sampled, note = _outline(closed[k], name)
    notes += [note] if is_sampled else []
    # Upwards, what is counter-clockwise on an SVG page runs clockwise: no news there.
    if areas[k] < 0 and tells_direction:
        notes.append("The curve was clockwise and was turned counter-clockwise.")
    if len(closed) > 1:
        notes.append(_others(outline, [curve for j, curve in enumerate(closed) if j != k]))
    if remaining:
        notes.append(f"{len(remaining)} open {'curve was' if len(remaining) == 1 else 'curves were'} left out.")
    return outline, notes


def _outline(curve: Curve, name: str) -> tuple[Outline, bool, str]:
    if curve.n_pieces >= 3 and not curve.polynomials[:, 2:].any() and not curve.waves.any():
        sides, is_smooth, note = sides_through(curve.polynomials[:, 0], name=name)
        is_sampled = sum(side.n_pieces for side in sides) > len(sides)
        return Outline.from_sides(sides, name, is_smooth=is_smooth), is_sampled, note
    return Outline.from_curve(curve, name), False, ""


def _others(outline: Outline, others: list[Curve]) -> str:
    inside = int((outline.project(np.array([curve.start for curve in others])).distances < 0).sum())
    sentence = f"The largest of {len(others) + 1} closed curves is the outline."
    if inside:
        sentence += (
            f" {inside} inside it {'was' if inside == 1 else 'were'} left out: an outline has no holes, "
            "the sheet covers them."
        )
    return sentence


def _check_extent(curves: tuple[Curve, ...], name: str) -> None:
    values = np.concatenate([curve.polynomials[:, 0] for curve in curves])
    reach = max(float(np.abs(part).max()) for curve in curves for part in (curve.polynomials, curve.waves))
    span = np.concatenate([values, values[:1] + reach])
    check_size(np.column_stack([span, np.zeros(len(span))]), name)


def _in_units(
    outline: Outline, own: str | None, units: str | None, notes: list[str]
) -> tuple[Outline, tuple[str, ...]]:
    if own is not None and units is not None and own != units:
        factor = MILLIMETERS[own] / MILLIMETERS[units]
        return replace(outline.scaled(factor), units=units), (
            *notes,
            f"Coordinates were converted from {own} to {units}.",
        )
    if own is None and units is None:
        return outline, (*notes, "The file names no unit of length.")
    return replace(outline, units=units or own), tuple(notes)
