"""A unit cell of the user's own, from a text file.

One fact a line; words are separated by blanks, and # begins a remark::

    name    rotating-squares
    title   two by two squares, fully open
    columns 2 0              2*sqrt(2) 0
    rows    0 2              0 2*sqrt(2)
    point   0 0              sqrt(2)/2 0
    ...
    tile    1 2 3 4
    opening 0 0  1 0  1 1

`columns` and `rows` are the translations to the next column and the next row of cells, `point` is one corner: first
x y contracted, then x y deployed. Points count from 1 in the order of their lines; corners that are hinged are one
point (or two at the same places), the two sides of a slit need one point each. `tile` lists its points
counter-clockwise; `opening`, as many as there are, lists the contracted corners x y of what stays open when the
sheet is closed. Numbers may be written as arithmetic without blanks, see :mod:`kirisurf.unit_cells.arithmetic`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from kirisurf.arrays import frozen
from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats.source import read_bytes
from kirisurf.loops import Loops
from kirisurf.unit_cell import UnitCell
from kirisurf.unit_cells.arithmetic import parse_number
from kirisurf.unit_cells.checks import check_cell

LIMIT_MB = 1
MOST_TILES = 1000
_LARGEST = 1e9
_KEYWORDS = ("name", "title", "columns", "rows", "point", "tile", "opening")


@dataclass
class _Lines:
    """What the lines of a file say, each fact with the number of its line."""

    file: str
    texts: dict[str, str] = field(default_factory=dict)
    shifts: dict[str, tuple[int, list[float]]] = field(default_factory=dict)
    points: list[list[float]] = field(default_factory=list)
    tiles: list[tuple[int, list[int]]] = field(default_factory=list)
    openings: list[tuple[int, list[float]]] = field(default_factory=list)

    def place(self, line: int) -> str:
        return f"{self.file}, line {line}"


def read_cell(path: str | os.PathLike[str]) -> UnitCell:
    """Read and check a unit cell.

    Parameters
    ----------
    path : path
        Text in the form that :mod:`kirisurf.unit_cells.cell_file` describes.

    Returns
    -------
    UnitCell
        At the scale at which its contracted cell has area 1, in both states.

    Raises
    ------
    UnreadableError
        Where the file is missing, no text, or a line has another form.
    UnusableError
        Where no sheet can be made of the lines, see :func:`kirisurf.unit_cells.checks.check_cell`.
    """
    return parse_cell(_text(Path(path)), os.fspath(path))


def read_title(path: str | os.PathLike[str]) -> tuple[str, str]:
    """Return name and title of a unit cell file, its points and tiles unread."""
    found = {}
    for line in _text(Path(path)).splitlines():
        word, _, rest = line.partition("#")[0].strip().partition(" ")
        if word in ("name", "title"):
            found[word] = rest.strip()
    return found.get("name", Path(path).stem), found.get("title", "")


def parse_cell(text: str, file: str = "cell") -> UnitCell:
    """Return the unit cell that a text describes; `file` is its name in messages.

    Raises
    ------
    UnreadableError, UnusableError
        As :func:`read_cell`.
    """
    try:
        # What is finite may still be too far apart in size to be computed with: that ends here, not in a NaN.
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            return _parsed(text, file)
    except (FloatingPointError, np.linalg.LinAlgError) as problem:
        raise UnusableError(
            f"{file}: expected points and translations of comparable size, got some that cannot be computed with "
            f"({problem})"
        ) from None


def _parsed(text: str, file: str) -> UnitCell:
    lines = _Lines(file)
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.partition("#")[0].split()
        if words:
            _take(lines, number, words)
    _check_complete(lines)
    columns, rows = lines.shifts["columns"], lines.shifts["rows"]
    shifts = np.array([columns[1], rows[1]])
    place = lines.place(columns[0])
    if not abs(np.linalg.det(shifts[:, :2])) > 0:
        raise UnusableError(f"{place}: expected contracted translations that span a cell, got one without area")
    points = np.array(lines.points)
    cell = UnitCell(
        deployed=frozen(points[:, 2:]),
        contracted=frozen(points[:, :2]),
        tiles=Loops.from_lists([[k - 1 for k in tile] for _, tile in lines.tiles]),
        deployed_shifts=frozen(shifts[:, 2:]),
        contracted_shifts=frozen(shifts[:, :2]),
        name=lines.texts.get("name", Path(file).stem),
        openings=tuple(frozen(np.reshape(corners, (-1, 2))) for _, corners in lines.openings),
    ).normalized()
    tile_places = [lines.place(line) for line, _ in lines.tiles]
    check_cell(cell, tile_places, [lines.place(line) for line, _ in lines.openings], place)
    return cell


def _text(path: Path) -> str:
    content = read_bytes(path, LIMIT_MB)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise UnreadableError(f"{path}: expected a unit cell as text, got something else")
    return text


def _take(lines: _Lines, number: int, words: Sequence[str]) -> None:
    """Store what one line says."""
    place, (keyword, *rest) = lines.place(number), words
    if keyword not in _KEYWORDS:
        raise UnreadableError(f"{place}: expected one of {', '.join(_KEYWORDS)}, got {keyword[:40]!r}")
    if keyword in lines.texts or keyword in lines.shifts:
        raise UnreadableError(f"{place}: expected one line {keyword!r}, got a second")
    if keyword in ("name", "title"):
        lines.texts[keyword] = " ".join(rest)
        if keyword == "name" and not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]{0,59}", lines.texts[keyword]):
            raise UnreadableError(f"{place}: expected a name of letters, digits, - and _, got {' '.join(rest)[:80]!r}")
    elif keyword == "tile":
        lines.tiles.append((number, _point_numbers(rest, place)))
    elif keyword == "opening":
        if len(rest) < 6 or len(rest) % 2:
            raise UnreadableError(f"{place}: expected x y of three corners or more, got {len(rest)} numbers")
        lines.openings.append((number, _numbers(rest, place)))
    else:
        if len(rest) != 4:
            raise UnreadableError(f"{place}: expected x y contracted and x y deployed, got {len(rest)} numbers")
        values = _numbers(rest, place)
        if keyword == "point":
            lines.points.append(values)
        else:
            lines.shifts[keyword] = number, values


def _numbers(words: Sequence[str], place: str) -> list[float]:
    values = []
    for word in words:
        try:
            values.append(parse_number(word))
        except ValueError as problem:
            raise UnreadableError(f"{place}: expected a number such as 0.5 or sqrt(3)/2, got {problem}") from None
        if abs(values[-1]) > _LARGEST:
            raise UnusableError(f"{place}: expected numbers up to {_LARGEST:g}, got {word}")
    return values


def _point_numbers(words: Sequence[str], place: str) -> list[int]:
    wrong = [word for word in words if not re.fullmatch(r"[0-9]{1,7}", word)]
    if wrong:
        raise UnreadableError(f"{place}: expected numbers of points, got {wrong[0][:40]!r}")
    found = [int(word) for word in words]
    if len(found) < 3:
        raise UnusableError(f"{place}: expected a tile of three points or more, got {len(found)}")
    if len(set(found)) < len(found):
        raise UnusableError(f"{place}: expected different points, got one twice")
    return found


def _check_complete(lines: _Lines) -> None:
    for keyword in ("columns", "rows"):
        if keyword not in lines.shifts:
            raise UnusableError(f"{lines.file}: expected a line {keyword!r} with its two translations, got none")
    if not lines.tiles:
        raise UnusableError(f"{lines.file}: expected lines 'tile', got none")
    if len(lines.tiles) > MOST_TILES:
        raise UnusableError(f"{lines.file}: expected at most {MOST_TILES} tiles in a cell, got {len(lines.tiles)}")
    for line, tile in lines.tiles:
        wrong = [k for k in tile if not 1 <= k <= len(lines.points)]
        if wrong:
            raise UnusableError(f"{lines.place(line)}: expected points from 1 to {len(lines.points)}, got {wrong[0]}")
