"""The benchmark of deployments: a tiny run, whose table says what was followed."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.benchmarks import deployment


def test_a_tiny_run_gives_a_row_for_every_sheet_and_drive(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bench.md"
    words = ["--grids", "4", "--steps", "4", "--drives", "free", "rim", "--lambdas", "1e-4", "-o", str(path)]
    assert deployment.main(words) == 0
    assert path.read_text(encoding="utf-8") == capsys.readouterr().out
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in path.read_text().splitlines()]
    rows = [dict(zip(deployment.COLUMNS, line, strict=True)) for line in lines[2:]]
    assert [(row["sheet"], row["drive"]) for row in rows] == [
        (sheet, drive) for sheet in deployment.TARGETS for drive in ("free", "rim")
    ]
    for row in rows:
        assert row["tiles"] == "16" and row["states"] == "5" and float(row["states/s"]) > 0
        assert float(row["worst residual"]) <= 1e-9 and row["end"] in ("COMPLETE", "JUMPED")
