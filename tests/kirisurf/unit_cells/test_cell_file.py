"""Unit cells from files: what is read, what is refused, and that the message names the line."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.pattern import tile_pattern
from kirisurf.unit_cell import quad_cell
from kirisurf.unit_cells import parse_cell, read_cell
from kirisurf.unit_cells.arithmetic import LONGEST, parse_number
from kirisurf.unit_cells.catalog import FILES

# Line by line: name 1, title 2, columns 3, rows 4, points 5-16, tiles 17-20.
SQUARES = """\
name squares
title half open, in cm
columns 4 0  5.6 0
rows 0 4  0 5.6
point 0 0  0 0
point 2 0  1.6 1.2
point 2 2  0.4 2.8
point 0 2  -1.2 1.6
point 4 0  3.2 0   # turned by arctan(3/4)
point 4 2  4.4 1.6
point 2 2  2.8 2.8
point 0 2  -1.2 4
point 2 4  1.6 4.4
point 0 4  0 5.6
point 4 2  4.4 4
point 4 4  3.2 5.6
tile 1 2 3 4
tile 2 5 6 7
tile 8 3 9 10
tile 7 11 12 9
"""


def changed(line: int, text: str) -> str:
    lines = SQUARES.splitlines()
    lines[line - 1] = text
    return "\n".join(lines)


def test_a_cell_is_read_at_unit_area() -> None:
    cell = parse_cell(SQUARES)
    assert cell.name == "squares"
    assert cell.area == pytest.approx(1)
    np.testing.assert_allclose(cell.stretches, 1.4, atol=1e-12)
    np.testing.assert_allclose(cell.stretches, quad_cell(np.arctan2(3, 4)).stretches, atol=1e-12)


def test_remarks_blank_lines_and_other_line_ends_change_nothing() -> None:
    text = "# remark\r\n\r\n" + SQUARES.replace("\n", "  # so\r\n\r\n")
    np.testing.assert_array_equal(parse_cell(text).deployed, parse_cell(SQUARES).deployed)


@pytest.mark.parametrize("file", sorted(FILES.iterdir()), ids=lambda file: file.stem)
def test_bundled_cells_are_read(file: Path) -> None:
    assert read_cell(file).name == file.stem


@pytest.mark.parametrize(
    ("line", "text", "message"),
    [
        (1, "name two words", "line 1: expected a name of letters"),
        (2, "name again", "line 2: expected one line 'name', got a second"),
        (3, "columns 4 0 5.6", "line 3: expected x y contracted and x y deployed, got 3 numbers"),
        (5, "point 0 0 0 zero", "line 5: expected a number such as 0.5 or sqrt"),
        (6, "point 2 0 1.6 1.2 0", "line 6: .* got 5 numbers"),
        (7, "corner 2 2 0.4 2.8", "line 7: expected one of name, .* got 'corner'"),
        (8, "point 0 2 nan 1.6", "line 8: expected a number"),
        (9, "point 4/0 0 3.2 0", "line 9: expected a number"),
        (17, "tile 1 2 3 -4", "line 17: expected numbers of points, got '-4'"),
        (18, "opening 0 0 1 0 1", "line 18: expected x y of three corners or more, got 5"),
    ],
)
def test_lines_of_another_form_are_unreadable(line: int, text: str, message: str) -> None:
    with pytest.raises(UnreadableError, match=f"^mine.cell, {message}"):
        parse_cell(changed(line, text), "mine.cell")


@pytest.mark.parametrize(
    ("line", "text", "message"),
    [
        (3, "columns 0 4  5.6 0", "line 3: expected contracted translations that span"),
        (3, "columns -4 0  5.6 0", "line 3: expected contracted translations of which 'rows'"),
        (3, "columns 4 0  0 5.6", "line 3: expected deployed translations of which 'rows'"),
        (3, "columns 5 0  5.6 0", "line 3: expected tiles and openings that fill the contracted cell, got 80 %"),
        (3, "columns 4 0  5.7 0", "line 1[78]: expected .* (hold together|overlap)"),
        (4, "rows 1 4  0 5.6", "line 17: expected sides that meet whole sides"),
        (5, "point 1e10 0 0 0", "line 5: expected numbers up to 1e\\+09"),
        (8, "point 0 2  -1.2 1.6001", "line 17: expected a tile of the same shape .* sqrt"),
        (17, "tile 1 2 3 13", "line 17: expected points from 1 to 12, got 13"),
        (17, "tile 1 2 3 0", "line 17: expected points from 1 to 12, got 0"),
        (17, "tile 1 2", "line 17: expected a tile of three points or more, got 2"),
        (17, "tile 1 2 3 3", "line 17: expected different points"),
        (17, "tile 4 3 2 1", "line 17: expected corners in counter-clockwise order, got clockwise contracted"),
        (17, "tile 1 3 2 4", "line 17: expected a polygon that does not cross"),
        (18, "", "line 3: expected tiles and openings that fill the contracted cell, got 75 %"),
        (18, "tile 1 2 3 4", "line 18: expected no overlap, got one with mine.cell, line 17, contracted"),
    ],
)
def test_cells_that_make_no_sheet_are_unusable(line: int, text: str, message: str) -> None:
    with pytest.raises(UnusableError, match=f"^mine.cell, .*{message}"):
        parse_cell(changed(line, text), "mine.cell")


def test_a_window_instead_of_a_tile_is_declared_as_an_opening() -> None:
    cell = parse_cell(changed(18, "opening 2 0  4 0  4 2  2 2"))
    t = tile_pattern(cell, np.ones((3, 3), bool))
    assert len(cell.openings) == 1
    assert len(t.openings) == len(t.holes)
    assert set(t.openings.sizes.tolist()) == {4}


def test_deployed_overlaps_are_found_between_cells() -> None:
    with pytest.raises(UnusableError, match=r"expected no overlap, got one with .* columns and .* rows on, deployed"):
        parse_cell(changed(3, "columns 4 0  5 0"), "mine.cell")


def test_sheets_that_fall_apart_are_unusable() -> None:
    # the deployed cell is longer, so that no hinge crosses to the next column
    with pytest.raises(UnusableError, match="expected a sheet that hinges hold together"):
        parse_cell(changed(3, "columns 4 0  7 0"), "mine.cell")


def test_tiles_that_cannot_turn_are_unusable() -> None:
    text = "columns 1 0  1 0\nrows 0 1  0 1\npoint 0 0 0 0\npoint 1 0 1 0\npoint 1 1 1 1\npoint 0 1 0 1\ntile 1 2 3 4"
    with pytest.raises(UnusableError, match="line 7: expected a tile that is free to turn"):
        parse_cell(text)


def test_corners_on_the_sides_of_others_are_unusable() -> None:
    # a brick wall: the corners of one row lie in the middle of the sides of the next
    text = """\
columns 2 0  2 0
rows 1 1  1 2
point 0 0  0 0
point 2 0  2 0
point 2 1  2 1
point 0 1  0 1
tile 1 2 3 4"""
    with pytest.raises(UnusableError, match="line 7: expected sides that meet whole sides"):
        parse_cell(text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "cell: expected a line 'columns'"),
        ("columns 1 0 1 0\nrows 0 1 0 1", "cell: expected lines 'tile', got none"),
        ("columns 1 0 1 0\nrows 0 1 0 1\n" + "tile 1 2 3\n" * 1001, "at most 1000 tiles"),
    ],
)
def test_incomplete_files_are_unusable(text: str, message: str) -> None:
    with pytest.raises(UnusableError, match=message):
        parse_cell(text)


def test_files_that_are_no_text_are_unreadable(tmp_path: Path) -> None:
    file = tmp_path / "mine.cell"
    for content in (b"\xff\xfe\x00", b"name a\0", b"\x89PNG\r\n\x1a\n"):
        file.write_bytes(content)
        with pytest.raises(UnreadableError, match="expected a unit cell as text"):
            read_cell(file)
    with pytest.raises(UnreadableError, match="expected a file, got a folder"):
        read_cell(tmp_path)
    with pytest.raises(UnreadableError, match="absent"):
        read_cell(tmp_path / "absent.cell")
    file.write_bytes(b"#" * 1_000_001)
    with pytest.raises(UnreadableError, match="at most 1 MB"):
        read_cell(file)
    file.write_text("\ufeff" + SQUARES, encoding="utf-8")
    assert read_cell(file).name == "squares"


@given(st.text(alphabet="0123456789 .-\nabcnmeoprtuwsilg#", max_size=300))
def test_any_text_is_read_or_refused(text: str) -> None:
    with pytest.raises((UnreadableError, UnusableError)):
        parse_cell(text)


@given(st.integers(0, 19), st.text(alphabet="0123456789 .-+*/()sqrtpi", max_size=30))
def test_any_line_is_read_or_refused(line: int, words: str) -> None:
    keyword = SQUARES.splitlines()[line].split()[0]
    try:
        cell = parse_cell(changed(line + 1, f"{keyword} {words}"))
    except (UnreadableError, UnusableError):
        return
    assert cell.area == pytest.approx(1)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1.0),
        ("-.5e1", -5.0),
        ("1.", 1.0),
        ("2-3-4", -5.0),
        ("12/3/2", 2.0),
        ("2+3*4", 14.0),
        ("-(2+3)*4", -20.0),
        ("sqrt(3)/2", math.sqrt(3) / 2),
        ("(1+sqrt(2))/2", (1 + math.sqrt(2)) / 2),
        ("cos(pi/5)-sin(0)*tan(1)", math.cos(math.pi / 5)),
        ("--1", 1.0),
    ],
)
def test_arithmetic(text: str, value: float) -> None:
    assert parse_number(text) == pytest.approx(value, abs=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "1 2",
        "1+",
        "(1",
        "1)",
        "sqrt 3",
        "sqrt",
        "sqrt(-1)",
        "1/0",
        "2**3",
        "x",
        "inf",
        "nan",
        "1e999",
        "0x10",
        "1_0",
        "__import__('os')",
        "(" * LONGEST,
        "1" * (LONGEST + 1),
        "½",
        "٣",
    ],
)
def test_what_is_no_number_is_refused(text: str) -> None:
    with pytest.raises(ValueError):
        parse_number(text)


@given(st.floats(-1e6, 1e6), st.floats(0.1, 1e6))
def test_arithmetic_agrees_with_floats(a: float, b: float) -> None:
    assert parse_number(f"{a!r}") == a
    assert parse_number(f"({a!r}-{b!r})/{b!r}") == (a - b) / b


def test_the_documented_example_is_the_one_tested_here() -> None:
    text = (Path(__file__).resolve().parents[3] / "docs" / "unit_cells.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```\n(.*?)```", text, re.DOTALL)
    found, expected = parse_cell(example), parse_cell(SQUARES)
    np.testing.assert_array_equal(found.deployed, expected.deployed)
    np.testing.assert_array_equal(found.contracted, expected.contracted)
