"""The benchmark itself: a tiny run, a clock that adds up, and figures that follow from rows."""

from __future__ import annotations

import os
import shutil
import time
from pathlib import Path

import pytest

import kirisurf
from kirisurf.errors import ParameterError
from tests.benchmarks import run, window
from tests.benchmarks.measuring import Measurement
from tests.benchmarks.problems import Problem, parsed, standard
from tests.benchmarks.stopwatch import PARTS, Stopwatch
from tests.benchmarks.tables import COLUMNS, derived, exponent, line
from viewers.workbench.desktop.qt import is_installed


def cells(text: str) -> list[str]:
    return [cell.strip() for cell in text.strip("|").split("|")]


def test_a_tiny_run_gives_a_table_whose_parts_add_up(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "new" / "bench.md"
    assert run.main(["--problems", "hypar:4x4", "--peers", "slsqp", "-o", str(path)]) == 0
    said = capsys.readouterr().out
    assert path.read_text(encoding="utf-8") == said
    table = [text for text in said.splitlines() if text.startswith("|")]
    assert cells(table[0]) == list(COLUMNS)
    rows = [dict(zip(COLUMNS, cells(text), strict=True)) for text in table[2:]]
    assert [(row["problem"], row["solver"], row["tiles"]) for row in rows] == [
        ("hypar 4x4", "newton", "16"),
        ("hypar 4x4", "slsqp", "16"),
    ]
    for row in rows:
        total = float(row["solve s"])
        parts = [float(row[f"{part} s"]) for part in PARTS if row[f"{part} s"] != "–"]
        # the parts add up, to the digits that are shown, and none is what the others have too much
        assert min(parts) >= 0 and sum(parts) == pytest.approx(total, abs=0.005 * (1 + len(parts)))
        assert total <= float(row["fit s"]) + 0.005
        assert float(row["MB"]) > 20 and int(row["steps"]) > 0
        assert float(row["rms"]) < 0.1 and 0.5 < float(row["coverage"]) <= 1.0
    assert rows[0]["end"] == "certified" and float(rows[0]["worst rigid row"]) <= 1e-9
    assert float(rows[0]["ratio"]) >= 1 and rows[1]["ratio"] == "–"
    assert "slsqp takes" in said


def test_a_target_that_is_not_there_is_a_row_and_no_crash() -> None:
    row = run.measured(Problem("no_such_surface", grid=4), "newton", 60.0)
    assert row.end == "refused" and "no_such_surface" in row.note
    assert len(cells(line(row))) == len(COLUMNS)


def test_the_times_of_a_window_are_its_own(tmp_path: Path) -> None:
    if not is_installed():
        pytest.skip("the window's benchmark did not run: the extra kirisurf[desktop] is missing")
    if not (os.environ.get("DISPLAY") or shutil.which("xvfb-run")):
        pytest.skip("the window's benchmark did not run: there is no display, and no xvfb-run to make one")
    path = tmp_path / "window.md"
    assert window.main(["--grids", "4", "-o", str(path)]) == 0
    titles, _, row = path.read_text(encoding="utf-8").splitlines()
    assert len(cells(row)) == len(cells(titles)) == len(window.COLUMNS) + 1
    times = dict(zip(window.COLUMNS, map(float, cells(row)[1:]), strict=True))
    assert min(times.values()) > 0 and times["window"] < times["first fit"]
    assert all(times[name] <= times[f"{name} colored"] for name in ("bound", "opening", "pattern"))


def test_a_window_that_fails_is_said(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="code 1"):
        window.in_a_process("no_such_surface", 4)


def test_the_stopwatch_splits_the_solve_and_puts_the_methods_back() -> None:
    from kirisurf.solvers.interior_point import InteriorPoint
    from kirisurf.solvers.linearization import Linearization

    before = vars(InteriorPoint)["solve"], vars(Linearization)["at"]
    shares: list[float] = []
    # what the rest of the machine takes is in the total: where it was busy, once more
    while len(shares) < 10 and max(shares, default=0.0) <= 0.5:
        watch = Stopwatch()
        watch.start()
        try:
            design = kirisurf.fit("hypar", cells=(2, 2))
        finally:
            watch.stop()
        assert (vars(InteriorPoint)["solve"], vars(Linearization)["at"]) == before
        assert watch.missing == ()
        assert all(watch.seconds[part] > 0 for part in PARTS), watch.seconds
        shares.append(sum(watch.seconds.values()) / design.result.seconds["solve"])
        assert shares[-1] <= 1
    assert shares[-1] > 0.5, shares


def test_a_part_inside_another_counts_once_and_nothing_counts_outside_a_solve() -> None:
    class Outer:
        def solve(self) -> None:
            time.sleep(0.02)
            Inner.make()

    class Inner:
        @classmethod
        def make(cls) -> None:
            time.sleep(0.03)

    watch = Stopwatch()
    watch.wrap(Outer, "solve", "rest")
    watch.wrap(Inner, "make", "factor")
    watch.wrap(Inner, "gone", "assemble")
    Inner.make()
    assert sum(watch.seconds.values()) == 0
    began = time.perf_counter()
    Outer().solve()
    total = time.perf_counter() - began
    assert watch.seconds["rest"] >= 0.02 and watch.seconds["factor"] >= 0.03
    assert sum(watch.seconds.values()) <= total
    assert watch.found == {"Outer.solve", "Inner.make"} and watch.missing


def test_the_derived_figures_follow_from_the_rows() -> None:
    problems = [Problem("hypar", grid=size) for size in (16, 32, 64)]
    rows = [
        Measurement(p.name, "newton", "certified", p.grid**2, 10, 1.0, 1e-6 * p.grid**3, {"factor": 1e-7 * p.grid**4})
        for p in problems
    ]
    for row, p in zip(rows, problems, strict=True):
        row.megabytes = 0.1 * p.grid**2
    rows.append(Measurement("hypar 16x16", "ipopt", "time limit", 256, 7, 5.0, 4096e-5))
    said = "\n".join(derived(problems, rows))
    assert "32 to 64" in said and "power 1.50" in said and "factorizations by 2.00" in said and "memory by 1.00" in said
    assert "ipopt takes at least 10.0 times" in said and "time limit" in said
    assert exponent([1, 2, 4], [3, 6, 12]) == pytest.approx(1.0)


def test_problems_are_read_from_text_and_files(tmp_path: Path) -> None:
    assert parsed("peaks:32x32") == Problem("peaks", grid=32) and parsed("dome:360") == Problem("dome", tiles=360)
    for text in ("peaks", "peaks:7x7", "peaks:8x16", ":8"):
        with pytest.raises(ParameterError, match="NAME:NxN"):
            parsed(text)
    (tmp_path / "part.STL").touch()
    (tmp_path / "notes.txt").touch()
    names = [problem.name for problem in standard(large=True, meshes=tmp_path)]
    assert {"hypar 256x256", "peaks 16x16", "mexicanhat2 32x32", "car_hood ~360", "part ~360"} <= set(names)
    assert len(names) == len(set(names)) and not any("notes" in name for name in names)
    assert Problem("peaks", grid=8).solvers(("slsqp", "ipopt")) == ["newton", "slsqp", "ipopt"]
    assert Problem("peaks", grid=16).solvers(("slsqp", "ipopt")) == ["newton", "ipopt"]
    assert Problem("peaks", grid=32).solvers(("slsqp", "ipopt")) == ["newton"]
