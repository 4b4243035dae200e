"""The report stands alone, escapes what a user wrote, and shows every row."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from kirisurf.errors import OutputError, ParameterError
from tests.viewers.report_page import Page
from viewers.parts import ReportParts, curvature_summary, feasibility, is_planar, verdict
from viewers.report import report_html, write_report
from viewers.words import CAPTIONS, OPEN_CAPTIONS, PLANAR_CAPTIONS

ROWS = {
    "length": 3e-13,
    "angle": 2e-12,
    "planarity": 1e-14,
    "isometry": 1e-13,
    "closure": 2e-13,
    "opening_min": 0.31,
    "intersections": 0,
    "overlap_contracted": 0.0,
    "gap_contracted": 1e-15,
    "loop": None,
    "min_edge": 0.41,
    "distance_rms": 0.021,
    "distance_max": 0.08,
    "reach_rms": 0.2,
    "reach_max": 0.7,
    "coverage": 0.93,
    "coverage_strict": 0.88,
}
LIMITS = {"length": 1e-9, "angle": 1e-9, "opening_min": 0.0, "intersections": 0, "distance_rms": 0.05, "coverage": 0.85}


@pytest.fixture(autouse=True)
def quick_charts(request, monkeypatch):
    """Draw the charts only where a test asks for the whole page: they take most of its time."""
    if request.function is not test_the_page_loads_nothing_and_runs_nothing:
        for name in ("residual_history", "curvature_scatter", "curvature_histogram"):
            monkeypatch.setattr(f"viewers.charts.{name}", lambda *_: "<svg/>")


def rows(sheet) -> list[dict]:
    names = ("mean_curvature", "gaussian_curvature", "target_mean_curvature", "target_gaussian_curvature", "flag")
    columns = {name: sheet.fields["hole", name] for name in names}
    return [{"hole": k, **{name: float(values[k]) for name, values in columns.items()}} for k in range(25)]


@pytest.fixture
def parts(sheet, tmp_path) -> ReportParts:
    Image.new("RGB", (4, 3), "white").save(tmp_path / "deployed.png")
    (tmp_path / "pattern.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
    return ReportParts(
        title="A sheet",
        target_name="hypar",
        units="mm",
        result={
            "status": "CONVERGED",
            "reason": "Converged.",
            "seconds": {"total": 1.25, "solve": 0.5},
            "iterations": 7,
            "tiles": 36,
            "vertices": 84,
            "holes": 25,
            "edge_length": 0.2,
            "versions": {"numpy": "9.9.9"},
        },
        certificate=ROWS,
        limits=LIMITS,
        failures=(),
        fields=sheet.fields,
        numbers={"tile_area": 1.5, "porosity": 0.25, "mean_curvature_difference_median": 0.5},
        tables={"curvature": rows(sheet)},
        pictures={"deployed": tmp_path / "deployed.png", "pattern": tmp_path / "pattern.svg"},
        notes=("The opening is 60 % because of the stretch.",),
        history=({"length": 1e-2}, {"length": 1e-10}),
        sheet_size=(1.5, 1.25),
    )


def test_the_page_loads_nothing_and_runs_nothing(parts):
    text = report_html(parts)
    page = Page(text)
    assert "http" not in text and "file:" not in text and "@import" not in text and "url(" not in text
    assert not [tag for tag, _ in page.tags if tag in ("script", "link", "iframe", "object", "base", "embed", "form")]
    sources = [a["src"] for _, a in page.tags if "src" in a]
    assert len(sources) == 2 + 4 + 1
    assert all(s.startswith(("data:image/png;base64,", "data:image/svg+xml;base64,")) for s in sources)
    assert not [a for _, a in page.tags if "href" in a or any(key.startswith("on") for key in a)]


def test_every_picture_has_words(parts):
    page = Page(report_html(parts))
    assert all(a.get("alt") for tag, a in page.tags if tag == "img")
    assert CAPTIONS["deployed"] in page.text


def test_every_certificate_row_is_shown_with_a_verdict_in_words(parts):
    page = Page(report_html(parts))
    shown = {a["data-row"]: a["class"] for tag, a in page.tags if "data-row" in a}
    assert list(shown) == list(ROWS)
    assert shown["loop"] == "none" and shown["length"] == "pass" and shown["reach_max"] == "info"
    for words in ("pass", "does not apply", "reported"):
        assert words in page.text


@pytest.mark.parametrize(
    "where",
    ["title", "target_name", "units", "notes", "warnings", "failures", "no_pictures", "row", "spec", "version"],
)
def test_what_a_user_wrote_is_escaped(parts, where):
    evil = "<img src=x onerror=alert(1)>&\"'"
    changed = {
        "row": {"certificate": {evil: 1.0}},
        "spec": {"spec": {evil: evil, "tessellation": evil}},
        "version": {"result": {**parts.result, "versions": {evil: evil}, "reason": evil}},
        "no_pictures": {"pictures": {}, "no_pictures": evil},
    }.get(where, {where: (evil,) if where in ("notes", "warnings", "failures") else evil})
    text = report_html(replace(parts, **{"fields": {}, "history": (), **changed}))
    page = Page(text)
    assert "<img src=x" not in text
    assert not [a for _, a in page.tags if "onerror" in a or a.get("src") == "x"]
    assert "onerror=alert(1)" in page.text


def test_the_same_parts_give_the_same_page(parts):
    assert report_html(parts) == report_html(parts)


def test_a_failure_is_in_the_verdict_and_in_its_row(parts):
    failing = replace(parts, failures=("planarity: expected at most 1e-09, got 3e-4: a tile is not flat",))
    assert verdict(failing) == "Not certified: 1 check failed."
    page = Page(report_html(failing))
    assert {a["data-row"]: a["class"] for _, a in page.tags if "data-row" in a}["planarity"] == "fail"
    assert "a tile is not flat" in page.text and "\u2717" in page.text


def test_without_a_judge_rows_are_held_against_their_limits(parts):
    assert verdict(replace(parts, failures=None)).startswith("Certified")
    wrong = replace(parts, failures=None, certificate={**ROWS, "angle": 1e-3, "closure": None})
    assert verdict(wrong) == "Not certified: 2 checks failed."
    assert verdict(replace(parts, certificate={})).startswith("Not certified: no certificate")


def test_warnings_are_part_of_the_verdict(parts):
    assert "warnings" in verdict(replace(parts, warnings=("Look here.",)))
    assert "Look here." in Page(report_html(replace(parts, warnings=("Look here.",)))).text


def test_without_pictures_the_page_says_why_and_what_to_do(parts):
    page = Page(report_html(replace(parts, pictures={}, no_pictures="OpenGL is missing: apt-get install it.")))
    assert "no pictures" in page.text and "apt-get install it." in page.text and "kirisurf report" in page.text


def test_an_empty_report_can_be_written(tmp_path):
    path = write_report(ReportParts("Nothing", "none"), tmp_path / "report.html")
    Page(path.read_text(encoding="utf-8"))


def test_the_paragraph_beside_the_maps_says_what_is_target_and_what_is_fit(parts):
    summary = curvature_summary(parts)
    target = np.abs(parts.fields["hole", "target_gaussian_curvature"])
    assert summary.gaussian[0] == pytest.approx(np.median(target))
    assert summary.gaussian[1] == pytest.approx(np.median(target) / 11)
    rms = np.sqrt(np.mean(parts.fields["vertex", "distance"] ** 2))
    assert summary.per_edge_squared == pytest.approx(rms / 0.04)
    text = Page(report_html(parts)).text
    assert "(9.1\u00a0%)" in text and "d/L\u00b2" in text and "1/mm\u00b2" in text


def test_a_curvature_map_says_beside_it_how_much_is_the_fit(parts):
    file = parts.pictures["deployed"]
    names = ("gaussian_curvature", "target_gaussian_curvature", "gaussian_curvature_difference")
    shown = replace(parts, pictures=dict.fromkeys(names, file))
    text = Page(report_html(shown)).text
    assert "that part is the fit" in text and "9.1\u00a0% of its |K|" in text
    assert "All of it is the target's" in text and "None of it is the target's" in text
    numbers = {
        "gaussian_curvature_target_share": 0.92,
        "gaussian_curvature_from_fit_median": 0.25,
        "gaussian_curvature_from_patch_median": 0.125,
    }
    text = " ".join(Page(report_html(replace(shown, numbers=numbers))).text.split())
    assert "92 % of it is the target's" in text
    assert "0.25 1/mm\u00b2 come from the fit, 0.125 from too few tiles" in text


def test_flagged_holes_are_left_out_of_the_medians_and_counted(parts):
    flag = np.zeros(25)
    flag[0] = 1
    wild = np.array(parts.fields["hole", "gaussian_curvature"])
    wild[0] = np.nan
    fields = {**parts.fields, ("hole", "flag"): flag, ("hole", "gaussian_curvature"): wild}
    summary = curvature_summary(replace(parts, fields=fields))
    assert summary.n_without == 1 and np.isfinite(summary.gaussian[1])
    assert "1 of 25 holes" in Page(report_html(replace(parts, fields=fields))).text
    assert curvature_summary(replace(parts, fields={})) is None


def test_the_holes_that_differ_most_are_listed_and_the_rest_is_named(parts):
    page = Page(report_html(parts))
    listed = [int(shown.value) for shown in page.shown if shown.pointer.endswith("/hole")]
    apart = [abs(row["gaussian_curvature"] - row["target_gaussian_curvature"]) for row in parts.tables["curvature"]]
    assert listed == sorted(range(25), key=lambda k: -apart[k])[:8]
    assert "curvature.csv" in page.text


def test_flagged_holes_are_not_listed(parts):
    wild = [{**row, "gaussian_curvature": 1e9, "flag": 1} if k == 3 else row for k, row in enumerate(rows_of(parts))]
    page = Page(report_html(replace(parts, tables={"curvature": wild})))
    assert "3" not in [shown.value for shown in page.shown if shown.pointer.endswith("/hole")]


def rows_of(parts) -> list[dict]:
    return list(parts.tables["curvature"])


def test_missing_and_strange_pictures_are_refused(parts, tmp_path):
    with pytest.raises(OutputError, match="picture deployed: expected a readable file"):
        report_html(replace(parts, pictures={"deployed": tmp_path / "gone.png"}))
    with pytest.raises(ParameterError, match=r"picture deployed: expected a file of kind \.png"):
        report_html(replace(parts, pictures={"deployed": tmp_path / "deployed.exe"}))


def test_an_unwritable_place_is_an_output_error(parts, tmp_path):
    with pytest.raises(OutputError):
        write_report(parts, tmp_path / "missing" / "report.html")


FEASIBILITY: dict = {
    "sentence": "The target asks for more than quads can give.",
    "advice": "Take kagome.",
    "least": 1.0,
    "most": 1.414213562,
    "spread": [0.9, 1.7],
    "outside": 0.125,
}


def test_what_was_said_before_solving_is_in_the_report(parts):
    page = Page(report_html(replace(parts, result={**parts.result, "feasibility": FEASIBILITY})))
    for words in (FEASIBILITY["sentence"], FEASIBILITY["advice"], "1 to 1.41", "0.9 to 1.7", "12 %"):
        assert words in page.text
    known = {**FEASIBILITY, "spread": 1.89}
    text = Page(report_html(replace(parts, result={**parts.result, "feasibility": known}))).text
    assert "1.89 times as much" in text and "by 1 to 1.41" in text and "12.5\u00a0% of its area" in text
    enough = {**known, "outside": 0.0}
    assert "that is enough" in Page(report_html(replace(parts, result={**parts.result, "feasibility": enough}))).text
    assert "Can the target be reached?" not in Page(report_html(parts)).text


@pytest.mark.parametrize("missing", list(FEASIBILITY))
def test_feasibility_may_be_known_in_part(parts, missing):
    part = {**FEASIBILITY, missing: None}
    shown = feasibility(replace(parts, result={"feasibility": part}))
    assert shown is not None
    assert (shown.possible == "") == (missing in ("least", "most"))
    assert (shown.asked == "") == (missing == "spread")
    assert (shown.outside == "") == (missing == "outside")
    Page(report_html(replace(parts, result={"feasibility": part})))
    assert feasibility(replace(parts, result={"feasibility": {"sentence": None}})) is None
    assert (
        feasibility(replace(parts, result={"feasibility": {"spread": 2.0}})).asked
        == "the largest is 2 times the smallest"
    )


def test_feasibility_is_escaped(parts):
    evil = {key: "<script>x</script>" for key in ("sentence", "advice")}
    page = Page(report_html(replace(parts, result={**parts.result, "feasibility": evil})))
    assert "script" not in [tag for tag, _ in page.tags]


def _planar(parts, **more):
    fields = {key: 1e-14 * values if "curvature" in key[1] else values for key, values in parts.fields.items()}
    names = ("target", "pattern", "deployed", "mean_curvature", "gaussian_curvature")
    return replace(parts, fields=fields, pictures=dict.fromkeys(names, parts.pictures["deployed"]), **more)


def test_a_planar_target_says_so_instead_of_showing_noise(parts):
    planar = _planar(parts)
    assert is_planar(planar) and not is_planar(parts)
    assert is_planar(replace(parts, planar=True)) and not is_planar(replace(planar, planar=False))
    page = Page(report_html(planar))
    assert "The target is planar" in page.text
    assert PLANAR_CAPTIONS["deployed"] in page.text
    assert CAPTIONS["gaussian_curvature"] not in page.text and "mean curvature" not in page.text
    assert curvature_summary(planar) is None
    shown = [a["data-measure"] for _, a in page.tags if "data-measure" in a]
    assert shown == ["porosity", "tile_area"]
    assert "The target is planar" not in Page(report_html(parts)).text


def test_without_holes_nothing_is_known_to_be_planar(parts):
    assert not is_planar(replace(parts, fields={}))
    assert not is_planar(replace(parts, fields={key: values[:0] for key, values in parts.fields.items()}))


def test_of_an_odd_number_of_pictures_the_deployed_one_leads(parts):
    file = parts.pictures["deployed"]
    three = dict.fromkeys(("target", "pattern", "deployed"), file)
    for pictures, lead in ((three, True), ({**three, "asked_stretch": file}, False), ({"deployed": file}, False)):
        page = Page(report_html(replace(parts, pictures=pictures)))
        figures = [a.get("class") for tag, a in page.tags if tag == "figure"][: len(pictures)]
        wide = ["wide" in (each or "") for each in figures]
        assert wide == [lead] + [False] * (len(figures) - 1)
        alt = [a["alt"] for tag, a in page.tags if tag == "img"]
        assert (alt[0] == CAPTIONS["deployed"]) == (lead or len(pictures) == 1)


def test_measures_stand_under_their_headings_in_words(parts):
    page = Page(report_html(parts))
    shown = [a["data-measure"] for _, a in page.tags if "data-measure" in a]
    assert shown == ["porosity", "tile_area", "mean_curvature_difference_median"]
    for words in ("porosity: holes / tiles and holes", "25 %", "1.5 mm\u00b2", "0.5 1/mm"):
        assert words in page.text
    assert "seconds" not in " ".join(shown.pointer for shown in page.shown)
    assert "tile_area" not in page.text


def test_rows_of_prescribed_outlines_are_shown(parts):
    certificate = {**ROWS, "boundary": 1e-3, "contracted_boundary": None}
    failing = replace(parts, certificate=certificate, failures=("boundary: expected at most 1e-09, got 0.001",))
    shown = {a["data-row"]: a["class"] for _, a in Page(report_html(failing)).tags if "data-row" in a}
    assert shown["boundary"] == "fail" and shown["contracted_boundary"] == "none"


def test_a_sheet_that_stays_open_by_design_says_what_is_judged(parts):
    certificate, limits = {**ROWS, "gap_contracted": 0.364}, {**LIMITS, "gap_contracted": 1e-9}
    pictures = {**parts.pictures, "target": parts.pictures["deployed"]}
    beside = {"certificate_beside": {"gap_designed": 0.364 - 2e-16}}
    told = replace(parts, certificate=certificate, limits=limits, pictures=pictures, result={**parts.result, **beside})
    page = Page(report_html(told))
    assert OPEN_CAPTIONS["pattern"] in page.text and OPEN_CAPTIONS["deployed"] in page.text
    row = {shown.pointer: float(shown.value) for shown in page.shown if "gap_contracted" in shown.pointer}
    assert row["/certificate/gap_contracted/designed"] + row["/certificate/gap_contracted/rest"] == pytest.approx(0.364)
    assert "open by design" in Page(report_html(replace(told, result=parts.result))).text
    fails = ("gap_contracted: expected at most 1e-09, got 0.364: the contracted sheet leaves gaps",)
    assert "by design" not in Page(report_html(replace(told, failures=fails))).text
    assert "by design" not in Page(report_html(parts)).text


def test_what_is_said_once_is_not_said_again(parts):
    sentence = "The target asks for stretches that differ by a factor of 2.24; that is not enough."
    failure = "planarity: expected at most 1e-09, got 3e-4: a tile is not flat"
    found = {**FEASIBILITY, "sentence": sentence, "spread": 2.24}
    doubled = replace(
        parts,
        notes=(sentence, f"{sentence} {FEASIBILITY['advice']}", "Placement: by hand."),
        failures=(failure,),
        result={**parts.result, "reason": f"Step limit. {failure}.", "feasibility": found},
    )
    text = Page(report_html(doubled)).text
    assert text.count(failure) == 1 and "Step limit." in text
    assert sentence not in text and text.count(FEASIBILITY["advice"]) == 1
    assert "asks for 2.24 times as much" in text and "Placement: by hand." in text
