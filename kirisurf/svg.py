"""The cut pattern as an SVG drawing to scale, with the layers cut, hinge and outline."""

from __future__ import annotations

from xml.sax.saxutils import escape

import numpy as np

from kirisurf.cuts import Cuts
from kirisurf.units import checked_unit

# Every length unit as a multiple of a unit that SVG knows.
_SVG_UNITS = {
    "um": (0.001, "mm"),
    "mm": (1.0, "mm"),
    "cm": (1.0, "cm"),
    "m": (1000.0, "mm"),
    "in": (1.0, "in"),
    "ft": (12.0, "in"),
}
_LAYERS = (("cut", "#d00000"), ("hinge", "#0060d0"), ("outline", "#000000"))
_MARGIN = 0.02  # of the longer side


def svg_text(
    lines: Cuts,
    units: str | None = None,
    title: str = "kirisurf cut pattern",
    page: tuple[float, float] | None = None,
) -> str:
    """Return the cut pattern as SVG text.

    One coordinate of the viewBox is one unit of the page (mm, cm or in), so the drawing is to scale. The
    y axis points up in the points and down on the page: the drawing shows the sheet's front, not mirrored.

    Parameters
    ----------
    lines : Cuts
    units : str, optional
        Length unit of the points: um, mm, cm, m, in or ft; None is taken as mm, and the file says so.
    title : str
    page : (width, height), optional
        Size of the drawing, from the origin of the points on; by default the pattern with a margin.

    Raises
    ------
    ParameterError
        Where the unit is unknown.

    Examples
    --------
    >>> from kirisurf.cuts import cuts
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> svg_text(cuts(pattern, 10 * pattern.contracted)).splitlines()[1][:30]
    '<svg xmlns="http://www.w3.org/'
    """
    unit = "mm" if units is None else units
    factor, page_unit = _SVG_UNITS[checked_unit(unit)]
    low, high = lines.box
    margin = _MARGIN * float((high - low).max())
    low, high = (low - margin, high + margin) if page is None else (np.zeros(2), np.array(page, dtype=float))
    width, height = factor * (high - low)

    def placed(points: np.ndarray) -> np.ndarray:
        return factor * np.stack([points[:, 0] - low[0], high[1] - points[:, 1]], axis=1)

    said = f"{unit}" if units is not None else "mm (assumed: the target names no unit; set it with --units)"
    radius = 0.5 * factor * lines.hinge_width
    contents = {
        "cut": [f'<path d="{_path(placed(line))}"/>' for line in lines.slits],
        "hinge": [
            f'<circle cx="{_number(x)}" cy="{_number(y)}" r="{_number(radius)}"/>' for x, y in placed(lines.hinges)
        ],
        "outline": [f'<path d="{_path(placed(loop))} Z"/>' for loop in (lines.outline, *lines.openings)],
    }
    text = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
        f'version="1.1" width="{_number(width)}{page_unit}" height="{_number(height)}{page_unit}" '
        f'viewBox="0 0 {_number(width)} {_number(height)}">',
        f"<title>{escape(title)}</title>",
        f"<desc>To scale. Units of the target: {said}. Coordinates of this file: {page_unit}. "
        f"Hinge width: {_number(factor * lines.hinge_width)} {page_unit}. Compensated for a kerf of "
        f"{_number(factor * lines.kerf)} {page_unit}. {len(lines.slits)} slits.</desc>",
    ]
    # thin enough to see the ligaments, whatever the size of the page
    stroke = _number(min(0.001 * max(width, height), 0.25 * factor * lines.hinge_width))
    for name, color in _LAYERS:
        text.append(
            f'<g id="{name}" inkscape:groupmode="layer" inkscape:label="{name}" fill="none" '
            f'stroke="{color}" stroke-width="{stroke}">'
        )
        text += contents[name]
        text.append("</g>")
    text.append("</svg>")
    return "\n".join(text) + "\n"


def _path(points: np.ndarray) -> str:
    return "M " + " L ".join(f"{_number(x)},{_number(y)}" for x, y in points)


def _number(value: float) -> str:
    """Twelve significant digits: finer than any cutter, coarse enough to hide the last bit of rounding."""
    text = f"{float(value):.12g}"
    return "0" if text == "-0" else text
