"""Reading DXF: lines, arcs, circles, ellipses, polylines with bulges and splines of the model space."""

from __future__ import annotations

import io
import math
import re
import struct
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from kirisurf.dxf_library import load_dxf_library
from kirisurf.errors import KirisurfError, UnreadableError
from kirisurf.naming import printable
from kirisurf.outlines.curve import Curve, joined
from kirisurf.outlines.drawing import Drawing, check_count, check_numbers, counted
from kirisurf.outlines.shapes import arc, bezier, straight

# $INSUNITS (DXF reference, header variables): the unit that is kept, or the one taken instead and its factor.
_UNITS = {1: ("in", 1.0), 2: ("ft", 1.0), 4: ("mm", 1.0), 5: ("cm", 1.0), 6: ("m", 1.0), 13: ("um", 1.0)}
_OTHER_UNITS = {7: ("m", 1e3), 8: ("in", 1e-6), 9: ("in", 1e-3), 10: ("ft", 3.0), 14: ("cm", 10.0)}

_FLAT = 1e-9
"""Sine of the angle to the plane up to which a normal is upright."""

_CUBICS = 32
"""Cubics for one span of a spline that is none itself: on a quarter circle they are 2e-8 of its radius off."""

_GUESSED = re.compile(r"value \"b?'?(.*?)'?\" near line", re.DOTALL)
"""What ezdxf could not read, in its own words."""

_NUMBER_CODES = tuple(
    range(first, last + 1)
    for first, last in ((10, 99), (110, 299), (370, 389), (400, 409), (420, 429), (440, 469), (1010, 1071))
)
"""Groups whose value is a number (DXF reference, group code value types)."""

_WHOLE = re.compile(r"\s*[-+]?\d+(\.0*)?\s*", re.ASCII)
_UNDERSCORE = re.compile(rb"^[ \t]*(\d{1,4})[ \t]*\r?\n([^\r\n]*_[^\r\n]*)", re.MULTILINE)
_TWO_NUMBERS = re.compile(rb"[-+\d.eE]+(_[-+\d.eE]+)+")

_DAMAGED = (
    ValueError,
    TypeError,
    KeyError,
    IndexError,
    AttributeError,
    AssertionError,
    ArithmeticError,
    LookupError,
    RecursionError,
    struct.error,
)


def read(content: bytes, name: str) -> Drawing:
    """Read the curves of the model space; z is left out.

    Raises
    ------
    UnreadableError
        Where it is no DXF text, or damaged.
    UnusableError
        Where numbers are not finite or too large, or there are too many pieces.
    """
    load_dxf_library()
    import ezdxf
    from ezdxf import recover

    if content.startswith(b"AutoCAD Binary DXF"):
        raise UnreadableError(f"{name}: expected DXF as text, got binary DXF: save it as ASCII DXF")
    if content.startswith(b"AC10"):
        raise UnreadableError(f"{name}: expected DXF, got a DWG drawing: save it as DXF")
    try:
        document, auditor = recover.read(io.BytesIO(content))
    except (ezdxf.DXFError, *_DAMAGED) as problem:
        said = str(problem)[:100].encode("unicode_escape").decode("ascii")
        raise UnreadableError(f"{name}: expected DXF, got damaged content: {said}") from None
    notes: list[str] = []
    if faults := len(auditor.errors) - _harmless_faults(content, auditor, name):
        what = "1 fault of the file was" if faults == 1 else f"{faults} faults of the file were"
        notes.append(f"{what} not repaired; see whether the outline is whole.")
    curves: list[Curve] = []
    left_out: Counter[str] = Counter()
    count = 0
    for entity in document.modelspace():
        kind = printable(str(entity.dxftype()))[:40]
        try:
            if _is_hidden(document, entity):
                left_out[f"{kind} on a layer that is off or frozen"] += 1
                continue
            if kind not in _READERS:
                left_out[kind] += 1
                continue
            found = _READERS[kind](entity, name)
        except KirisurfError:
            raise
        except (ezdxf.DXFError, *_DAMAGED) as problem:
            said = printable(str(problem))[:100]
            raise UnreadableError(f"{name}: expected a sound {kind}, got a damaged one: {said}") from None
        if found is None:
            left_out[f"{kind} that is not flat"] += 1
            continue
        count += sum(curve.n_pieces for curve in found)
        check_count(count, name)
        curves += found
    if left_out:
        notes.append(f"Left out: {counted(left_out)}.")
    unit, factor = _unit(document.header.get("$INSUNITS", 0), notes)
    if factor != 1.0:
        curves = [curve.transformed(factor * np.eye(2), np.zeros(2)) for curve in curves]
    return Drawing(name, tuple(curves), unit, tuple(notes))


def _harmless_faults(content: bytes, auditor: Any, name: str) -> int:
    """Count the whole numbers that are written with a decimal point, as some programs do.

    Raises
    ------
    UnreadableError
        Where ezdxf took a part of a number, as 1 of 1d3, or one that only Python reads, as 1_000.
    """
    from ezdxf.audit import AuditError

    harmless = 0
    for entry in auditor.errors:
        guessed = _GUESSED.search(entry.message)
        if entry.code == AuditError.INVALID_INTEGER_VALUE and guessed and _WHOLE.fullmatch(guessed[1]):
            harmless += 1
        elif entry.code in (AuditError.INVALID_INTEGER_VALUE, AuditError.INVALID_FLOATING_POINT_VALUE):
            said = guessed[1] if guessed else entry.message
            raise UnreadableError(f"{name}: expected numbers, got {said[:40]!r}: the DXF is damaged")
    for code, value in _UNDERSCORE.findall(content):
        if any(int(code) in codes for codes in _NUMBER_CODES) and _TWO_NUMBERS.fullmatch(value.strip()):
            raise UnreadableError(f"{name}: expected numbers, got {value.strip()[:40].decode('ascii')!r}")
    return harmless


def _is_hidden(document: Any, entity: Any) -> bool:
    """Is an entity invisible, or on a layer that is switched off or frozen?"""
    if entity.dxf.get("invisible", 0):
        return True
    name = entity.dxf.get("layer", "0")
    if name not in document.layers:
        return False
    layer = document.layers.get(name)
    return bool(layer.is_off() or layer.is_frozen())


def _unit(code: Any, notes: list[str]) -> tuple[str | None, float]:
    if code in _UNITS:
        return _UNITS[code]
    if code in _OTHER_UNITS:
        unit, factor = _OTHER_UNITS[code]
        notes.append(f"The drawing's unit ($INSUNITS {code}) is {factor:g} {unit}: lengths are in {unit}.")
        return unit, factor
    if code:
        notes.append(f"The drawing's unit ($INSUNITS {code}) is none of a sheet's and was left out.")
    return None, 1.0


def _line(entity: Any, name: str) -> list[Curve]:
    ends = _flat([entity.dxf.start, entity.dxf.end], name)
    return [straight(ends)] if (ends[0] != ends[1]).any() else []


def _arc(entity: Any, name: str) -> list[Curve] | None:
    full = entity.dxftype() == "CIRCLE"
    normal = _upright(entity)
    if normal is None:
        return None
    radius = abs(float(entity.dxf.radius))
    angles = [0.0, 360.0] if full else [float(entity.dxf.start_angle), float(entity.dxf.end_angle)]
    check_numbers([radius, *angles], name, entity.dxftype())
    center = _flat([entity.ocs().to_wcs(entity.dxf.center)], name)[0]
    sweep = 360.0 if full else (angles[1] - angles[0]) % 360.0 or 360.0
    if radius == 0:
        return []
    # Seen from below, x runs the other way.
    half = radius * np.array([[normal, 0.0], [0.0, 1.0]])
    return [arc(center, half, math.radians(angles[0]), math.radians(sweep))]


def _ellipse(entity: Any, name: str) -> list[Curve] | None:
    if _upright(entity) is None:
        return None
    first, last = float(entity.dxf.start_param), float(entity.dxf.end_param)
    check_numbers([first, last], name, "ELLIPSE")
    half = _flat([entity.dxf.major_axis, entity.minor_axis], name)
    center = _flat([entity.dxf.center], name)[0]
    sweep = (last - first) % (2 * math.pi) or 2 * math.pi
    if math.isclose(sweep, 0.0, abs_tol=1e-12):
        sweep = 2 * math.pi
    return [arc(center, half, first, sweep)]


def _polyline(entity: Any, name: str) -> list[Curve] | None:
    if entity.dxftype() == "LWPOLYLINE":
        rows = [(x, y, bulge) for x, y, bulge in entity.get_points("xyb")]
        closed, normal = bool(entity.closed), _upright(entity)
    else:
        if not (entity.is_2d_polyline or entity.is_3d_polyline):
            return None
        # Bit 16: control points of a fitted curve, which does not go through them.
        vertices = [vertex for vertex in entity.vertices if not vertex.dxf.flags & 16]
        rows = [(*vertex.dxf.location.vec2, vertex.dxf.get("bulge", 0.0)) for vertex in vertices]
        closed, normal = bool(entity.is_closed), 1.0 if entity.is_3d_polyline else _upright(entity)
    if normal is None:
        return None
    check_numbers([value for row in rows for value in row], name, entity.dxftype())
    check_count(len(rows), name)
    if closed and rows:
        rows.append((*rows[0][:2], 0.0))
    parts = []
    for (x0, y0, bulge), (x1, y1, _) in pairwise(rows):
        ends = np.array([[normal * x0, y0], [normal * x1, y1]])
        if (ends[0] != ends[1]).any():
            parts.append(_bulged(ends, normal * bulge))
    return [joined(parts)] if parts else []


def _bulged(ends: np.ndarray, bulge: float) -> Curve:
    # The bulge is the tangent of a quarter of the arc's angle, positive where it turns left.
    if abs(bulge) < 1e-12:
        return straight(ends)
    chord = ends[1] - ends[0]
    left = np.array([-chord[1], chord[0]])
    center = 0.5 * (ends[0] + ends[1]) + (1 - bulge**2) / (4 * bulge) * left
    away = ends[0] - center
    return arc(center, float(np.hypot(*away)), math.atan2(away[1], away[0]), 4 * math.atan(bulge))


def _spline(entity: Any, name: str) -> list[Curve]:
    points = [*entity.control_points, *entity.fit_points]
    check_count(len(points), name)
    check_numbers(np.array([list(point)[:2] for point in points]), name, "SPLINE")
    tool = entity.construction_tool()
    exact = tool.degree <= 3 and not tool.is_rational
    parts = []
    for piece in tool.bezier_decomposition() if exact else _cubics(tool):
        control = _flat(list(piece), name)
        if (control != control[0]).any():
            parts.append(bezier(control))
    return [joined(parts)] if parts else []


def _cubics(tool: Any) -> Iterator[np.ndarray]:
    # Of higher degree or rational: cubics with the points and derivatives of the spline at many parameters.
    knots = np.unique(np.asarray(tool.knots()))
    knots = knots[(knots >= tool.knots()[tool.order - 1]) & (knots <= tool.knots()[-tool.order])]
    for a, b in pairwise(knots):
        t = np.linspace(a, b, _CUBICS + 1)
        # Derivatives at a knot are those of the span that begins there: the last ones come from just before it.
        inside = np.append(t[:-1], b - 1e-9 * (b - a))
        rows = np.array([[list(value)[:2] for value in tool.derivative(place, 1)] for place in inside])
        for (p, v), (q, w) in pairwise(rows):
            third = (t[1] - t[0]) / 3
            yield np.array([p, p + third * v, q - third * w, q])


def _upright(entity: Any) -> float | None:
    # 1 or -1 for a normal along z; None for a plane that is tilted.
    x, y, z = entity.dxf.get("extrusion", (0.0, 0.0, 1.0))
    size = math.sqrt(x * x + y * y + z * z)
    if not size > 0 or math.hypot(x, y) > _FLAT * size:
        return None
    return math.copysign(1.0, z)


def _flat(points: list[Any], name: str) -> np.ndarray:
    values = np.array([[float(point[0]), float(point[1])] for point in points])
    check_numbers(values, name, "coordinates")
    return values


_READERS = {
    "LINE": _line,
    "ARC": _arc,
    "CIRCLE": _arc,
    "ELLIPSE": _ellipse,
    "LWPOLYLINE": _polyline,
    "POLYLINE": _polyline,
    "SPLINE": _spline,
}
