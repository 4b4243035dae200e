"""The form of a run's record: what `result.json` has to hold before anything is made of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from kirisurf.errors import UnreadableError
from kirisurf.status import Status


def check_record(record: Any, path: Path) -> None:
    """Hold the content of a record to its form.

    Parameters
    ----------
    record : any
        As JSON gives it.
    path : Path
        Of the record, for the message.

    Raises
    ------
    UnreadableError
        Where it is the record of something else, an entry is missing or one has another form.
    """
    if not isinstance(record, Mapping) or not {"status", "certificate", "origin", "target", "files"} <= set(record):
        raise UnreadableError(f"{path}: expected the record of a kirisurf run, got another file")
    for key, (holds, what) in _FORM.items():
        if key in _OPTIONAL and record.get(key) is None:
            continue
        if key not in record:
            raise UnreadableError(f"{path}: expected the entry {key!r} ({what}), got none: the record is damaged")
        if not holds(record[key]):
            said = ascii(record[key])[:60]
            raise UnreadableError(f"{path}: expected {what} for {key!r}, got {said}: the record is damaged")


def _is_number(value: Any) -> bool:
    # a bool is an int in Python, and an int may be too large to be a float
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e300


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**63


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _all(holds: Callable[[Any], bool], or_none: bool = False) -> Callable[[Any], bool]:
    """Return the test of a mapping of which all values hold."""

    def tested(value: Any) -> bool:
        return isinstance(value, Mapping) and all(holds(item) or (or_none and item is None) for item in value.values())

    return tested


def _are_texts(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(item, str) for item in value)


def _is_place(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(_is_number(item) for item in value)


def _is_target(value: Any) -> bool:
    return isinstance(value, Mapping) and isinstance(value.get("name"), str)


def _is_beside(value: Any) -> bool:
    if not isinstance(value, Mapping) or not {"failures", "limits", "pieces", "flipped"} <= set(value):
        return False
    others = (item for key, item in value.items() if key not in ("failures", "limits"))
    return (
        _are_texts(value["failures"])
        and _all(_is_number)(value["limits"])
        and all(item is None or isinstance(item, bool) or _is_number(item) for item in others)
    )


def _is_history(value: Any) -> bool:
    return isinstance(value, list) and all(_all(_is_number, or_none=True)(step) for step in value)


def _is_feasibility(value: Any) -> bool:
    return isinstance(value, Mapping) and all(_is_number(value.get(key)) for key in ("least", "most"))


_OPTIONAL = ("feasibility",)
_NUMBERS = (_all(_is_number, or_none=True), "numbers by name")
_FORM: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "status": (lambda value: isinstance(value, str) and value in Status.__members__, "the name of a status"),
    "reason": (_is_text, "a text"),
    "certified": (lambda value: isinstance(value, bool), "true or false"),
    "certificate": _NUMBERS,
    "certificate_beside": (_is_beside, "failures, limits and numbers"),
    "measures": _NUMBERS,
    "seconds": _NUMBERS,
    "history": (_is_history, "residuals of every step"),
    "feasibility": (_is_feasibility, "the least and the largest stretch"),
    "tiles": (_is_count, "a count"),
    "holes": (_is_count, "a count"),
    "edge_length": (lambda value: _is_number(value) and value > 0, "a length"),
    "units": (_is_text, "a text"),
    "origin": (_is_place, "three numbers"),
    "target": (_is_target, "a target with a name"),
    "notes": (_are_texts, "texts"),
    "warnings": (_are_texts, "texts"),
    "exit_code": (_is_count, "an exit code"),
    "files": (_all(_is_text), "hashes by name"),
}
