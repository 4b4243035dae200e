"""The head of the page of a batch: the verdict in a sentence, how many items ended how, and the numbers of all."""

from __future__ import annotations

import math
import statistics
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from viewers.batch_rows import BatchRow, severity
from viewers.report_page import formatted

if TYPE_CHECKING:
    from markupsafe import Markup


@dataclass(frozen=True)
class Chip:
    """A number of items that the table can be narrowed to: key, words, how many, and their kind or verdict."""

    key: str
    words: str
    count: int
    kind: str


@dataclass(frozen=True)
class Fact:
    """A number at the head of the page."""

    value: Markup
    unit: str
    words: str


def batch_verdict(rows: Sequence[BatchRow], comparison: Mapping[str, Any]) -> tuple[str, list[str]]:
    """Return whether all is well (pass, warn where the baseline has items that are missing, or fail), and why."""
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
        sentences.append(f"{refused} of them failed, as expected.")
    if idle:
        sentences.append(f"{idle} {'was' if idle == 1 else 'were'} not run to the end.")
    counts = comparison.get("counts") or Counter(entry.get("verdict") for entry in comparison.get("items") or ())
    if comparison:
        words = ("worse", "better", "missing", "new", "same")
        parts = [f"{counts[word]} {'the same' if word == 'same' else word}" for word in words if counts.get(word)]
        sentences.append(f"Against the baseline: {', '.join(parts) or 'nothing to compare'}.")
    worse = counts.get("worse") or any(row.verdict == "worse" for row in rows)
    if unexpected or idle or worse:
        return "fail", sentences
    return "warn" if counts.get("missing") else "pass", sentences


def batch_facts(items: Sequence[Mapping[str, Any]]) -> list[Fact]:
    """Return the numbers of the whole batch, without those that no item has."""
    certified = [item for item in items if item.get("certified") is True]
    judged = sum(item.get("certified") is not None for item in items)
    facts = []
    if judged:
        facts.append(Fact(powers(str(len(certified))), f"of {judged}", "designs certified"))
    distances = _numbers((item.get("measures") or {}).get("distance_rms") for item in certified)
    if distances:
        words = "rms distance" + (", median of the certified" if len(distances) > 1 else "")
        facts.append(Fact(powers(formatted(statistics.median(distances))), "L", words))
    seconds, memory = _numbers(item.get("seconds") for item in items), _numbers(item.get("peak_mb") for item in items)
    if seconds:
        words = f"an item, in the median; the slowest {_duration(max(seconds))}, all together {_duration(sum(seconds))}"
        facts.append(Fact(powers(formatted(statistics.median(seconds))), "s", words if len(seconds) > 1 else "it took"))
    if memory:
        facts.append(Fact(powers(formatted(max(memory))), "MB", "the largest peak memory"))
    return facts


def _numbers(values: Iterable[object]) -> list[float]:
    found = [value for value in values if isinstance(value, (int, float)) and not isinstance(value, bool)]
    return [value for value in found if math.isfinite(value)]


def _duration(seconds: float) -> str:
    if seconds < 120:
        return f"{formatted(seconds)} s"
    return f"{formatted(seconds / 60)} min" if seconds < 7200 else f"{formatted(seconds / 3600)} h"


def batch_chips(rows: Sequence[BatchRow]) -> list[Chip]:
    """Return how many items ended how, and how they stand to the baseline; none of nothing."""
    verdicts = Counter(row.verdict for row in rows)
    outcomes = Counter(row.outcome for row in rows)
    chips = [Chip("unexpected", "not as expected", sum(row.kind == "bad" for row in rows), "bad")]
    kinds = {"worse": "bad", "better": "good", "same": "kept", "new": "kept"}
    chips += [Chip(f"v-{verdict}", verdict, verdicts[verdict], kind) for verdict, kind in kinds.items()]
    for k, outcome in enumerate(sorted(outcomes, key=severity)):
        kind = {"done": "good", "done with warnings": "warn"}.get(outcome, "kept")
        chips.append(Chip(f"o-{k}", outcome, outcomes[outcome], kind))
    return [chip for chip in chips if chip.count]


def chip_keys(row: BatchRow, chips: Sequence[Chip]) -> list[str]:
    """Return the keys of the chips that choose an item."""
    words = {row.outcome, row.verdict} | ({"not as expected"} if row.kind == "bad" else set())
    return [chip.key for chip in chips if chip.words in words]


def powers(text: str) -> Markup:
    """Return a formatted number as markup: what stands between ^ and $ is an exponent."""
    from markupsafe import Markup, escape

    return Markup(str(escape(text)).replace("^", "<sup>").replace("$", "</sup>"))
