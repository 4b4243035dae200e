"""The baseline of a batch: what every item came to, as small readable text that a reviewer can follow line by line."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from kirisurf.batch.outcome import Outcome
from kirisurf.batch.reading import BatchSpec
from kirisurf.errors import ParameterError, UnreadableError
from kirisurf.formats.source import read_bytes
from kirisurf.judging import regression
from kirisurf.spec import parse_toml

SUMMARY = "summary.json"
DIGITS = 9
"""Significant digits in a baseline: far below any tolerance, and few enough to read."""

_LIMIT_MB = 256
_HEAD = """\
# Baseline of kirisurf batch: one table an item. Lengths are over the median tile edge, angles in radians.
# `kirisurf batch SPEC -o DIR --baseline THIS` compares; with --accept it is written anew.
"""

Values = Mapping[str, Mapping[str, Any]]


def read_baseline(path: str | os.PathLike[str]) -> Values:
    """Return the values of every item of a baseline: a file, or the folder of another batch.

    Raises
    ------
    UnreadableError
        Where there is none, or it cannot be read.
    ParameterError
        Where it is no baseline.
    """
    path = Path(path)
    file = path / SUMMARY if path.is_dir() else path
    try:
        text = read_bytes(file, _LIMIT_MB).decode("utf-8")
    except UnicodeDecodeError as problem:
        raise UnreadableError(f"{file}: expected text in UTF-8, got {problem.reason}") from None
    if file.suffix.lower() == ".json":
        try:
            items = json.loads(text)["items"]
            return {str(each["name"]): _values(each) for each in items}
        except (ValueError, KeyError, TypeError, AttributeError):
            raise ParameterError(f"{file}: expected the summary of a batch, got another file") from None
    items = parse_toml(text, str(file)).get("items")
    if not isinstance(items, dict) or not all(isinstance(each, dict) for each in items.values()):
        raise ParameterError(f"{file}: expected a baseline with a table for every item, got another file")
    return items


def baseline_text(items: Sequence[Mapping[str, Any]], before: Values | None = None) -> str:
    """Return the items of a summary as a baseline.

    Parameters
    ----------
    items : sequence of mapping
    before : mapping, optional
        The baseline that is replaced: values that are within the usual tolerances keep its digits, so that the
        lines that differ are those that changed.
    """
    import tomli_w

    now = {str(each["name"]): _values(each) for each in items}
    same = (
        set()
        if before is None
        else {
            each.name for each in regression().compared(before, now, regression().TOLERANCES) if each.verdict == "same"
        }
    )
    kept = {name: dict((before or {})[name]) if name in same else _rounded(values) for name, values in now.items()}
    return _HEAD + "\n" + tomli_w.dumps({"items": dict(sorted(kept.items()))})


def comparison(spec: BatchSpec, outcomes: Sequence[Outcome], before: Values, name: str) -> dict[str, Any]:
    """Return the comparison of outcomes with a baseline as plain values.

    Raises
    ------
    ParameterError
        Where the batch gives a tolerance for what is no measure.
    """
    judge = regression()
    try:
        allowed = judge.tolerances(spec.tolerances)
    except ValueError as problem:
        raise ParameterError(str(problem)) from None
    found = judge.compared(before, {each.name: _values(each.as_dict()) for each in outcomes}, allowed)
    return {
        "baseline": name,
        "tolerances": {measure: tolerance.as_dict() for measure, tolerance in allowed.items()},
        "counts": judge.counts(found),
        "items": [
            {"name": each.name, "verdict": each.verdict, "changes": [dict(vars(change)) for change in each.changes]}
            for each in found
        ],
    }


def _values(item: Mapping[str, Any]) -> dict[str, Any]:
    """What a baseline keeps of an item: how it ended, and its measures; null where there are none."""
    measures = {name: value for name, value in (item.get("measures") or {}).items() if value is not None}
    ends = {
        name: item[name] for name in ("code", "certified", "tiles", "holes", "iterations") if item[name] is not None
    }
    return {**ends, **measures}


def _rounded(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value for name, value in values.items()}
