"""Figures and the table of reproduced designs, from plain values."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from viewers import theme
from viewers.figures import GAP, TONES, Panel, planar_figure
from viewers.figures_accuracy import accuracy_figure
from viewers.figures_table import ColumnGroup, TableRow, table_page

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
PANEL = Panel(
    "one tile <&", "note $x", Loops.from_lists([[0, 1, 2, 3]]), SQUARE, 2 * SQUARE, 2 * SQUARE, np.zeros(1, np.int64)
)


def picture(content: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(content)).convert("RGB"))


def area(image: np.ndarray, color: str) -> int:
    rgb = [int(color[k : k + 2], 16) for k in (1, 3, 5)]
    return int((np.abs(image.astype(int) - rgb).max(axis=2) <= 2).sum())


def test_both_states_are_drawn_at_one_scale_in_their_tone() -> None:
    assert PANEL.size == (3 * (1 + GAP), 2.0)
    image = picture(planar_figure([PANEL]))
    found = area(image, TONES[0])
    unit = (0.96 * image.shape[1] / (1.04 * PANEL.size[0])) ** 2
    assert found == pytest.approx(5 * unit, rel=0.1)
    assert area(image, TONES[1]) == 0 and area(image, theme.SERIES[0]) > 0
    other = picture(planar_figure([replace(PANEL, tones=np.ones(1, np.int64), outline=None)]))
    assert area(other, TONES[1]) == pytest.approx(found, rel=0.05) and area(other, theme.SERIES[0]) == 0


def test_equal_designs_give_equal_bytes_and_none_is_refused() -> None:
    assert planar_figure([PANEL, PANEL], title="two") == planar_figure([PANEL, PANEL], title="two")
    with pytest.raises(ParameterError, match="expected designs and columns, got 0 designs"):
        planar_figure([])


def test_designs_stand_in_rows_of_columns() -> None:
    wide, narrow = (picture(planar_figure([PANEL] * 3, columns)).shape for columns in (3, 1))
    assert wide[1] == 3 * narrow[1] and narrow[0] == pytest.approx(3 * wide[0], abs=3)


def test_the_law_is_drawn_as_a_picture_and_as_svg() -> None:
    values = ([16, 64], [0.2, 0.1], [0.4, 0.2], [0.2, 0.1], (-0.5, -1.0, -1.0))
    assert picture(accuracy_figure(*values)).shape[1] == 8.4 * 150
    svg = accuracy_figure(*values, kind="svg")
    assert svg.startswith(b"<?xml") and svg == accuracy_figure(*values, kind="svg")


def test_the_table_says_which_line_fails_and_escapes_what_it_shows() -> None:
    groups = [ColumnGroup("Sheet", ("target", "rigid")), ColumnGroup("Published", ("rigid",))]
    rows = [
        TableRow("Outlines", (("circle", 1.6e-13), (2.5e-2,))),
        TableRow("Surfaces", (("a<b", None), (None,)), ("rows: too <large>",)),
    ]
    page = table_page("Title & more", ["Lead."], groups, rows, b"png")
    assert "1 of 2 configurations certified" in page
    assert "2e-13" in page and "0.025" in page and "a&lt;b" in page and "Title &amp; more" in page
    assert "Surfaces: a&lt;b: rows: too &lt;large&gt;" in page
    assert page.count('<tr class="fail">') == page.count('<tr class="pass">') == 1
    assert "data:image/png;base64,cG5n" in page
    assert "http" not in page and "<script" not in page
    assert "<figure>" not in table_page("Title", [], groups, rows)
