"""Reading SVG: its shapes with all transforms, in the file's own physical unit, y upwards.

The file is walked through with expat, event by event: no tree is built, nothing that the file names is opened,
entities are refused, and nesting has a limit. What is drawn elsewhere (symbols, clip paths, definitions and their
uses) is no outline and is left out, as is what is not displayed.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NoReturn
from xml.parsers import expat

import numpy as np

from kirisurf.errors import KirisurfError, UnreadableError
from kirisurf.outlines.curve import Curve
from kirisurf.outlines.drawing import Drawing, check_count, check_numbers, checked_number, counted
from kirisurf.outlines.svg_paths import length, length_and_unit, shape_curves
from kirisurf.units import MILLIMETERS

_SHAPES = ("path", "rect", "circle", "ellipse", "line", "polygon", "polyline")
_ELSEWHERE = ("defs", "symbol", "clipPath", "mask", "pattern", "marker", "linearGradient", "radialGradient", "filter")
_TOLD = ("use", "text", "image", "foreignObject", "switch")
_DEEPEST = 256
_PIXELS_PER_INCH = 96.0

_TRANSFORM = re.compile(r"\s*,?\s*([A-Za-z]+)\s*\(([^()]*)\)\s*")


def read(content: bytes, name: str) -> Drawing:
    """Read the curves of an SVG drawing.

    A drawing whose width is in mm, cm or in keeps that unit; others (px, pt, pc, none) come in mm, with 96 px to
    the inch.

    Raises
    ------
    UnreadableError
        Where it is no SVG, is damaged, or holds entities.
    UnusableError
        Where numbers are not finite or too large, or there are too many pieces.
    """
    walk = _Walk(name)
    parser = expat.ParserCreate()
    parser.StartElementHandler = walk.begin
    parser.EndElementHandler = walk.end
    parser.EntityDeclHandler = walk.refuse_entity
    parser.ExternalEntityRefHandler = walk.refuse_entity
    try:
        parser.Parse(content, True)
    except expat.ExpatError as problem:
        raise UnreadableError(f"{name}: expected SVG, got damaged XML: {problem}") from None
    except KirisurfError:
        raise
    except (LookupError, ValueError, RecursionError) as problem:
        raise UnreadableError(f"{name}: expected SVG, got XML that cannot be read: {problem}") from None
    if walk.left_out:
        walk.notes.append(f"Left out: {counted(walk.left_out)} (draw the outline itself as a path).")
    return Drawing(name, tuple(walk.curves), walk.units, tuple(walk.notes))


@dataclass(frozen=True, eq=False)
class _Level:
    """What holds inside one element: the map to the page, and whether anything is drawn."""

    matrix: np.ndarray
    is_drawn: bool


class _Walk:
    """Keeps the curves of the elements that begin and end."""

    def __init__(self, name: str) -> None:
        self.curves: list[Curve] = []
        self.notes: list[str] = []
        self.units = "mm"
        self.left_out: Counter[str] = Counter()
        self._name = name
        self._levels: list[_Level] = []
        self._count = 0
        self._moves = 0

    def begin(self, tag: str, attributes: dict[str, str]) -> None:
        tag = tag.rpartition(":")[2]
        if not self._levels:
            if tag != "svg":
                raise UnreadableError(f"{self._name}: expected SVG, got XML with the element {tag[:40]!r}")
            self._levels.append(_Level(self._page(attributes), True))
            return
        above = self._levels[-1]
        if len(self._levels) >= _DEEPEST:
            raise UnreadableError(f"{self._name}: expected at most {_DEEPEST} nested elements, got more")
        is_drawn = above.is_drawn and tag not in _ELSEWHERE and not _is_hidden(attributes)
        matrix = above.matrix
        if is_drawn:
            if "transform" in attributes:
                self._moves += attributes["transform"].count("(")
                check_count(self._moves, self._name, "transforms")
                matrix = matrix @ transform(attributes["transform"], self._name)
            if tag == "svg":
                matrix = matrix @ self._inner_page(attributes)
            if tag in _TOLD:
                self.left_out[tag] += 1
                is_drawn = False
            elif tag in _SHAPES:
                self._draw(tag, attributes, matrix)
        self._levels.append(_Level(matrix, is_drawn))

    def end(self, tag: str) -> None:
        self._levels.pop()

    def refuse_entity(self, *_: object) -> NoReturn:
        raise UnreadableError(
            f"{self._name}: expected SVG without entities, which are unsafe to read, got some: save it as plain SVG"
        )

    def _draw(self, tag: str, attributes: Mapping[str, str], matrix: np.ndarray) -> None:
        check_numbers(matrix, self._name, "transforms")
        if abs(float(np.linalg.det(matrix[:2, :2]))) == 0:
            return
        for curve in shape_curves(tag, attributes, self._name):
            self._count += curve.n_pieces
            check_count(self._count, self._name)
            self.curves.append(curve.transformed(matrix[:2, :2], matrix[:2, 2]))

    def _page(self, attributes: Mapping[str, str]) -> np.ndarray:
        box = self._view_box(attributes)
        size = [self._page_length(attributes, key) for key in ("width", "height")]
        unit = next((unit for _, unit in size if unit), "")
        self.units = unit if unit in ("mm", "cm", "in") else "mm"
        pixel = 25.4 / _PIXELS_PER_INCH / MILLIMETERS[self.units]
        scale = np.full(2, pixel)
        if box is not None:
            shape = [value for value, _ in size]
            ratios = [page * pixel / side for page, side in zip(shape, box[2:], strict=True) if page is not None]
            if len(ratios) == 2 and attributes.get("preserveAspectRatio", "").strip().startswith("none"):
                scale = np.array(ratios)
            elif ratios:
                slices = "slice" in attributes.get("preserveAspectRatio", "")
                scale = np.full(2, max(ratios) if slices else min(ratios))
        if unit not in ("mm", "cm", "in"):
            said = f"in {unit}" if unit else "without a unit"
            self.notes.append(f"The drawing's size is {said}: lengths are in mm, 96 px to the inch.")
        bottom = box[1] + box[3] if box is not None else size[1][0] or 0.0
        left = box[0] if box is not None else 0.0
        return np.array([[scale[0], 0.0, -scale[0] * left], [0.0, -scale[1], scale[1] * bottom], [0.0, 0.0, 1.0]])

    def _page_length(self, attributes: Mapping[str, str], key: str) -> tuple[float | None, str]:
        # In pixels, with the unit that is written.
        if key not in attributes or attributes[key].strip().lower() == "auto":
            return None, ""
        value, unit = length_and_unit(attributes[key], self._name, f"the drawing's {key}")
        if unit == "%" or value <= 0:
            return None, ""
        return length(attributes[key], self._name, key), unit

    def _inner_page(self, attributes: Mapping[str, str]) -> np.ndarray:
        moved = [length(attributes.get(key, "0"), self._name, key) for key in ("x", "y")]
        matrix = np.array([[1.0, 0.0, moved[0]], [0.0, 1.0, moved[1]], [0.0, 0.0, 1.0]])
        box = self._view_box(attributes)
        size = [self._page_length(attributes, key)[0] for key in ("width", "height")]
        if box is None:
            return matrix
        ratios = [page / side for page, side in zip(size, box[2:], strict=True) if page is not None]
        scale = min(ratios) if ratios else 1.0
        return matrix @ np.array([[scale, 0, -scale * box[0]], [0, scale, -scale * box[1]], [0, 0, 1.0]])

    def _view_box(self, attributes: Mapping[str, str]) -> list[float] | None:
        words = re.split(r"[\s,]+", attributes.get("viewBox", "").strip())
        if words == [""]:
            return None
        box = [checked_number(word, self._name, "viewBox") for word in words]
        if len(box) != 4 or not (box[2] > 0 and box[3] > 0):
            raise UnreadableError(f"{self._name}: expected four numbers for viewBox, got {' '.join(words)[:60]!r}")
        return box


def transform(text: str, name: str) -> np.ndarray:
    """Return the matrix (3, 3) of a transform attribute.

    Raises
    ------
    UnreadableError
        Where it is none.
    """
    matrix, position, text = np.eye(3), 0, text.strip()
    while position < len(text):
        found = _TRANSFORM.match(text, position)
        if not found:
            raise UnreadableError(f"{name}: expected transforms, got {text[position : position + 40]!r}")
        position = found.end()
        values = [checked_number(word, name, found[1]) for word in re.split(r"[\s,]+", found[2].strip()) if word]
        matrix = matrix @ _single_transform(found[1], values, name)
        check_numbers(matrix, name, "transforms")
    return matrix


def _single_transform(kind: str, values: list[float], name: str) -> np.ndarray:
    match kind, values:
        case "matrix", [a, b, c, d, e, f]:
            return np.array([[a, c, e], [b, d, f], [0.0, 0.0, 1.0]])
        case "translate", [x, *rest] if len(rest) < 2:
            return np.array([[1.0, 0.0, x], [0.0, 1.0, rest[0] if rest else 0.0], [0.0, 0.0, 1.0]])
        case "scale", [x, *rest] if len(rest) < 2:
            return np.diag([x, rest[0] if rest else x, 1.0])
        case "rotate", [angle]:
            c, s = _cosine_and_sine(angle)
            return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        case "rotate", [angle, x, y]:
            move = _single_transform("translate", [x, y], name)
            back = _single_transform("translate", [-x, -y], name)
            return move @ _single_transform("rotate", [angle], name) @ back
        case "skewX", [angle]:
            return np.array([[1.0, math.tan(math.radians(angle)), 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        case "skewY", [angle]:
            return np.array([[1.0, 0.0, 0.0], [math.tan(math.radians(angle)), 1.0, 0.0], [0.0, 0.0, 1.0]])
    raise UnreadableError(f"{name}: expected a transform of SVG, got {kind[:20]} with {len(values)} numbers")


def _cosine_and_sine(degrees: float) -> tuple[float, float]:
    # Quarter turns are exact.
    if degrees % 90 == 0:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(degrees // 90) % 4]
    return math.cos(math.radians(degrees)), math.sin(math.radians(degrees))


def _is_hidden(attributes: Mapping[str, str]) -> bool:
    style = attributes.get("style", "").replace(" ", "").lower()
    return (
        attributes.get("display") == "none"
        or attributes.get("visibility") in ("hidden", "collapse")
        or "display:none" in style
        or "visibility:hidden" in style
    )
