"""Outlines from DXF, written by ezdxf: every entity, units, chains, and what must be refused."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from kirisurf.errors import KirisurfError, UnreadableError, UnusableError
from kirisurf.outlines import Outline, read_outline


def _document(draw: Callable[[Any], object], units: int = 4) -> bytes:
    document = ezdxf.new("R2010", units=units)
    draw(document.modelspace())
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def _read(
    folder: Path, draw: Callable[[Any], object], units: int = 4, wanted: str | None = None
) -> tuple[Outline, tuple[str, ...]]:
    path = folder / "drawing.dxf"
    path.write_bytes(_document(draw, units))
    return read_outline(path, wanted)


DOWN = {"extrusion": (0, 0, -1)}
HALF = math.sqrt(0.5)


def _stadium(space: Any) -> None:
    space.add_line((0, 0), (4, 0))
    space.add_line((0, 2), (4, 2))
    space.add_arc((4, 1), 1, -90, 90)
    space.add_arc((0, 1), 1, 90, 270)


def _spline_circle(space: Any) -> None:
    points = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
    space.add_rational_spline(points, [1, HALF] * 4 + [1], degree=2, knots=knots)


CASES: dict[str, tuple[Callable[[Any], object], float, int]] = {
    "lwpolyline": (lambda s: s.add_lwpolyline([(0, 0), (3, 0), (3, 2), (0, 2)], close=True), 6.0, 4),
    "closed by a repeated point": (lambda s: s.add_lwpolyline([(0, 0), (3, 0), (3, 2), (0, 0)]), 3.0, 3),
    "bulge": (
        lambda s: s.add_lwpolyline([(0, 0, 0), (2, 0, 1), (2, 2, 0), (0, 2, 0)], format="xyb", close=True),
        4 + math.pi / 2,
        2,
    ),
    "hollow bulge": (
        lambda s: s.add_lwpolyline([(0, 0, 0), (2, 0, -1), (2, 2, 0), (0, 2, 0)], format="xyb", close=True),
        4 - math.pi / 2,
        4,
    ),
    "bulge seen from below": (
        lambda s: s.add_lwpolyline(
            [(0, 0, 0), (2, 0, 1), (2, 2, 0), (0, 2, 0)], format="xyb", close=True, dxfattribs=DOWN
        ),
        4 + math.pi / 2,
        2,
    ),
    "two half circles": (
        lambda s: s.add_lwpolyline([(0, 0, 1), (2, 0, 1)], format="xyb", close=True),
        math.pi,
        0,
    ),
    "polyline": (
        lambda s: s.add_polyline2d([(0, 0, 0), (2, 0, 1), (2, 2, 0), (0, 2, 0)], format="xyb", close=True),
        4 + math.pi / 2,
        2,
    ),
    "polyline in space": (lambda s: s.add_polyline3d([(0, 0, 1), (3, 0, 1), (3, 2, 1)], close=True), 3.0, 3),
    "circle": (lambda s: s.add_circle((5, 6), 2), 4 * math.pi, 0),
    "ellipse": (lambda s: s.add_ellipse((5, 6), (2, 1), 0.5), 2.5 * math.pi, 0),
    "half ellipse": (
        lambda s: (s.add_ellipse((0, 0), (2, 0), 0.5, 0, math.pi), s.add_line((-2, 0), (2, 0))),
        math.pi,
        2,
    ),
    "lines and arcs": (_stadium, 8 + math.pi, 0),
    "spline": (
        lambda s: (s.add_open_spline([(0, 0), (0, 4), (4, 4), (4, 0)]), s.add_line((4, 0), (0, 0))),
        # A cubic Bezier piece: 3/20 of the sums over its control points.
        0.15 * 4 * 4 * 4,
        2,
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_entities_have_their_area(case: str, tmp_path: Path) -> None:
    draw, area, corners = CASES[case]
    found, _ = _read(tmp_path, draw)
    np.testing.assert_allclose(found.area, area, rtol=1e-12)
    assert found.n_corners == corners and found.units == "mm"


def test_seen_from_below_x_is_mirrored(tmp_path: Path) -> None:
    found, _ = _read(tmp_path, lambda s: s.add_circle((5, 6), 2, dxfattribs=DOWN))
    np.testing.assert_allclose(found.box, [[-7, 4], [-3, 8]], atol=1e-12)
    arcs, _ = _read(
        tmp_path,
        lambda s: (s.add_arc((5, 6), 2, 0, 90, dxfattribs=DOWN), s.add_lwpolyline([(-7, 6), (-5, 6), (-5, 8)])),
    )
    np.testing.assert_allclose(arcs.area, math.pi, rtol=1e-12)


def test_rational_splines_are_close_to_their_curve(tmp_path: Path) -> None:
    found, _ = _read(tmp_path, _spline_circle)
    assert found.is_smooth
    assert np.abs(np.linalg.norm(found.polyline(0.01), axis=1) - 1).max() < 1e-7
    np.testing.assert_allclose(found.area, math.pi, rtol=1e-7)


def test_splines_of_degree_five_go_through_their_points(tmp_path: Path) -> None:
    control = [(0, 0), (0, 3), (2, 5), (4, 5), (6, 3), (6, 0)]
    found, _ = _read(tmp_path, lambda s: (s.add_open_spline(control, degree=5), s.add_line((0, 0), (6, 0))))
    t = np.linspace(0, 1, 101)[:, None]
    p = np.array(control, dtype=float)
    exact = sum(math.comb(5, k) * t**k * (1 - t) ** (5 - k) * p[k] for k in range(6))
    assert np.abs(found.project(np.asarray(exact)).distances).max() < 1e-6


@pytest.mark.parametrize(
    ("code", "units", "factor"),
    [(1, "in", 1), (2, "ft", 1), (4, "mm", 1), (5, "cm", 1), (6, "m", 1), (13, "um", 1), (14, "cm", 10), (10, "ft", 3)],
)
def test_units_are_those_of_the_header(code: int, units: str, factor: float, tmp_path: Path) -> None:
    found, notes = _read(tmp_path, lambda s: s.add_circle((0, 0), 2), code)
    assert found.units == units
    np.testing.assert_allclose(found.area, 4 * math.pi * factor**2, rtol=1e-12)
    assert any("$INSUNITS" in note for note in notes) == (factor != 1)


def test_drawings_without_a_unit_take_the_callers(tmp_path: Path) -> None:
    found, notes = _read(tmp_path, lambda s: s.add_circle((0, 0), 2), 0)
    assert found.units is None and notes == ("The file names no unit of length.",)
    found, notes = _read(tmp_path, lambda s: s.add_circle((0, 0), 2), 0, "m")
    assert found.units == "m" and notes == ()
    _, notes = _read(tmp_path, lambda s: s.add_circle((0, 0), 2), 18)
    assert "none of a sheet's" in notes[0]


def test_chains_are_joined_in_any_order(tmp_path: Path) -> None:
    corners = np.array([[0, 0], [5, 0], [6, 3], [2, 5], [-1, 2.0]])
    edges = [(corners[k], corners[(k + 1) % 5]) for k in range(5)]
    for seed in range(5):
        rng = np.random.default_rng(seed)

        def draw(space: Any, rng: np.random.Generator = rng) -> None:
            for k in rng.permutation(5):
                a, b = edges[k][:: int(rng.choice([-1, 1]))]
                # Rounded to four decimals, as many programs write them.
                space.add_line(np.round(a + rng.uniform(-4e-5, 4e-5, 2), 4), b)

        found, _ = _read(tmp_path, draw)
        assert found.n_corners == 5 and found.area == pytest.approx(24.0, abs=1e-2)


def test_many_short_lines_become_one_smooth_curve(tmp_path: Path) -> None:
    t = np.linspace(0, 2 * np.pi, 1001)
    points = np.round(np.stack([100 * np.cos(t), 60 * np.sin(t)], axis=1), 4)

    def draw(space: Any) -> None:
        for a, b in pairwise(points):
            space.add_line(a, b)

    found, _ = _read(tmp_path, draw)
    assert found.is_smooth
    np.testing.assert_allclose(found.area, 6000 * math.pi, rtol=1e-6)


def test_junctions_and_what_is_left_out_are_told_of(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_circle((0, 0), 10)
        space.add_circle((0, 0), 3)
        for x, y in ((1, 0), (0, 1), (-1, -1)):
            space.add_line((50, 50), (50 + x, 50 + y))
        space.add_text("part 7")
        space.add_circle((0, 0), 99, dxfattribs={"extrusion": (0, 1, 1)})

    found, notes = _read(tmp_path, draw)
    assert found.area == pytest.approx(100 * math.pi)
    text = " ".join(notes)
    assert "Left out: 1 CIRCLE that is not flat, 1 TEXT." in text
    assert "More than two ends meet at (50, 50)" in text
    assert "The largest of 2 closed curves is the outline. 1 inside it was left out" in text
    assert "3 open curves were left out." in text


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda s: None, "drawing without curves"),
        (lambda s: s.add_text("O"), "Left out: 1 TEXT"),
        (lambda s: s.add_line((0, 0), (1, 1)), "1 open ones"),
        (lambda s: s.add_line((1, 1), (1, 1)), "without curves"),
        (lambda s: s.add_lwpolyline([(0, 0), (2, 2), (2, 0), (0, 2)], close=True), r"does at \(1, 1\)"),
        (lambda s: s.add_lwpolyline([(0, 0), (2, 2)], close=True), "expected a curve"),
        (lambda s: s.add_lwpolyline([(0, 0), (1e99, 2), (0, 3)], close=True), "smaller numbers"),
        (lambda s: s.add_lwpolyline([(0, 0), (math.inf, 2), (0, 3)], close=True), "finite numbers|closed curve"),
        (lambda s: s.add_circle((0, 0), 0), "without curves"),
        (lambda s: s.add_arc((0, 0), 1, 0, 90), "1 open ones"),
    ],
)
def test_drawings_without_an_outline_are_unusable(draw: Callable[[Any], object], message: str, tmp_path: Path) -> None:
    with pytest.raises(UnusableError, match=message):
        _read(tmp_path, draw)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"AutoCAD Binary DXF\r\n\x1a\x00" + b"\0" * 50, "binary DXF"),
        (b"AC1027" + b"\0" * 100, "DWG"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "expected DXF"),
        (b"hello world\n" * 10, "expected DXF"),
        (b"\0" * 1000, "expected DXF"),
        (b"0\nSECTION\n", "expected DXF|without curves"),
    ],
)
def test_other_content_is_refused(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "drawing.dxf"
    path.write_bytes(content)
    with pytest.raises((UnreadableError, UnusableError), match=message):
        read_outline(path)


def test_damaged_drawings_never_end_in_another_error(tmp_path: Path) -> None:
    path = tmp_path / "drawing.dxf"

    def draw(space: Any) -> None:
        _stadium(space)
        _spline_circle(space)
        space.add_ellipse((5, 6), (2, 1), 0.5)
        space.add_lwpolyline([(0, 0, 1), (2, 0, 1)], format="xyb", close=True)

    lines = _document(draw).split(b"\n")
    first = lines.index(b"ENTITIES")
    rng = np.random.default_rng(0)
    hostile = [b"nan", b"inf", b"1e308", b"-1", b"x", b"", b"999999999", b"SPLINE"]
    for _ in range(60):
        damaged = list(lines)
        for place in rng.integers(first, len(lines) - 4, 4):
            damaged[place] = hostile[int(rng.integers(len(hostile)))]
        path.write_bytes(b"\n".join(damaged[: None if rng.integers(4) else int(rng.integers(first, len(lines)))]))
        try:
            found, _notes = read_outline(path)
        except KirisurfError:
            continue
        assert found.area > 0


def test_layers_that_are_off_are_left_out(tmp_path: Path) -> None:
    document = ezdxf.new("R2010")
    document.layers.add("HIDDEN").off()
    document.layers.add("COLD").freeze()
    for radius, layer in ((100.0, "HIDDEN"), (200.0, "COLD"), (30.0, "0")):
        document.modelspace().add_circle((0, 0), radius, dxfattribs={"layer": layer})
    document.saveas(tmp_path / "layers.dxf")
    found, notes = read_outline(tmp_path / "layers.dxf")
    assert found.area == pytest.approx(900 * math.pi, rel=1e-12)
    assert any("2 CIRCLE on a layer that is off or frozen" in note for note in notes)
