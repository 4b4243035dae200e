"""The summary of a batch: one plain value that is written as JSON, as a table, and as a page."""

from __future__ import annotations

import csv
import io
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from kirisurf.batch.outcome import Outcome
from kirisurf.batch.reading import BatchSpec

COLUMNS = (
    "name",
    "target",
    "code",
    "outcome",
    "is_expected",
    "certified",
    "status",
    "tiles",
    "holes",
    "iterations",
)
_LAST = ("seconds", "peak_mb", "folder", "reason")


def summary_of(
    spec: BatchSpec, source: str, version: str, outcomes: Sequence[Outcome], comparison: Mapping[str, Any] | None
) -> dict[str, Any]:
    """Return the summary as plain values.

    Parameters
    ----------
    spec : BatchSpec
    source : str
        Name of what the batch was read from.
    version : str
        Of kirisurf.
    outcomes : sequence of Outcome
        In the order of the items.
    comparison : mapping, optional
        See :func:`kirisurf.batch.baseline.comparison`.
    """
    counts = Counter(each.outcome for each in outcomes)
    return {
        "title": spec.title,
        "kirisurf": version,
        "spec": source,
        "counts": {
            **dict(sorted(counts.items())),
            "total": len(outcomes),
            "unexpected": sum(not each.is_expected for each in outcomes),
        },
        "varied": list(spec.varied),
        "limits": {"seconds": spec.limits.seconds, "memory_mb": spec.limits.memory_mb},
        "notes": list(spec.notes),
        "items": [each.as_dict() for each in outcomes],
        "comparison": None if comparison is None else dict(comparison),
    }


def csv_text(outcomes: Sequence[Outcome], varied: Sequence[str]) -> str:
    """Return one line an item in full precision; what is not known is an empty cell."""
    measures = list(dict.fromkeys(name for each in outcomes for name in each.measures))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*COLUMNS, *varied, *measures, *_LAST])
    for each in outcomes:
        values = [getattr(each, name) for name in COLUMNS]
        values += [each.options.get(name) for name in varied]
        values += [each.measures.get(name) for name in measures]
        values += [getattr(each, name) for name in _LAST]
        writer.writerow([_cell(value) for value in values])
    return text.getvalue()


def _cell(value: Any) -> str:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value) if isinstance(value, float) else str(value)
