"""DXF of the cut pattern, read back with ezdxf: lengths, layers, units, and the same bytes every time."""

from __future__ import annotations

import io

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing

from kirisurf.cuts import Cuts, cuts
from kirisurf.dxf import dxf_text
from kirisurf.errors import ParameterError
from kirisurf.units import UNITS
from tests.kirisurf.patterns import NAMES, bent, pattern


def lines_of(name: str, kerf: float = 0.5) -> Cuts:
    tessellation = pattern(name)
    return cuts(tessellation, 70 * bent(tessellation, 0.03), 2.0, kerf)


def parsed(text: str) -> Drawing:
    document = ezdxf.read(io.StringIO(text))
    assert document.audit().errors == []
    return document


def polylines(document: Drawing, layer: str) -> list[tuple[bool, np.ndarray]]:
    found = document.modelspace().query(f'LWPOLYLINE[layer=="{layer}"]')
    return [(line.closed, np.array(list(line.get_points("xy")))) for line in found]


@pytest.mark.parametrize("name", NAMES)
def test_the_lines_come_back_exactly(name: str) -> None:
    lines = lines_of(name)
    document = parsed(dxf_text(lines, "mm"))
    cut, outline = polylines(document, "CUT"), polylines(document, "OUTLINE")
    assert not any(closed for closed, _ in cut) and all(closed for closed, _ in outline)
    for (_, drawn), line in zip(cut, lines.slits, strict=True):
        assert np.array_equal(drawn, line)
    for (_, drawn), loop in zip(outline, (*lines.openings, lines.outline), strict=True):
        assert np.array_equal(drawn, loop)
    marks = [tuple(point.dxf.location)[:2] for point in document.modelspace().query("POINT")]
    assert np.array_equal(np.array(marks), lines.hinges)
    assert len(document.modelspace()) == len(cut) + len(outline) + len(marks)


def test_nothing_but_cuts_and_outline_is_visible() -> None:
    layers = parsed(dxf_text(lines_of("rectangle"), "mm")).layers
    assert {"CUT", "OUTLINE", "HINGE"} <= {layer.dxf.name for layer in layers}
    assert layers.get("CUT").is_on() and layers.get("OUTLINE").is_on()
    assert layers.get("HINGE").is_off() and not layers.get("HINGE").dxf.plot


# a metre in every unit, by the names that ezdxf gives to $INSUNITS
@pytest.mark.parametrize(
    ("unit", "name"),
    [("um", "micron"), ("mm", "mm"), ("cm", "cm"), ("m", "m"), ("in", "in"), ("ft", "ft"), (None, "mm")],
)
def test_the_unit_is_in_the_file(unit: str | None, name: str) -> None:
    document = parsed(dxf_text(lines_of("rectangle"), unit))
    names = {13: "micron", 4: "mm", 5: "cm", 6: "m", 1: "in", 2: "ft"}
    assert names[document.header["$INSUNITS"]] == name
    assert document.header["$MEASUREMENT"] == (0 if unit in ("in", "ft") else 1)


def test_every_unit_of_a_spec_is_known_and_no_other() -> None:
    for unit in UNITS:
        dxf_text(lines_of("rectangle"), unit)
    with pytest.raises(ParameterError, match="units: expected one of"):
        dxf_text(lines_of("rectangle"), "parsec")


def test_the_extents_are_those_of_the_cut() -> None:
    lines = lines_of("trimmed")
    header = parsed(dxf_text(lines, "mm")).header
    assert tuple(header["$EXTMIN"])[:2] == pytest.approx(lines.box[0])
    assert tuple(header["$EXTMAX"])[:2] == pytest.approx(lines.box[1])


def test_the_same_pattern_gives_the_same_bytes() -> None:
    before = ezdxf.options.write_fixed_meta_data_for_testing
    assert dxf_text(lines_of("trimmed"), "mm") == dxf_text(lines_of("trimmed"), "mm")
    assert ezdxf.options.write_fixed_meta_data_for_testing == before
