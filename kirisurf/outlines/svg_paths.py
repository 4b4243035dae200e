"""The shapes of SVG as curves, in the coordinates of the element: paths, rectangles, circles, polygons."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

import numpy as np
from fontTools.svgLib.path.parser import parse_path  # type: ignore[import-untyped]

from kirisurf.errors import KirisurfError, UnreadableError
from kirisurf.outlines.curve import Curve, joined
from kirisurf.outlines.drawing import MOST_PIECES, check_count, check_numbers, checked_number
from kirisurf.outlines.shapes import arc, bezier, straight

_TOKENS = re.compile(r"[MmZzLlHhVvCcSsQqTtAa]|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[\s,]+", re.ASCII)
_SEPARATE = re.compile(r"\d[\s,a-zA-Z-]")
_COMMANDS = re.compile(r"([MmZzLlHhVvCcSsQqTtAa])")
_MOST_NUMBERS = 7
"""Numbers that a piece has at most (an arc)."""

_LONGEST = 100 * MOST_PIECES
"""Characters of one path that are looked at: no sensible piece takes more than a hundred."""


def path_curves(text: str, name: str) -> list[Curve]:
    """Return the subpaths of path data, closed ones with their closing segment.

    Raises
    ------
    UnreadableError
        Where the data is no path.
    UnusableError
        Where a number is not finite or too large, or there are too many pieces.
    """
    if len(text) > _LONGEST:
        check_count(len(text), name)
    pen = _Pen(name)
    try:
        parse_path(_plain(text, name), pen)
    except KirisurfError:
        raise
    except (ValueError, IndexError, OverflowError) as problem:
        raise UnreadableError(f"{name}: expected SVG path data, got {text[:60]!r} ({str(problem)[:60]})") from None
    pen.endPath()
    return pen.curves


def shape_curves(tag: str, attributes: Mapping[str, str], name: str) -> list[Curve]:
    """Return the curves of a path, rect, circle, ellipse, line, polygon or polyline element.

    Raises
    ------
    UnreadableError, UnusableError
        As :func:`path_curves`.
    """
    if tag == "path":
        return path_curves(attributes.get("d", ""), name)
    if tag in ("polygon", "polyline"):
        return _polygon(attributes.get("points", ""), tag == "polygon", name)

    def value(key: str, default: float = 0.0) -> float:
        return length(attributes[key], name, f"{key} of {tag}") if key in attributes else default

    if tag == "line":
        ends = np.array([[value("x1"), value("y1")], [value("x2"), value("y2")]])
        return [straight(ends)] if (ends[0] != ends[1]).any() else []
    if tag == "rect":
        return _rectangle(attributes, value("x"), value("y"), value("width"), value("height"), name)
    rx = value("r") if tag == "circle" else value("rx", value("ry"))
    ry = value("r") if tag == "circle" else value("ry", value("rx"))
    if not (rx > 0 and ry > 0):
        return []
    return [arc([value("cx"), value("cy")], np.diag([rx, ry]), 0.0, 2 * math.pi)]


_UNITS_IN_PIXELS = {
    "": 1.0,
    "px": 1.0,
    "in": 96.0,
    "cm": 96.0 / 2.54,
    "mm": 96.0 / 25.4,
    "q": 96.0 / 101.6,
    "pt": 96.0 / 72.0,
    "pc": 16.0,
}


def length(text: str, name: str, what: str) -> float:
    """Return a length in pixels of 1/96 inch, which are the units of a drawing without a view box.

    Raises
    ------
    UnreadableError
        Where it is no length, or one that depends on fonts or on the page.
    """
    value, unit = length_and_unit(text, name, what)
    if unit not in _UNITS_IN_PIXELS:
        raise UnreadableError(
            f"{name}: expected a length in {', '.join(list(_UNITS_IN_PIXELS)[1:])}, got {text[:40]!r}"
        )
    return value * _UNITS_IN_PIXELS[unit]


def length_and_unit(text: str, name: str, what: str) -> tuple[float, str]:
    """Return the number and the unit, in small letters, of a length."""
    found = re.fullmatch(r"\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*([a-zA-Z%]*)\s*", text[:100])
    if not found:
        raise UnreadableError(f"{name}: expected a length for {what}, got {text[:40]!r}")
    return checked_number(found[1], name, what), found[2].lower()


class _Pen:
    """Takes the commands of the path parser and keeps curves."""

    def __init__(self, name: str) -> None:
        self.curves: list[Curve] = []
        self._name = name
        self._parts: list[Curve] = []
        self._corners: list[tuple[float, float]] = []
        self._here = (0.0, 0.0)
        self._count = 0

    def moveTo(self, point: tuple[float, float]) -> None:
        self.endPath()
        self._here = self._checked(point)[0]

    def lineTo(self, point: tuple[float, float]) -> None:
        # Lines are kept as points until another piece comes, since there may be very many.
        self._checked(point)
        if point != self._here:
            self._counted()
            if not self._corners:
                self._corners.append(self._here)
            self._corners.append(point)
            self._here = point

    def curveTo(self, *points: tuple[float, float]) -> None:
        self._add([self._here, *self._checked(*points)])

    qCurveTo = curveTo

    def arcTo(self, rx: float, ry: float, rotation: float, large: bool, sweep: bool, end: tuple[float, float]) -> None:
        self._checked(end, (rx, ry), (rotation, 0.0))
        here, there = np.array(self._here), np.array(end)
        if (here == there).all():
            return
        if rx == 0 or ry == 0:
            self.lineTo(end)
            return
        self._counted()
        self._end_lines()
        self._parts.append(_arc_between(here, there, rx, ry, math.radians(rotation), large, sweep))
        self._here = end

    def closePath(self) -> None:
        self.endPath()

    def endPath(self) -> None:
        self._end_lines()
        if self._parts:
            self.curves.append(joined(self._parts))
            self._parts = []

    def _add(self, points: list[tuple[float, float]]) -> None:
        # A piece of no length is nothing.
        if any(point != points[0] for point in points):
            self._counted()
            self._end_lines()
            self._parts.append(bezier(np.array(points)))
        self._here = points[-1]

    def _end_lines(self) -> None:
        if self._corners:
            self._parts.append(straight(np.array(self._corners)))
            self._corners = []

    def _checked(self, *points: tuple[float, float]) -> tuple[tuple[float, float], ...]:
        check_numbers([value for point in points for value in point], self._name, "coordinates")
        return points

    def _counted(self) -> None:
        self._count += 1
        check_count(self._count, self._name)


def _plain(text: str, name: str) -> str:
    # The parser passes over what it does not know and takes 1. or 007 for two numbers: nothing of that reaches it.
    position = 0
    for token in _TOKENS.finditer(text):
        if token.start() != position:
            break
        position = token.end()
    if position != len(text):
        raise UnreadableError(f"{name}: expected SVG path data, got {text[position : position + 20]!r} in it")
    check_count(len(_SEPARATE.findall(text)) // _MOST_NUMBERS, name)
    words = _COMMANDS.split(re.sub(r"[\s,]+", " ", text))
    plain = [words[0]]
    for command, numbers in zip(words[1::2], words[2::2], strict=True):
        if command not in "Aa":
            numbers = re.sub(r"(?<![\d.])0+(?=\d)", "", numbers)
        plain += [command, re.sub(r"(\d)\.(?!\d)", r"\1.0", numbers)]
    return "".join(plain).strip()


def _arc_between(
    here: np.ndarray, there: np.ndarray, rx: float, ry: float, rotation: float, large: bool, sweep: bool
) -> Curve:
    # From end points to center, as the SVG standard has it (appendix on elliptical arcs).
    turn = np.array([[math.cos(rotation), -math.sin(rotation)], [math.sin(rotation), math.cos(rotation)]])
    x, y = turn.T @ (0.5 * (here - there)) / (rx, ry)
    square = float(x**2 + y**2)
    if square >= 1:
        # The ends are too far apart for the radii: these grow until they reach.
        rx, ry = rx * math.sqrt(square), ry * math.sqrt(square)
        middle, x, y = np.zeros(2), x / math.sqrt(square), y / math.sqrt(square)
    else:
        factor = math.sqrt((1 - square) / square) * (1 if large != sweep else -1)
        middle = factor * np.array([y, -x])
    center = turn @ (middle * (rx, ry)) + 0.5 * (here + there)
    first = math.atan2(y - middle[1], x - middle[0])
    last = math.atan2(-y - middle[1], -x - middle[0])
    change = (last - first) % (2 * math.pi)
    if not sweep:
        change -= 2 * math.pi
    return arc(center, (turn * (rx, ry)).T, first, change)


def _polygon(text: str, closed: bool, name: str) -> list[Curve]:
    words = re.split(r"[\s,]+", text.strip())
    if len(words) > 2 * MOST_PIECES:
        check_count(len(words) // 2, name)
    values = [checked_number(word, name, "points") for word in words if word]
    points = np.array(values[: len(values) // 2 * 2]).reshape(-1, 2)
    if closed and len(points):
        points = np.concatenate([points, points[:1]])
    points = points[np.r_[True, (np.diff(points, axis=0) != 0).any(axis=1)]] if len(points) else points
    return [straight(points)] if len(points) > 1 else []


def _rectangle(
    attributes: Mapping[str, str], x: float, y: float, width: float, height: float, name: str
) -> list[Curve]:
    if not (width > 0 and height > 0):
        return []
    given = [attributes.get("rx", "auto"), attributes.get("ry", "auto")]
    radii = [None if text == "auto" else length(text, name, "radius of rect") for text in given]
    rx = radii[0] if radii[0] is not None else radii[1] or 0.0
    ry = radii[1] if radii[1] is not None else rx
    rx, ry = min(max(rx, 0.0), 0.5 * width), min(max(ry, 0.0), 0.5 * height)
    corners = np.array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]])
    if not (rx > 0 and ry > 0):
        return [straight(np.concatenate([corners, corners[:1]]))]
    inward = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * (rx, ry)
    parts: list[Curve] = []
    for k in range(4):
        parts.append(arc(corners[k] + inward[k], np.diag([rx, ry]), math.pi + 0.5 * math.pi * k, 0.5 * math.pi))
        following = (k + 1) % 4
        side = np.array([corners[k], corners[following]])
        across = np.array([0, 1]) if k % 2 == 0 else np.array([1, 0])
        ends = np.stack([side[0] + inward[k] * (1 - across), side[1] + inward[following] * (1 - across)])
        if np.abs(ends[1] - ends[0]).max() > 1e-12 * max(width, height):
            parts.append(straight(ends))
    return [joined(parts)]
