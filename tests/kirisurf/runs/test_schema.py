"""Records that were damaged or made up: whatever stands in them, reading a run ends in a run or in one line."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from kirisurf.errors import UnreadableError
from kirisurf.runs.schema import check_record

RECORD: dict[str, Any] = {
    "status": "CONVERGED",
    "reason": "Converged.",
    "certified": True,
    "certificate": {"length": 1e-12, "loop": None},
    "certificate_beside": {"failures": [], "limits": {"length": 1e-9}, "pieces": 1, "flipped": 0, "flatness": None},
    "measures": {"edge_length": 0.5, "hole_area": None},
    "seconds": {"total": 1.5},
    "history": [{"length": 0.1}, {"length": 1e-12}],
    "tiles": 16,
    "holes": 9,
    "edge_length": 0.5,
    "units": "mm (assumed)",
    "origin": [0.0, 0.0, 0.0],
    "target": {"name": "hypar", "faces": 12, "smooth": None},
    "notes": ["A note."],
    "warnings": [],
    "exit_code": 0,
    "feasibility": {"sentence": "Enough.", "least": 1.0, "most": 1.4},
    "files": {"run.toml": "00"},
}
PLACE = Path("run/result.json")
HOSTILE: tuple[Any, ...] = (
    True, -1, 10**400, float("nan"), float("inf"), "1", [[1]], {"a": {}}, ["a", 1], "\ud800\n\x1b[31m",
)  # fmt: skip


def _places(value: Any, above: tuple = ()) -> Iterator[tuple]:
    for key in value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ():
        yield (*above, key)
        yield from _places(value[key], (*above, key))


def test_a_sound_record_passes() -> None:
    check_record(RECORD, PLACE)
    check_record({key: value for key, value in RECORD.items() if key != "feasibility"}, PLACE)
    check_record(RECORD | {"feasibility": None, "of later versions": object()}, PLACE)


@pytest.mark.parametrize("key", [key for key in RECORD if key != "feasibility"])
def test_what_is_missing_is_named(key: str) -> None:
    with pytest.raises(UnreadableError, match=r"run/result.json: expected"):
        check_record({name: value for name, value in RECORD.items() if name != key}, PLACE)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("status", "FINE"),
        ("certified", 1),
        ("certificate", {"length": "1e-12"}),
        ("certificate_beside", {"failures": [], "limits": {}}),
        ("measures", {"edge_length": True}),
        ("seconds", [1.5]),
        ("history", [{"length": "0"}]),
        ("tiles", 1.5),
        ("edge_length", 0.0),
        ("origin", [0.0, 0.0]),
        ("origin", [0.0, 0.0, float("nan")]),
        ("target", {"name": 3}),
        ("notes", "A note."),
        ("files", {"run.toml": None}),
        ("feasibility", {"least": "1"}),
    ],
)
def test_what_has_another_form_is_named(key: str, value: Any) -> None:
    with pytest.raises(UnreadableError, match=f"{key!r}, got .*: the record is damaged"):
        check_record(RECORD | {key: value}, PLACE)


@pytest.mark.parametrize("record", [None, [], "x", 3, {}, {"status": "CONVERGED"}])
def test_other_json_is_no_record(record: Any) -> None:
    with pytest.raises(UnreadableError, match="expected the record of a kirisurf run"):
        check_record(record, PLACE)


def test_messages_can_be_printed() -> None:
    for seed in range(400):
        chance, damaged = random.Random(seed), copy.deepcopy(RECORD)
        *way, last = chance.choice(list(_places(damaged)))
        here = damaged
        for key in way:
            here = here[key]
        here[last] = chance.choice(HOSTILE)
        try:
            check_record(damaged, PLACE)
        except UnreadableError as problem:
            assert str(problem).isprintable()
        json.dumps(damaged)
