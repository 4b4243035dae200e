"""Every number of a page stands in the files: in the JSON of the report, and there as in result.json and the CSV."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kirisurf
from kirisurf.reporting import report, run_parts
from kirisurf.runs import Run
from tests.viewers.report_page import Page
from viewers import words
from viewers.report import report_html
from viewers.report_numbers import balance_numbers, report_numbers, residence_shares
from viewers.report_page import formatted, pointed

TEMPLATE = (
    r"2π × Euler",
    r"inner vertices: 2π",
    r"− 2\)π",
    r"2π times",
    r"\d+×\d+ cells",
    r"1/unit",
    r"10\u207b?[\u2070-\u2079\u00b9\u00b2\u00b3]+ ",
    r"\bRUN -o numbers\.json",
    r"result\.json",
)
"""Figures in the sentences of the page itself, which are no numbers of the design."""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    design = kirisurf.fit("peaks", cells=(3, 3), units="mm")
    return design.save(tmp_path_factory.mktemp("report") / "run", pictures=False)


@pytest.fixture(scope="module")
def outline(tmp_path_factory: pytest.TempPathFactory) -> Run:
    design = kirisurf.fit("circle", cells=(3, 3))
    return design.save(tmp_path_factory.mktemp("report") / "outline", pictures=False)


@pytest.fixture(scope="module", params=["curved", "planar", "both"])
def written(
    request: pytest.FixtureRequest, run: Run, outline: Run, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Page, dict]:
    runs = {"curved": run, "planar": outline, "both": [run, outline, run]}[request.param]
    folder = tmp_path_factory.mktemp("written")
    page = report(runs, folder / "page.html", pictures=False).read_text(encoding="utf-8")
    return Page(page), json.loads(report(runs, folder / "page.json").read_text(encoding="utf-8"))


def test_every_number_of_the_page_stands_in_the_file(written: tuple[Page, dict]) -> None:
    page, numbers = written
    assert len(page.shown) > 60
    for shown in page.shown:
        found = pointed(numbers, shown.pointer)
        assert isinstance(found, (int, float)) and found == float(shown.value), shown
        assert shown.text == formatted(found, shown.form)


def test_the_words_of_the_page_hold_no_other_numbers(written: tuple[Page, dict]) -> None:
    page, numbers = written
    rest = " ".join(page.beside.split())
    sentences = sorted(strings(numbers) | fixed_words(), key=len, reverse=True)
    for sentence in sentences:
        rest = rest.replace(" ".join(sentence.split()), " ")
    for pattern in TEMPLATE:
        rest = re.sub(pattern, " ", rest)
    assert re.findall(r".{0,30}\d.{0,30}", rest) == []


def strings(document: object) -> set[str]:
    if isinstance(document, str):
        return {document} if re.search(r"\d", document) else set()
    if isinstance(document, dict):
        return set().union(*map(strings, document.keys()), *map(strings, document.values()))
    return set().union(*map(strings, document)) if isinstance(document, list) else set()


def fixed_words() -> set[str]:
    captions = [*words.CAPTIONS.values(), *words.PLANAR_CAPTIONS.values(), *words.OPEN_CAPTIONS.values()]
    return {text for _, meaning, _ in words._ROWS.values() for text in (meaning,)} | set(captions)


def test_the_numbers_are_those_of_the_run(run: Run) -> None:
    numbers = report_numbers(run_parts(run))
    measures = {name: value for name, value in run.result["measures"].items() if value is not None}
    assert {name: found["value"] for name, found in numbers["measures"].items()} == measures
    certificate = {name: found["value"] for name, found in numbers["certificate"].items()}
    assert {name: certificate[name] for name in run.certificate} == dict(run.certificate)
    with open(run.folder / "curvature.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(numbers["holes"])
    for row, found in zip(rows, numbers["holes"], strict=True):
        assert {name: float(cell or "nan") for name, cell in row.items()} == pytest.approx(found, nan_ok=True, abs=0)


def test_histograms_count_every_hole_that_is_not_flagged(run: Run) -> None:
    parts = run_parts(run)
    flag = np.zeros(run.result["holes"])
    flag[:2] = 1
    flagged = replace(parts, fields={**parts.fields, ("hole", "flag"): flag})
    for found in report_numbers(flagged)["histograms"].values():
        assert sum(found["holes"]) == sum(found["target"]) == run.result["holes"] - 2
        assert len(found["edges"]) == len(found["holes"]) + 1


def test_the_parts_of_curvature_and_area_are_a_whole(run: Run) -> None:
    shares = residence_shares(run_parts(run))
    assert shares is not None and set(shares) == {"area", "target", "sheet"}
    assert all(sum(each.values()) == pytest.approx(1) for each in shares.values())
    assert shares["sheet"]["tiles"] < 1e-6 < 0.2 < shares["target"]["tiles"]


def test_the_balance_adds_up(run: Run) -> None:
    found = balance_numbers(run_parts(run).numbers)
    assert found is not None
    sheet, cells = found["sheet"], found["cells"]
    assert sheet["sum"] == pytest.approx(sheet["turns"], abs=1e-9)
    assert sheet["vertices"] + sheet["holes"] + sheet["tiles"] + sheet["rim"] == pytest.approx(sheet["sum"])
    assert cells["patches"] + cells["sides"] == pytest.approx(cells["angles"])
    assert balance_numbers({}) is None


def test_older_runs_without_the_new_numbers_are_reported(run: Run) -> None:
    parts = run_parts(run)
    kept = ("tile_area", "gaussian_curvature_difference_median")
    fields = {key: values for key, values in parts.fields.items() if key[1] in ("distance", "planarity")}
    for older in (
        replace(parts, numbers={name: parts.numbers[name] for name in kept}),
        replace(parts, numbers={}, fields=fields, tables={}),
        replace(parts, numbers={}, fields={}, tables={}, certificate={}, history=(), result={}),
    ):
        numbers = report_numbers(older)
        assert "balance" not in numbers and "residence" not in numbers
        page = Page(report_html(older))
        assert all(pointed(numbers, shown.pointer) == float(shown.value) for shown in page.shown)


def test_the_page_is_the_same_from_the_folder_and_from_the_design(run: Run, tmp_path: Path) -> None:
    again = report(run, tmp_path / "again.html", pictures=False)
    expected = (run.folder / "report.html").read_text(encoding="utf-8").replace("Pictures were not asked for.", "")
    assert again.read_text(encoding="utf-8").replace("The run holds none.", "") == expected


@pytest.mark.parametrize(
    ("value", "form", "text"),
    [
        (0.123456, "number", "0.123"),
        (-2e-15, "number", "\u22122\u00b710^\u221215$"),
        (1e-9, "number", "10^\u22129$"),
        (0.0757, "percent", "7.6\u00a0%"),
        (0.8824, "percent", "88.2\u00a0%"),
        (1.0, "percent", "100\u00a0%"),
        (0.0, "percent", "0\u00a0%"),
        (5.8e-14, "percent", "5.8\u00b710^\u221212$\u00a0%"),
        (-1e-14, "3@0", "0.000"),
        (0.87812, "3@0", "0.878"),
        (float("nan"), "3@0", "\u2013"),
        (-4.3949e-8, "2@-7", "\u22120.44"),
        (1.2345e6, "0@3", "1234"),
        (9.66e-14, "short", "9.7\u00b710^\u221214$"),
        (12, "short", "12"),
        (None, "number", "\u2013"),
        (True, "number", "True"),
        (np.int64(3), "number", "3"),
    ],
)
def test_numbers_have_one_look(value: object, form: str, text: str) -> None:
    assert formatted(value, form) == text


def test_pointers_follow_the_standard() -> None:
    document = {"a/b": {"m~n": [1, {"": 2}]}}
    assert pointed(document, "/a~1b/m~0n/0") == 1 and pointed(document, "/a~1b/m~0n/1/") == 2
    assert pointed(document, "") == document
    assert [pointed(document, pointer) for pointer in ("/x", "/a~1b/m~0n/2", "/a~1b/m~0n/-1", "/a~1b/q/z")] == [
        None
    ] * 4
