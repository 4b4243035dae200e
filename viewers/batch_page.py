"""The page of a batch: one self-contained HTML file with the verdict, what needs attention, all items, and a wall.

The page has a script of its own for sorting and filtering, allowed by its hash; nothing else on it can run, whatever
names and messages say. Without scripts it is a plain table.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from viewers.batch_changes import ShownChange, Tolerance, allowed_words, shown_changes, tolerance_rows
from viewers.batch_head import batch_chips, batch_facts, batch_verdict, chip_keys, powers
from viewers.batch_rows import BatchRow, batch_rows, legible_document
from viewers.batch_wall import batch_wall
from viewers.report_page import data_address, page_template, shower

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
class Card:
    """An item that is shown in full: its row, its place among the compared ones, and what changed."""

    row: BatchRow
    place: int | None
    changes: list[ShownChange]


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
    chips = batch_chips(rows)
    state, sentences = batch_verdict(rows, comparison)
    return page_template("batch.html").render(
        title=document.get("title") or "batch",
        summary=document,
        rows=rows,
        show=shower(document),
        powers=powers,
        state=state,
        mark={"pass": "\u2713", "warn": "!", "fail": "\u2717"}[state],
        sentences=sentences,
        facts=batch_facts(document["items"]),
        chips=chips,
        keys={row.index: " ".join(chip_keys(row, chips)) for row in rows},
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


def _columns(items: Sequence[Mapping[str, Any]]) -> list[tuple[str, str, tuple[str, ...]]]:
    """The columns of numbers that any item has a value in."""

    def has(item: Mapping[str, Any], place: tuple[str, ...]) -> bool:
        inner = item.get(place[0]) if len(place) == 1 else (item.get(place[0]) or {}).get(place[1])
        return inner is not None

    return [column for column in _COLUMNS if any(has(item, column[2]) for item in items)]


def _tolerances(comparison: Mapping[str, Any]) -> list[tuple[Tolerance, Markup]]:
    told = comparison.get("tolerances") or {}
    return [(row, powers(allowed_words(told[row.measure], row.unit))) for row in tolerance_rows(comparison)]
