"""Outlines from tables of points: separators, corners found and marked, smooth runs, refusals."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from kirisurf.errors import ParameterError, UnreadableError, UnusableError
from kirisurf.outlines import Outline, outline, read_outline

SQUARE = [(0, 0), (2, 0), (2, 1.5), (0, 1.5)]


def _read(folder: Path, text: str | bytes, units: str | None = None) -> tuple[Outline, tuple[str, ...]]:
    path = folder / "points.csv"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return read_outline(path, units)


@pytest.mark.parametrize("separator", [",", ", ", ";", "\t", " ", "   "])
@pytest.mark.parametrize("header", ["", "x{}y\n", "# a comment\n\nx{}y\n"])
@pytest.mark.parametrize("closed", [False, True])
def test_separators_headers_and_a_repeated_first_point(
    separator: str, header: str, closed: bool, tmp_path: Path
) -> None:
    rows = SQUARE + SQUARE[:1] * closed
    text = header.format(separator) + "".join(f"{x}{separator}{y}\r\n" for x, y in rows)
    found, notes = _read(tmp_path, text)
    assert found.n_corners == 4 and found.units is None
    np.testing.assert_allclose(found.area, 3.0, rtol=1e-15)
    assert len(notes) == 2 and notes[1] == "The file names no unit of length."


@pytest.mark.parametrize("separator", [";", "\t"])
def test_decimal_commas(separator: str, tmp_path: Path) -> None:
    text = f"x{separator}y\n0{separator}0\n2,5{separator}0\n2,5{separator}1,5\n0{separator}1,5\n"
    assert _read(tmp_path, text)[0].area == pytest.approx(3.75)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_encodings(encoding: str, tmp_path: Path) -> None:
    text = "# Länge\n" + "\n".join(f"{x},{y}" for x, y in SQUARE)
    assert _read(tmp_path, text.encode(encoding))[0].area == pytest.approx(3)


def test_columns_are_found_by_name(tmp_path: Path) -> None:
    text = "id,Y,X\n" + "\n".join(f"{k},{y},{x}" for k, (x, y) in enumerate(SQUARE))
    # The third column is the number of the point.
    with pytest.raises(UnusableError, match="third column that varies"):
        _read(tmp_path, text)
    text = "Y,X,z\n" + "\n".join(f"{y},{x},0" for x, y in SQUARE)
    found, notes = _read(tmp_path, text)
    assert found.area == pytest.approx(3) and "Columns beyond x and y were left out." in notes


def test_units_are_those_of_the_caller(tmp_path: Path) -> None:
    text = "\n".join(f"{x},{y}" for x, y in SQUARE)
    found, notes = _read(tmp_path, text, "cm")
    assert found.units == "cm" and found.area == pytest.approx(3) and len(notes) == 1
    with pytest.raises(ParameterError, match="expected one of um, mm"):
        _read(tmp_path, text, "px")


def test_clockwise_points_are_turned_and_repeated_ones_left_out(tmp_path: Path) -> None:
    rows = [point for point in SQUARE[::-1] for _ in range(2)]
    found, notes = _read(tmp_path, "\n".join(f"{x},{y}" for x, y in rows))
    assert found.area == pytest.approx(3) and found.n_corners == 4
    assert "4 repeated points were left out." in notes
    assert "The points ran clockwise and were turned counter-clockwise." in notes


@pytest.mark.parametrize("name", ["disc", "ellipse", "rainbow", "star", "heart", "letter-s"])
@pytest.mark.parametrize("offset", [0.0, 0.5])
def test_fine_samples_give_the_smooth_outline_back(name: str, offset: float, tmp_path: Path) -> None:
    original = outline(name)
    errors = []
    for n in (40, 80):
        rows = np.concatenate([side.points(side.evenly(n)[:-1]) for side in original.sides])
        if offset and original.n_corners:
            # No sample is at a corner: it lies within a segment, whose ends share the turn.
            rows = np.concatenate(
                [side.points(0.5 * (side.evenly(n)[1:] + side.evenly(n)[:-1])) for side in original.sides]
            )
        found, _ = _read(tmp_path, "\n".join(f"{x!r},{y!r}" for x, y in rows.tolist()))
        errors.append(np.abs(original.project(found.polyline(0.01)).distances).max())
        if not offset:
            assert found.n_corners == original.n_corners and found.is_smooth == original.is_smooth
    if not offset:
        assert errors[1] < 1e-3 * original.diagonal
        # Of fourth order where the curvature does not jump, as it does along the heart and the S.
        assert errors[1] < 1e-13 or errors[1] < errors[0] / 10 or name in ("heart", "letter-s")
    else:
        assert errors[1] < 0.03 * original.diagonal


def test_a_shared_turn_is_one_corner(tmp_path: Path) -> None:
    # Two arcs that meet at 32 degrees, cut off between two samples.
    t = np.radians(np.arange(8) * 2 + 9)
    right = np.stack([np.cos(t), np.sin(t)], axis=1) - [np.cos(t[0]) - 0.02, np.sin(t[0])]
    rows = np.concatenate([right, [[-1, 1], [-1, -1]], (right * [1, -1])[::-1]])
    found, _ = _read(tmp_path, "\n".join(f"{x!r},{y!r}" for x, y in rows.tolist()))
    assert found.n_corners >= 4


def test_straight_runs_stay_straight_and_arcs_become_smooth(tmp_path: Path) -> None:
    # A stadium: two half circles of 40 segments, two long straight segments.
    t = np.linspace(-np.pi / 2, np.pi / 2, 41)
    right = np.stack([3 + np.cos(t), np.sin(t)], axis=1)
    rows = np.concatenate([right, -right])
    found, notes = _read(tmp_path, "\n".join(f"{x!r},{y!r}" for x, y in rows.tolist()))
    assert found.is_smooth and "without corners" in notes[0]
    np.testing.assert_allclose(found.area, math.pi + 12, rtol=1e-6)
    along = np.stack([np.linspace(-2.9, 2.9, 30), np.ones(30)], axis=1)
    assert np.abs(found.project(along).distances).max() < 1e-14


def test_polygons_of_few_points_stay_polygons(tmp_path: Path) -> None:
    # A house with walls that turn by 15 degrees: no curve runs along them.
    rows = [(0, 0), (4, 0), (8, 1.07), (8, 5), (0, 5)]
    found, notes = _read(tmp_path, "\n".join(f"{x},{y}" for x, y in rows))
    assert found.n_corners == 4 and "4 straight segments and 0 smooth" in notes[0].replace("are ", "")
    middle = np.array([[2.0, 0.0], [6.0, 0.535]])
    assert np.abs(found.project(middle).distances).max() < 1e-14


def test_marks_are_the_corners(tmp_path: Path) -> None:
    t = np.linspace(0, 2 * np.pi, 49)[:-1]
    rows = [(float(np.cos(a)), float(np.sin(a)), int(k % 12 == 6)) for k, a in enumerate(t)]
    for header, shown in (("", "{}"), ("x,y,corner\n", "{}")):
        text = header + "\n".join(f"{x},{y},{shown.format(mark)}" for x, y, mark in rows)
        found, notes = _read(tmp_path, text)
        assert found.n_corners == 4 and notes[0] == "4 points are marked as corners."
        half = math.sqrt(0.5)
        np.testing.assert_allclose(np.abs(found.corners), half, rtol=1e-12)
    words = "x,y,corner\n" + "\n".join(f"{x},{y}{',corner' if mark else ''}" for x, y, mark in rows)
    assert _read(tmp_path, words)[0].n_corners == 4
    none = "x,y,corner\n" + "\n".join(f"{x},{y},0" for x, y, _ in rows)
    assert _read(tmp_path, none)[0].is_smooth


def test_a_wide_gap_is_told_of(tmp_path: Path) -> None:
    t = np.linspace(0, 1.5 * np.pi, 60)
    _, notes = _read(tmp_path, "\n".join(f"{math.cos(a)},{math.sin(a)}" for a in t))
    assert any("closed by a straight segment" in note for note in notes)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x,y\n1,2\n3,four\n5,6\n", "line 3, got '3 four'"),
        ("1,2\n3\n5,6\n", "in line 2, got '3'"),
        ("1_0,2\n3,4\n5,6\n7,8\n1_0,3", "line 1"),
        ("x,y,corner\n1,2,0\n3,4,maybe\n5,0,0\n", "expected 1 or 0 in the column corner, got 'maybe'"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00", "binary content"),
        (b"\xff\xfe\x00", "utf-16 text"),
        (b"\xef\xbb\xbf\xff\xff", "utf-8-sig text"),
        (b"\x1f\x8b\x08\x00", "gzip"),
        ("hello world\nthis is prose\n", "two numbers x, y in line 2"),
    ],
)
def test_other_content_is_unreadable(text: str | bytes, message: str, tmp_path: Path) -> None:
    with pytest.raises(UnreadableError, match=message):
        _read(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty file"),
        (" \n \n", "empty file"),
        ("# nothing\n", "comments alone"),
        ("x,y\n", "three different points or more, got 0"),
        ("1,2\n3,4\n", "three different points or more, got 2"),
        ("1,2\n3,4\n1,2\n3,4\n1,2", "curve"),
        ("1,2\n1,2\n1,2\n", "all vertices in one place"),
        ("0,0\n1,0\n2,0\n", "expected a curve"),
        ("0,0\n1,nan\n1,1\n", "finite numbers in line 2, got 1, nan"),
        ("0,0\n1,1\n-inf,1\n", "finite numbers in line 3"),
        ("0,0\n1e999,1\n1,1\n", "finite numbers in line 2"),
        ("0,0\n1e99,0\n0,1e99\n", "smaller numbers"),
        ("0,0\n1e-80,0\n0,1e-80\n", "larger than"),
        ("1e20,0\n1e20,1\n1.0000000000000001e20,1\n", "one place|times its size"),
        ("0,0\n2,2\n2,0\n0,2\n", r"cross itself, got one that does at \(1, 1\)"),
        ("0,0,0\n1,0,1\n1,1,5\n", "third column that varies"),
        ("1,2\n" * 100_002, "at most 100000 points, got 100002"),
    ],
)
def test_points_without_an_outline_are_unusable(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(UnusableError, match=message):
        _read(tmp_path, text)


def test_jagged_outlines_are_refused(tmp_path: Path) -> None:
    t = np.arange(3000)
    r = 1 + 0.2 * (t % 2)
    rows = np.stack([r * np.cos(t / 3000 * 2 * np.pi), r * np.sin(t / 3000 * 2 * np.pi)], axis=1)
    with pytest.raises(UnusableError, match="at most 1000 corners, got 3000"):
        _read(tmp_path, "\n".join(f"{x},{y}" for x, y in rows))


def test_files_that_are_none_are_unreadable(tmp_path: Path) -> None:
    with pytest.raises(UnreadableError, match="No such file"):
        read_outline(tmp_path / "absent.csv")
    with pytest.raises(UnreadableError, match=r"expected an outline as .svg, .dxf, .csv, got .pdf"):
        read_outline(tmp_path / "drawing.pdf")
    with pytest.raises(UnreadableError, match="got no suffix"):
        read_outline(tmp_path / "drawing")
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(UnreadableError, match="got a folder"):
        read_outline(tmp_path / "folder.csv")
    (tmp_path / "large.csv").write_text("1,2\n" * 1000)
    with pytest.raises(UnreadableError, match=r"expected at most 0.001 MB"):
        read_outline(tmp_path / "large.csv", limit_mb=0.001)
