"""The page of a batch: one self-contained HTML file with the verdict, what needs attention, all items, and a wall.

The page has a script of its own for sorting and filtering, allowed by its hash; nothing else on it can run, whatever
names and messages say. Without scripts it is a plain table.
"""

from __future__ import annotations

import base64
import hashlib
import statistics
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from viewers.batch_changes import ShownChange, Tolerance, allowed_words, measure_words, shown_changes, tolerance_rows
from viewers.batch_rows import BatchRow, batch_rows, legible_document, severity
from viewers.batch_wall import batch_wall
from viewers.report_page import data_address, formatted, page_template, shower

if TYPE_CHECKING:
    from markupsafe import Markup

# head, unit, place in an item of the summary
_COLUMNS = (
    ("tiles", "", ("tiles",)),
    ("steps", "", ("iterations",)),
    ("rms distance", "L", ("measures", "distance_rms")),
    ("largest distance", "L", ("measures", "distance_max")),
    ("coverage", "", ("measures", "coverage")),
    ("smallest opening", "rad", ("measures", "opening_min")),
    ("smallest edge", "L", ("measures", "min_edge")),
    ("seconds", "", ("seconds",)),
    ("peak memory", "MB", ("peak_mb",)),
)
MOST_CARDS = 100
"""Items that are shown in full among those that need attention; the table has them all."""


@dataclass(frozen=True)
class Chip:
    """A number of items that the table can be narrowed to: key, words, how many, and their kind or verdict."""

    key: str
    words: str
    count: int
    kind: str


@dataclass(frozen=True)
class Card:
    """An item that is shown in full: its row, its place among the compared ones, and what changed."""

    row: BatchRow
    place: int | None
    changes: list[ShownChange]


@dataclass(frozen=True)
class Fact:
    """A number at the head of the page."""

    value: Markup
    unit: str
    words: str


def batch_page(summary: Mapping[str, Any], thumbnails: Mapping[str, bytes]) -> str:
    """Return the page of a batch as HTML that needs no other file.

    Parameters
    ----------
    summary : mapping
        Content of summary.json: `title`, `spec`, `varied`, `items` and, where there is a baseline, `comparison`.
    thumbnails : mapping of str to bytes
        PNG files by the names of the items; an item may have none.

    Returns
    -------
    str
        Links to the reports of the runs are relative: the page belongs into the folder of the batch.

    Raises
    ------
    ParameterError
        Where the items are no list of mappings with a name each.

    Examples
    --------
    >>> page = batch_page({"title": "roofs", "items": [{"name": "hypar", "outcome": "done"}]}, {})
    >>> "The one item ended as expected." in page
    True
    """
    rows = batch_rows(summary)
    document = legible_document(summary)
    comparison = document.get("comparison") or {}
    script = files("viewers").joinpath("templates", "batch_script.js").read_text(encoding="utf-8")
    pictures, classes = _pictures([item["name"] for item in summary["items"]], thumbnails)
    cards = _cards(summary, rows, comparison)
    urgent = [card for card in cards if card.row.needs_attention]
    improved = [card for card in cards if card.row.verdict == "better"]
    chips = _chips(rows)
    is_good, sentences = _verdict(rows, comparison)
    return page_template("batch.html").render(
        title=document.get("title") or "batch",
        summary=document,
        rows=rows,
        show=shower(document),
        powers=_powers,
        is_good=is_good,
        sentences=sentences,
        facts=_facts(document["items"]),
        chips=chips,
        keys={row.index: " ".join(_keys(row, chips)) for row in rows},
        pictures=pictures,
        classes=classes,
        urgent=urgent[:MOST_CARDS],
        n_left_out=len(urgent) - MOST_CARDS,
        improved=improved[:MOST_CARDS],
        n_improved=len(improved),
        missing=[entry.get("name") for entry in comparison.get("items") or () if entry.get("verdict") == "missing"],
        varied=[name.replace("_", " ") for name in document.get("varied") or ()],
        has_targets=len({row.target for row in rows}) > 1,
        columns=_columns(document["items"]),
        wall=batch_wall(rows, document.get("varied") or ()),
        comparison=comparison,
        tolerances=_tolerances(comparison),
        script=script,
        script_hash=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii"),
    )


def _pictures(names: Sequence[str], thumbnails: Mapping[str, bytes]) -> tuple[list[str], dict[int, int]]:
    """Addresses of the different pictures, and which of them an item has: each is in the page once."""
    addresses: dict[bytes, int] = {}
    classes = {}
    for k, name in enumerate(names):
        if content := thumbnails.get(name):
            classes[k] = addresses.setdefault(content, len(addresses))
    return [data_address("image/png", content) for content in addresses], classes


def _cards(summary: Mapping[str, Any], rows: Sequence[BatchRow], comparison: Mapping[str, Any]) -> list[Card]:
    """All items with what changed; what is worse leads, then what did not end as expected, the worst outcomes first."""
    entries = (summary.get("comparison") or {}).get("items") or ()
    places = {entry.get("name"): k for k, entry in enumerate(entries)}
    cards = []
    for row in rows:
        place = places.get(summary["items"][row.index]["name"])
        changes = [] if place is None else shown_changes(comparison["items"][place], comparison.get("tolerances") or {})
        cards.append(Card(row, place, changes))
    return sorted(cards, key=lambda card: (card.row.verdict != "worse", card.row.kind != "bad", -card.row.severity))


def _chips(rows: Sequence[BatchRow]) -> list[Chip]:
    verdicts = Counter(row.verdict for row in rows)
    outcomes = Counter(row.outcome for row in rows)
    chips = [Chip("unexpected", "not as expected", sum(row.kind == "bad" for row in rows), "bad")]
    kinds = {"worse": "bad", "better": "good", "same": "kept", "new": "kept"}
    chips += [Chip(f"v-{verdict}", verdict, verdicts[verdict], kind) for verdict, kind in kinds.items()]
    for k, outcome in enumerate(sorted(outcomes, key=severity)):
        kind = {"done": "good", "done with warnings": "warn"}.get(outcome, "kept")
        chips.append(Chip(f"o-{k}", outcome, outcomes[outcome], kind))
    return [chip for chip in chips if chip.count]


def _keys(row: BatchRow, chips: Sequence[Chip]) -> list[str]:
    words = {row.outcome, row.verdict} | ({"not as expected"} if row.kind == "bad" else set())
    return [chip.key for chip in chips if chip.words in words]


def _verdict(rows: Sequence[BatchRow], comparison: Mapping[str, Any]) -> tuple[bool, list[str]]:
    """Return whether all is well, and why, the most important first."""
    n, unexpected = len(rows), [row for row in rows if row.kind == "bad"]
    idle = sum(row.kind == "none" for row in rows)
    ended = n - idle
    if not n:
        sentences = ["There was nothing to fit."]
    elif unexpected:
        outcomes = Counter(row.outcome for row in unexpected)
        worst = sorted(outcomes, key=severity, reverse=True)
        found = worst[0] if len(unexpected) == 1 else ", ".join(f"{outcomes[name]} {name}" for name in worst)
        sentences = [f"{ended - len(unexpected)} of {n} ended as expected; {len(unexpected)} did not: {found}."]
    elif ended:
        each = "The one item" if n == 1 else f"All {n} items" if ended == n else f"{ended} of {n} items"
        sentences = [f"{each} ended as expected."]
    else:
        sentences = []
    refused = sum(row.kind == "kept" for row in rows)
    if refused:
        sentences.append(f"{refused} of them {'was' if refused == 1 else 'were'} expected to fail, and did.")
    if idle:
        sentences.append(f"{idle} {'was' if idle == 1 else 'were'} not run to the end.")
    counts = comparison.get("counts") or Counter(entry.get("verdict") for entry in comparison.get("items") or ())
    if comparison:
        words = ("worse", "better", "missing", "new", "same")
        parts = [f"{counts[word]} {'the same' if word == 'same' else word}" for word in words if counts.get(word)]
        sentences.append(f"Against the baseline: {', '.join(parts) or 'nothing to compare'}.")
    worse = counts.get("worse") or any(row.verdict == "worse" for row in rows)
    return not unexpected and not idle and not worse, sentences


def _facts(items: Sequence[Mapping[str, Any]]) -> list[Fact]:
    certified = [item for item in items if item.get("certified") is True]
    judged = sum(item.get("certified") is not None for item in items)
    facts = []
    if judged:
        facts.append(Fact(_powers(str(len(certified))), f"of {judged}", "designs certified"))
    distances = _numbers((item.get("measures") or {}).get("distance_rms") for item in certified)
    if distances:
        words = "rms distance" + (", median of the certified" if len(distances) > 1 else "")
        facts.append(Fact(_powers(formatted(statistics.median(distances))), "L", words))
    seconds, memory = _numbers(item.get("seconds") for item in items), _numbers(item.get("peak_mb") for item in items)
    if seconds:
        words = f"an item, in the median; the slowest {_duration(max(seconds))}, all together {_duration(sum(seconds))}"
        facts.append(
            Fact(_powers(formatted(statistics.median(seconds))), "s", words if len(seconds) > 1 else "it took")
        )
    if memory:
        facts.append(Fact(_powers(formatted(max(memory))), "MB", "the largest peak memory"))
    return facts


def _numbers(values: Any) -> list[float]:
    return [
        value for value in values if isinstance(value, (int, float)) and not isinstance(value, bool) and value == value
    ]


def _duration(seconds: float) -> str:
    if seconds < 120:
        return f"{formatted(seconds)} s"
    return f"{formatted(seconds / 60)} min" if seconds < 7200 else f"{formatted(seconds / 3600)} h"


def _columns(items: Sequence[Mapping[str, Any]]) -> list[tuple[str, str, tuple[str, ...]]]:
    """The columns of numbers that any item has a value in."""

    def has(item: Mapping[str, Any], place: tuple[str, ...]) -> bool:
        inner = item.get(place[0]) if len(place) == 1 else (item.get(place[0]) or {}).get(place[1])
        return inner is not None

    return [column for column in _COLUMNS if any(has(item, column[2]) for item in items)]


def _tolerances(comparison: Mapping[str, Any]) -> list[tuple[Tolerance, Markup]]:
    told = comparison.get("tolerances") or {}
    return [(row, _powers(allowed_words(told[row.measure], row.unit))) for row in tolerance_rows(comparison)]


def _powers(text: str) -> Markup:
    """A formatted number as markup: what stands between ^ and $ is an exponent."""
    from markupsafe import Markup, escape

    return Markup(str(escape(text)).replace("^", "<sup>").replace("$", "</sup>"))
