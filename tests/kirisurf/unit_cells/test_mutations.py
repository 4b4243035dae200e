"""Damaged unit cells: a cell that can be cut and opened, or one line that says what is wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kirisurf.errors import KirisurfError, UnusableError
from kirisurf.tessellation_names import FILES, SUFFIX
from kirisurf.unit_cells.cell_file import parse_cell, read_cell, read_title
from tests.kirisurf.mutations import check_message, mutated, rounds, truncated

SEEDS = [file.read_bytes() for file in sorted(FILES.glob(f"*{SUFFIX}"))]


def _holds(path: Path, content: bytes) -> bool:
    path.write_bytes(content)
    try:
        read_title(path)
        cell = read_cell(path)
    except KirisurfError as problem:
        check_message(problem, path.name)
        return False
    assert np.isfinite(cell.contracted).all()
    assert np.isfinite(cell.deployed).all()
    return True


def test_damage_is_read_or_refused(tmp_path: Path) -> None:
    path = tmp_path / "damaged.cell"
    assert all(_holds(path, content) for content in SEEDS)
    ends = [_holds(path, mutated(content, seed)) for seed in rounds(40) for content in SEEDS]
    assert 0 < sum(ends) < len(ends)


def test_every_beginning_is_read_or_refused(tmp_path: Path) -> None:
    for beginning in list(truncated(min(SEEDS, key=len)))[::3]:
        _holds(tmp_path / "cut.cell", beginning)


def test_a_thousand_tiles_in_one_place_overlap_at_once() -> None:
    corners = "columns 1 0 1 0\nrows 0 1 0 1\npoint 0 0 0 0\npoint 1 0 1 0\npoint 0 1 0 1\n"
    with pytest.raises(UnusableError, match="no overlap"):
        parse_cell(corners + "tile 1 2 3\n" * 999)


def test_translations_out_of_all_proportion() -> None:
    lines = "columns 1e-300 0 1e-300 0\nrows 0 1e9 0 1e9\npoint 0 0 0 0\npoint 1 0 1 0\npoint 0 1 0 1\ntile 1 2 3\n"
    with pytest.raises(UnusableError):
        parse_cell(lines)
