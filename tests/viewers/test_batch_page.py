"""The page of a batch: every item once, every number where the summary has it, and nothing runs but its own script."""

from __future__ import annotations

import base64
import copy
import re

import pytest

from kirisurf.errors import ParameterError
from tests.viewers.batch_summary import CRASHED, PNG, BatchPage, change, compared, item, matrix, rows_of, summary
from viewers.batch_changes import measure_words, tolerance_rows
from viewers.batch_page import MOST_CARDS, batch_page
from viewers.report_page import formatted, pointed


def test_every_item_is_in_the_table_once():
    items = [*matrix(), item("wreck", **CRASHED)]
    html = batch_page(summary(items), {})
    shown = rows_of(html)
    assert [BatchPage(row).tags[0][1]["data-item"] for row in shown] == [str(k) for k in range(len(items))]
    for each, row in zip(items, shown, strict=True):
        page = BatchPage(row)
        assert page.text.count(each["name"]) == 1 and each["outcome"] in page.text
        assert all(str(value) in page.text for value in each["options"].values())


def test_every_number_stands_in_the_summary():
    items = matrix()
    worse = {"t0--quad--2x2": ("worse", [change("distance_rms", 0.0084, 0.012, "worse")])}
    told = compared(items, **worse)
    page = BatchPage(batch_page(told, {}))
    assert len(page.shown) >= 9 * len(items)
    for shown in page.shown:
        value = pointed(told, shown.pointer)
        assert float(shown.value) == value and shown.text == formatted(value, shown.form)
    assert {"/comparison/items/11/changes/0/before", "/comparison/items/11/changes/0/now"} <= {
        shown.pointer for shown in page.shown
    }


def test_every_picture_is_in_the_page_once():
    items = matrix()
    pictures = {each["name"]: PNG + bytes([k % 5]) for k, each in enumerate(items[:-1])}
    worse = {items[0]["name"]: ("worse", [change("coverage", 0.9, 0.8, "worse")])}
    html = batch_page(compared(items, **worse), pictures)
    for content in set(pictures.values()):
        assert html.count(base64.b64encode(content).decode()) == 1
    page = BatchPage(html)
    labels = [a["aria-label"] for a in page.having("role") if a["role"] == "img"]
    # in the table and on the wall, and once more where it is shown in full
    for each in items[:-1]:
        assert sum(label == f"The sheet of {each['name']}, opened" for label in labels) == 2 + (each is items[0])
    assert not [label for label in labels if items[-1]["name"] in label]


@pytest.mark.parametrize(
    ("items", "good", "words"),
    [
        ([item()], True, "The one item ended as expected."),
        ([item("a"), item("b", outcome="done with warnings", code=1)], True, "All 2 items ended as expected."),
        ([item("a"), item("b", **CRASHED)], False, "1 of 2 ended as expected; 1 did not: crashed."),
        (
            [item("a"), item("b", **CRASHED), item("c", is_expected=False, expect=[3]), item("d", **CRASHED)],
            False,
            "1 of 4 ended as expected; 3 did not: 2 crashed, 1 done.",
        ),
        (
            [item("a"), item("b", outcome="unreadable", code=3, expect=[3])],
            True,
            "1 of them failed, as expected.",
        ),
        ([item("a"), item("b", outcome="not run", code=130, is_expected=False)], False, "1 was not run to the end."),
        ([], True, "There was nothing to fit."),
    ],
)
def test_the_verdict_comes_first(items, good, words):
    html = batch_page(summary(items), {})
    page = BatchPage(html)
    assert words in page.text
    (box,) = [a["class"] for _, a in page.tags if "verdict" in a.get("class", "").split()]
    assert box.split()[1] == ("pass" if good else "fail")
    assert page.text.index(words) < (page.text + "All items").index("All items")


def test_what_is_worse_is_shown_with_before_and_now():
    items = [*matrix(), item("crash", **CRASHED)]
    told = compared(
        items,
        **{
            items[3]["name"]: (
                "worse",
                [
                    change("coverage", 0.9, 0.95, "better"),
                    change("distance_rms", 0.0084, 0.012, "worse"),
                    change("min_edge", 0.5, 0.5, "same"),
                ],
            ),
            items[5]["name"]: ("better", [change("coverage", 0.5, 0.75, "better")]),
            items[6]["name"]: ("new", []),
            "was there": ("missing", []),
        },
    )
    html = batch_page(told, {})
    cards = [each.split("</article>")[0] for each in html.split("<article")[1:]]
    assert [name for card in cards for name in re.findall(r"<bdi>(.*?)</bdi>", card)] == [
        items[3]["name"],
        "crash",
        items[5]["name"],
    ]
    worse = BatchPage(f"<article{cards[0]}</article>")
    assert [(a["data-measure"], a["class"]) for a in worse.having("data-measure")] == [
        ("distance_rms", "worse"),
        ("coverage", "better"),
    ]
    assert "+42.9\N{NO-BREAK SPACE}%" in worse.text and "rms distance" in worse.text
    bars = [float(a["style"].removeprefix("width:").removesuffix("%")) for a in worse.having("style")]
    assert bars == pytest.approx([70.0, 100.0, 94.7, 100.0])
    assert "Ended by signal 11." in cards[1] and "Expected: done or done with warnings." in cards[1]
    page = BatchPage(html)
    assert "Against the baseline: 1 worse, 1 better, 1 missing, 1 new, 10 same." in page.text.replace(
        "the same", "same"
    )
    assert "was there" in page.text
    counted = tolerance_rows(told["comparison"])
    assert [(row.measure, row.n_worse, row.n_better) for row in counted] == [("distance_rms", 1, 0), ("coverage", 0, 2)]


def test_what_is_only_missing_asks_to_be_looked_at():
    html = batch_page(compared([item()], gone=("missing", [])), {})
    assert 'class="verdict warn"' in html and "gone" in html.split("What needs attention")[1]


def test_how_an_item_ended_is_told_in_words():
    certified = {"measure": "certified", "before": True, "now": False, "verdict": "worse", "sentence": "..."}
    items = [item("a", certified=False), item("b", code=5, outcome="not within tolerance")]
    told = compared(items, a=("worse", [certified]), b=("worse", [change("code", 0, 5, "worse")]))
    html = batch_page(told, {})
    assert "no longer certified" in html and "done before, not within tolerance now" in html
    assert 'class="bar"' not in html


def test_what_a_crashed_process_said_last_is_shown():
    said = [f"line {k} <b>" for k in range(30)]
    html = batch_page(summary([item("bad", **{**CRASHED, "said": said}), item("good", said=["all is well"])]), {})
    shown = html.split("<pre")[1].split("</pre>")[0]
    assert "line 29 &lt;b&gt;" in shown and "line 5 " not in shown and html.count("<pre") == 1


def test_notes_and_limits_are_shown():
    told = summary(notes=["2 files left out."], limits={"seconds": 60.0, "memory_mb": 500.0})
    text = BatchPage(batch_page(told, {})).text
    assert "2 files left out." in text and "60 s and 500 MB" in text


def test_failures_are_not_told_twice():
    failures = ["length: expected at most 1e-09, got 0.02", "angle: expected at most 1e-09, got 5"]
    bad = item("bad", **{**CRASHED, "outcome": "not within tolerance", "failures": failures})
    bad["reason"] = f"Step limit reached. {failures[0]}. {failures[1]}."
    (card,) = batch_page(summary([bad]), {}).split("<article")[1:]
    card = card.split("</article>")[0]
    assert "Step limit reached." in card and all(card.count(sentence) == 1 for sentence in failures)


def test_so_many_that_only_some_are_shown_in_full():
    items = [item(f"n{k}", **CRASHED) for k in range(MOST_CARDS + 7)]
    html = batch_page(summary(items), {})
    assert html.count("<article") == MOST_CARDS and "And 7 more" in html
    assert len(rows_of(html)) == len(items)


def test_chips_count_the_lines_that_they_choose():
    items = [*matrix(), item("crash", **CRASHED), item("x", outcome="unreadable", code=3, expect=[3])]
    told = compared(items, **{items[1]["name"]: ("worse", []), items[2]["name"]: ("better", [])})
    html = batch_page(told, {})
    keys = [BatchPage(row).tags[0][1]["data-keys"].split() for row in rows_of(html)]
    chips = re.findall(r'<button[^>]*data-filter="([^"]+)"[^>]*><b>(\d+)</b> ([^<]+)<', html)
    assert {words for _, _, words in chips} >= {"not as expected", "worse", "better", "same", "done", "crashed"}
    for key, count, _ in chips:
        assert sum(key in each for each in keys) == int(count) > 0


def test_without_runs_options_or_pictures():
    items = [{"name": "a"}, {"name": "b", "outcome": "crashed"}, item("c", **CRASHED), item("d", measures=None)]
    html = batch_page({"items": items}, {"elsewhere": PNG})
    assert len(rows_of(html)) == 4 and "The wall" not in html
    assert base64.b64encode(PNG).decode() not in html


@pytest.mark.parametrize("items", [None, 5, "items", [5], [{}], [{"name": 3}], {"name": "a"}])
def test_a_summary_without_items_is_refused(items):
    with pytest.raises(ParameterError, match="expected a list of items with a name each"):
        batch_page({"items": items}, {})


def test_the_summary_stays_as_it_was():
    told = compared(matrix(), **{"t0--quad--2x2": ("worse", [change("coverage", 0.9, 0.8, "worse")])})
    before = copy.deepcopy(told)
    assert batch_page(told, {}) == batch_page(before, {})
    assert told == before


def test_every_measure_has_words():
    assert measure_words("gaussian_curvature_difference_relative")[0] != "gaussian_curvature_difference_relative"
    assert measure_words("something_new") == ("something new", "")
