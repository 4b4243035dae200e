"""The sheet: what fits, turned or not, and the largest scale that does."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kirisurf.errors import ParameterError
from kirisurf.sheet import Sheet

side = st.floats(0.1, 1000)


def test_text_becomes_a_sheet() -> None:
    assert Sheet.parse("300x200") == Sheet.parse(" 3e2 × 200.0 ") == Sheet(300.0, 200.0)


@pytest.mark.parametrize("text", ["", "300", "300x", "x200", "300by200", "-3x4", "0x4", "1.2.3x4", "1e400x2", "axb"])
def test_other_text_is_refused(text: str) -> None:
    with pytest.raises(ParameterError, match="--fit-sheet: expected WxH"):
        Sheet.parse(text)


def test_a_pattern_is_turned_only_where_it_has_to_be() -> None:
    sheet = Sheet(300.0, 200.0)
    assert sheet.is_turned_for((300.0, 200.0)) is False
    assert sheet.is_turned_for((150.0, 150.0)) is False
    assert sheet.is_turned_for((200.0, 300.0)) is True
    assert sheet.is_turned_for((201.0, 300.0)) is None


@given(side, side, side, side, st.floats(0, 0.05))
def test_the_largest_scale_fits_and_no_larger_one_does(w: float, h: float, x: float, y: float, margin: float) -> None:
    sheet, extent = Sheet(w, h), np.array([x, y])
    largest = sheet.largest_scale(extent.tolist(), (margin, margin))
    assert sheet.is_turned_for((largest * extent + margin).tolist()) is not None
    assert sheet.is_turned_for((1.0001 * largest * extent + margin).tolist()) is None


def test_without_room_for_the_kerf_no_scale_fits() -> None:
    assert Sheet(1, 1).largest_scale((1.0, 1.0), (2.0, 2.0)) == 0
