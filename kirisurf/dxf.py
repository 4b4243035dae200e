"""The cut pattern as DXF for laser cutters and CAD: layers CUT, OUTLINE and HINGE, with its unit."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager

from kirisurf.cuts import Cuts
from kirisurf.dxf_library import load_dxf_library
from kirisurf.units import checked_unit

# $INSUNITS of every length unit (DXF reference, header variables).
_INSERT_UNITS = {"um": 13, "mm": 4, "cm": 5, "m": 6, "in": 1, "ft": 2}
_IMPERIAL = ("in", "ft")
_LAYERS = (("CUT", 1), ("OUTLINE", 7), ("HINGE", 5))  # color numbers: red, black or white, blue


def dxf_text(lines: Cuts, units: str | None = None) -> str:
    """Return the cut pattern as DXF text (release 2000, which every laser program reads).

    Slits are open polylines of the layer CUT; the outline and designed openings are closed ones of the
    layer OUTLINE, to be cut last. Ligaments are points of the layer HINGE, which is switched off and never
    plotted: nothing there may be cut. Coordinates are those of the points, to full precision; `$INSUNITS`
    names their unit.

    Parameters
    ----------
    lines : Cuts
    units : str, optional
        Length unit of the points: um, mm, cm, m, in or ft; None is taken as mm.

    Raises
    ------
    ParameterError
        Where the unit is unknown.

    Examples
    --------
    >>> from kirisurf.cuts import cuts
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> dxf_text(cuts(pattern, 10 * pattern.contracted), "mm").count("LWPOLYLINE")
    16
    """
    load_dxf_library()
    import ezdxf

    unit = "mm" if units is None else units
    with _same_bytes():
        document = ezdxf.new("R2000", units=_INSERT_UNITS[checked_unit(unit)])
        document.header["$MEASUREMENT"] = 0 if unit in _IMPERIAL else 1
        for name, color in _LAYERS:
            document.layers.add(name, color=color)
        hinge = document.layers.get("HINGE")
        hinge.off()
        hinge.dxf.plot = 0
        space = document.modelspace()
        for slit in lines.slits:
            space.add_lwpolyline(slit.tolist(), format="xy", dxfattribs={"layer": "CUT"})
        for loop in (*lines.openings, lines.outline):
            space.add_lwpolyline(loop.tolist(), format="xy", close=True, dxfattribs={"layer": "OUTLINE"})
        for x, y in lines.hinges.tolist():
            space.add_point((x, y), dxfattribs={"layer": "HINGE"})
        low, high = lines.box
        space.reset_extents((*low.tolist(), 0.0), (*high.tolist(), 0.0))
        stream = io.StringIO()
        document.write(stream)
    return stream.getvalue()


@contextmanager
def _same_bytes() -> Iterator[None]:
    """Let ezdxf write no time and no random identifier: the same pattern gives the same file."""
    import ezdxf

    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before
