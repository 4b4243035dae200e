"""Every environment that needs nothing but this interpreter: the same bytes, the same verdict, nothing left behind.

The others (a wheel outside the checkout, oldest and newest dependencies) are run by `matrix.py`, by name.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from tests.environments.installed import HEAVY, lowest
from tests.environments.matrix import HEADER, Matrix, cells, main
from tests.environments.rows import cheap
from tests.environments.running import Environment, Result, run_row

NAMES = [row.name for row in cheap()]

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="environments were not tried: Linux only")


@pytest.fixture(scope="module")
def matrix() -> Matrix:
    return Matrix()


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_an_environment_changes_nothing(name: str, matrix: Matrix) -> None:
    result = matrix.result(name)
    if result.skipped:
        pytest.skip(f"{name}: did not run: {result.skipped}")
    assert result.problems == ()


def test_rows_have_names_of_their_own_and_are_compared_with_rows() -> None:
    assert len(NAMES) == len(set(NAMES)) and not set(NAMES) & set(HEAVY)
    assert {row.like for row in cheap()} <= {*NAMES, ""}


def test_a_row_that_fails_says_why(tmp_path: Path) -> None:
    """A fit that is refused, says what it should not, and leaves a file behind."""
    code = "import pathlib, sys; pathlib.Path('left').touch(); print('Warning: x', file=sys.stderr); sys.exit(3)"
    found = run_row(Environment("bad", python=("-c", code)), tmp_path, {"deployed.obj": "0"})
    text = " ".join(found.problems)
    for part in ("expected code 0, got 3", "Warning: on standard error", "not certified", "other bytes", "here/left"):
        assert part in text
    assert found.verdict == "; ".join(found.problems)


def test_a_skipped_row_says_why(tmp_path: Path) -> None:
    found = run_row(Environment("none", lacking=lambda: "no such machine"), tmp_path)
    assert found.verdict == "did not run: no such machine" and not found.problems


def test_the_table_has_a_cell_for_every_column(capsys: pytest.CaptureFixture[str]) -> None:
    result = Result(("fit",), (0,), True, 1.25, ("a | b",))
    assert len(cells("x", result)) == len(HEADER) and not any("|" in cell for cell in cells("x", result))
    with pytest.raises(SystemExit):
        main(["no such row"])
    assert "expected names of rows" in capsys.readouterr().err


def test_lowest_versions_are_those_of_the_bounds() -> None:
    assert lowest(["libigl>=2.6,<2.7", "rich>=13"]) == ["libigl==2.6", "rich==13"]
    assert all(re.fullmatch(r"[\w-]+==[\d.]+", line) for line in lowest(["vtk>=9.6.0"]))
