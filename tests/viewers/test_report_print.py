"""A report printed by a browser: whole sheets of A4, upright for one run, lying for many."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from viewers.parts import ReportParts
from viewers.report import write_report

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
UPRIGHT, LYING = (595, 842), (842, 595)


@pytest.fixture
def browser(request: pytest.FixtureRequest) -> str:
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip(f"{request.node.name} did not run: there is none of {', '.join(BROWSERS)} here")
    return found


def printed(browser: str, page: Path, folder: Path) -> list[tuple[int, int]]:
    """Width and height in points of every sheet."""
    target = folder / "page.pdf"
    # a container's shared memory may be too small for it
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
    profile = f"--user-data-dir={folder / 'profile'}"
    command = [browser, *options, profile, f"--print-to-pdf={target}", page.as_uri()]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    boxes = re.findall(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", target.read_bytes())
    return [(round(float(width)), round(float(height))) for width, height in boxes]


@pytest.mark.slow
@pytest.mark.parametrize(("count", "sheet_size", "most"), [(1, UPRIGHT, 6), (2, UPRIGHT, 6), (8, LYING, 12)])
def test_reports_print_on_whole_sheets(sheet, tmp_path, browser, count, sheet_size, most):
    rows = {name: 1e-13 for name in ("length", "angle", "planarity", "isometry", "closure")}
    parts = ReportParts("one", "hypar", "mm", certificate=rows, fields=sheet.fields, numbers={"porosity": 0.25})
    runs = [replace(parts, title=f"run {k}") for k in range(count)]
    sheets = printed(browser, write_report(runs, tmp_path / "page.html"), tmp_path)
    assert 1 <= len(sheets) <= most
    assert all(abs(a - b) <= 1 for size in sheets for a, b in zip(size, sheet_size, strict=True))
