"""The wall of a batch: a grid where the items are a matrix of targets and options, and only there."""

from __future__ import annotations

import pytest

from tests.viewers.batch_summary import item, matrix, rows_of, summary
from viewers.batch_page import batch_page
from viewers.batch_rows import batch_rows
from viewers.batch_wall import MOST_COLUMNS, batch_wall


def test_a_matrix_is_a_wall():
    rows = batch_rows(summary(matrix(3, ("2x2", "4x4", "8x8"))))
    wall = batch_wall(rows, ("tessellation", "cells"))
    assert [[span.value for span in spans] for _, spans in wall.heads] == [
        ["quad", "kagome"],
        ["2x2", "4x4", "8x8"] * 2,
    ]
    assert [sum(span.n_columns for span in spans) for _, spans in wall.heads] == [wall.n_columns] * 2 == [6, 6]
    assert sorted(row.index for _, cells in wall.lines for row in cells) == list(range(18))
    for target, cells in wall.lines:
        for place, row in enumerate(cells):
            assert (row.target, row.options) == (
                target,
                (("quad", "kagome")[place // 3], ("2x2", "4x4", "8x8")[place % 3]),
            )


def test_a_matrix_with_holes_in_any_order_is_a_wall():
    items = matrix(3, ("2x2", "4x4", "8x8"))[::-1]
    del items[4]
    wall = batch_wall(batch_rows(summary(items)), ("tessellation", "cells"))
    assert sum(row is None for _, cells in wall.lines for row in cells) == 1
    assert sum(span.n_columns for span in wall.heads[0][1]) == wall.n_columns and len(wall.heads[0][1]) == 2


def test_targets_of_one_name_in_different_folders_are_different():
    items = [
        item(f"{folder}{cells}", target=f"/shells/{folder}/roof.stl", options={"tessellation": "quad", "cells": cells})
        for folder in "ab"
        for cells in ("2x2", "4x4")
    ]
    wall = batch_wall(batch_rows(summary(items)), ("tessellation", "cells"))
    assert [(name, [row.index for row in cells]) for name, cells in wall.lines] == [
        ("roof.stl", [0, 1]),
        ("roof.stl", [2, 3]),
    ]
    assert "/shells/" not in batch_page(summary(items), {})


@pytest.mark.parametrize(
    "items",
    [
        [item("a"), item("b")],
        matrix(1),
        [item(f"t{k}", target=f"t{k}") for k in range(5)],
        matrix(2, tuple(f"{k}x{k}" for k in range(MOST_COLUMNS))),
        [item(f"t{k}", target=f"t{k}", options={"cells": f"{k}x{k}"}) for k in range(6)],
        [],
    ],
    ids=["twice", "one target", "one column", "too wide", "a diagonal", "nothing"],
)
def test_what_is_no_matrix_is_no_wall(items):
    told = summary(items)
    assert batch_wall(batch_rows(told), told["varied"]) is None
    assert len(rows_of(batch_page(told, {}))) == len(items)
