"""Reading outlines from tables of points: columns x, y and, where wanted, a mark for corners."""

from __future__ import annotations

import math

import numpy as np

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.gate import check_size
from kirisurf.outlines.drawing import MOST_PIECES, check_numbers, plain_float
from kirisurf.outlines.outline import Outline
from kirisurf.outlines.sampled import sides_through

_MARKED = {"1", "true", "yes", "x", "corner"}
_UNMARKED = {"", "0", "false", "no"}


def read(content: bytes, name: str) -> tuple[Outline, list[str]]:
    """Read the vertices of a closed polygon, one a line.

    Columns are parted by commas, semicolons, tabs or blanks; with semicolons or tabs, numbers may have decimal
    commas. A first line without numbers is a header, which may name the columns x and y anywhere, and `corner`
    for marks (1, true, yes, x, corner; else empty, 0, false, no). Without a header, a third column of zeros and
    ones marks corners. Lines that begin with # are comments. Without marks, corners are found.

    Raises
    ------
    UnreadableError
        Where it is no text, or a line holds no two numbers.
    UnusableError
        Where a number is not finite or too large, there are too few or too many points, a third coordinate
        varies, or the curve encloses no area or crosses itself.
    """
    lines = [
        (number, line.strip())
        for number, line in enumerate(_text(content, name).splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if len(lines) > MOST_PIECES + 1:
        raise UnusableError(f"{name}: expected at most {MOST_PIECES} points, got {len(lines)}: simplify the outline")
    if not lines:
        raise UnusableError(f"{name}: expected points x, y, got comments alone")
    rows = _fields(lines)
    # A line of which a part is a number is a damaged point, and no header.
    header = [] if any(_is_number(field) for field in rows[0]) else [field.strip("\"' ").lower() for field in rows[0]]
    if header:
        rows, lines = rows[1:], lines[1:]
    columns = (header.index("x"), header.index("y")) if {"x", "y"} <= set(header) else (0, 1)
    points = _points(rows, [number for number, _ in lines], columns, name)
    marks, notes = _marks(rows, header, columns, name)
    points, marks = _cleaned(points, marks, name, notes)
    sides, is_smooth, sentence = sides_through(points, marks, name)
    outline = Outline.from_sides(sides, name, is_smooth=is_smooth)
    notes.append(sentence)
    if _double_area(points) < 0:
        notes.append("The points ran clockwise and were turned counter-clockwise.")
    _tell_wide_gap(points, notes)
    return outline, notes


def _text(content: bytes, name: str) -> str:
    for mark, encoding in ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16")):
        if content.startswith(mark):
            try:
                return content.decode(encoding)
            except UnicodeDecodeError:
                raise UnreadableError(f"{name}: expected {encoding} text as its first bytes say, got others") from None
    if b"\0" in content:
        raise UnreadableError(f"{name}: expected a table of points as text, got binary content")
    # Numbers are the same in every encoding that is left; a header in another one does no harm.
    return content.decode("latin-1")


def _fields(lines: list[tuple[int, str]]) -> list[list[str]]:
    sample = lines[-1][1]
    if ";" in sample or "\t" in sample:
        split = ";" if ";" in sample else "\t"
        decimal = not any("." in line for _, line in lines[1:])
        texts = (line.replace(",", ".") if decimal else line for _, line in lines)
        return [[field.strip() for field in text.split(split)] for text in texts]
    if "," in sample:
        return [[field.strip() for field in line.split(",")] for _, line in lines]
    return [line.split() for _, line in lines]


def _is_number(text: str) -> bool:
    try:
        plain_float(text)
    except ValueError:
        return False
    return True


def _points(rows: list[list[str]], numbers: list[int], columns: tuple[int, int], name: str) -> np.ndarray:
    points = np.zeros((len(rows), 2))
    for k, row in enumerate(rows):
        given = [row[column] if column < len(row) else "" for column in columns]
        if not all(_is_number(field) for field in given):
            shown = " ".join(row)[:60]
            raise UnreadableError(f"{name}: expected two numbers x, y in line {numbers[k]}, got {shown!r}")
        points[k] = [float(field) for field in given]
        if not np.isfinite(points[k]).all():
            raise UnusableError(f"{name}: expected finite numbers in line {numbers[k]}, got {', '.join(given)[:60]}")
    check_numbers(points, name, "coordinates")
    return points


def _marks(
    rows: list[list[str]], header: list[str], columns: tuple[int, int], name: str
) -> tuple[np.ndarray | None, list[str]]:
    third = header.index("corner") if "corner" in header else next(k for k in range(3) if k not in columns)
    values = [row[third].strip("\"' ").lower() if third < len(row) else "" for row in rows]
    named = "corner" in header
    if named and not set(values) <= _MARKED | _UNMARKED:
        wrong = next(value for value in values if value not in _MARKED | _UNMARKED)
        raise UnreadableError(f"{name}: expected 1 or 0 in the column corner, got {wrong[:40]!r}")
    if named or (not header and set(values) <= {"", "0", "1"} and "1" in values):
        marks = np.array([value in _MARKED for value in values], dtype=bool)
        return marks, [f"{int(marks.sum())} points are marked as corners."]
    if not any(values):
        return None, []
    if all(_is_number(value) for value in values) and np.ptp([float(value) for value in values]) > 0:
        raise UnusableError(f"{name}: expected points of one plane, got a third column that varies")
    return None, ["Columns beyond x and y were left out."]


def _cleaned(
    points: np.ndarray, marks: np.ndarray | None, name: str, notes: list[str]
) -> tuple[np.ndarray, np.ndarray | None]:
    if len(points):
        check_size(np.column_stack([points, np.zeros(len(points))]), name)
    size = float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0
    kept = np.ones(len(points), bool)
    last = 0
    for k in range(1, len(points)):
        if math.dist(points[k], points[last]) <= 1e-9 * size:
            kept[k] = False
            if marks is not None:
                marks[last] |= marks[k]
        else:
            last = k
    # The first point is often repeated at the end, to say that the curve is closed.
    if last > 0 and math.dist(points[last], points[0]) <= 1e-9 * size:
        kept[last] = False
        if marks is not None:
            marks[0] |= marks[last]
        closing = 1
    else:
        closing = 0
    repeated = int((~kept).sum()) - closing
    if repeated > 0:
        notes.append(f"{repeated} repeated {'point was' if repeated == 1 else 'points were'} left out.")
    if kept.sum() < 3:
        raise UnusableError(f"{name}: expected three different points or more, got {int(kept.sum())}")
    return points[kept], None if marks is None else marks[kept]


def _double_area(points: np.ndarray) -> float:
    x, y = (points - points[0]).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def _tell_wide_gap(points: np.ndarray, notes: list[str]) -> None:
    length = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    if len(points) >= 20 and length[-1] > 5 * length[:-1].max():
        notes.append(
            f"The last point lies {length[-1]:.4g} from the first, farther than any two others: "
            "the curve was closed by a straight segment."
        )
