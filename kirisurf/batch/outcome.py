"""The recorded outcome of one item: what its run says, or why there is none."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from kirisurf.batch.items import Item
from kirisurf.batch.order import Answer
from kirisurf.runs.folder import RESULT
from kirisurf.runs.record import sha256

WORDS = {
    0: "done",
    1: "done with warnings",
    2: "wrong parameter",
    3: "unreadable",
    4: "unusable",
    5: "not within tolerance",
    6: "time limit",
    7: "output not written",
    70: "internal error",
    130: "interrupted",
}
"""Words for exit codes; a limit of memory and a crash have words of their own."""

MEASURES = (
    "gaussian_curvature_difference_relative",
    "mean_curvature_difference_relative",
    "angle_defect_difference_relative",
    "area_magnification",
    "tile_area_spread",
    "corner_angle_min",
)
"""Measures of a run that an outcome keeps, beside the rows of the certificate."""

FINISHED = (0, 1, 5, 6)
"""Exit codes of runs that would end alike if they were made again: these are not made again."""


@dataclass(frozen=True)
class Outcome:
    """How one item ended.

    Attributes
    ----------
    name, target : str
    options : mapping
        Options in which items may differ.
    code : int
        Exit code, as the command line's.
    outcome : str
        One of the values of `WORDS`, 'memory limit', 'crashed' or 'not run'.
    expect : tuple of int
    is_expected : bool
    status : str or None
        How the solve ended.
    reason : str
        A sentence.
    certified : bool or None
    tiles, holes, iterations : int or None
    measures : mapping of str to float or None
        Rows of the certificate, and `MEASURES`.
    warnings, failures, said : tuple of str
    seconds, peak_mb : float or None
    folder : str or None
        Run folder, relative to that of the batch.
    """

    name: str
    target: str
    options: Mapping[str, Any]
    code: int
    outcome: str
    expect: tuple[int, ...]
    is_expected: bool
    reason: str
    status: str | None = None
    certified: bool | None = None
    tiles: int | None = None
    holes: int | None = None
    iterations: int | None = None
    measures: Mapping[str, float | None] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    failures: tuple[str, ...] = ()
    said: tuple[str, ...] = ()
    seconds: float | None = None
    peak_mb: float | None = None
    folder: str | None = None

    def as_dict(self) -> dict[str, Any]:
        """Return plain values, as JSON knows them."""
        return asdict(self)


def outcome_of(item: Item, answer: Answer, folder: Path, root: Path) -> Outcome:
    """Return the outcome of an item that was just made, from the answer and the run, where there is one."""
    run = read_result(folder) if answer.code in (*FINISHED, 130) and not answer.message else None
    if run is None and answer.end == "time limit":
        # what it saved when it was asked to stop
        run = read_result(folder)
    if run is None:
        word = answer.end or WORDS.get(answer.code, "internal error")
        return Outcome(
            **_about(item, answer.code),
            outcome=word,
            reason=answer.message,
            said=answer.said,
            seconds=answer.seconds,
            peak_mb=answer.peak_mb,
        )
    found = _of_run(item, run, folder, root, answer.code, answer.end or WORDS.get(answer.code, "internal error"))
    beside = {"said": answer.said, "seconds": answer.seconds, "peak_mb": answer.peak_mb}
    reason = answer.message or found["reason"]
    return Outcome(**{**found, **beside, "reason": reason})


def outcome_of_run(item: Item, run: Mapping[str, Any], folder: Path, root: Path, peak_mb: float | None) -> Outcome:
    """Return the outcome of an item whose run was finished before."""
    code = int(run["exit_code"])
    seconds = (run.get("seconds") or {}).get("total")
    return Outcome(**_of_run(item, run, folder, root, code, WORDS[code]), seconds=seconds, peak_mb=peak_mb)


def not_run(item: Item, reason: str, code: int = 130) -> Outcome:
    """Return the outcome of an item that nobody came to."""
    return Outcome(**_about(item, code), outcome="not run", reason=reason)


def wrong(item: Item) -> Outcome:
    """Return the outcome of an item whose options are wrong."""
    return Outcome(**_about(item, item.problem_code), outcome=WORDS[item.problem_code], reason=item.problem)


def read_result(folder: Path) -> dict[str, Any] | None:
    """Return the commit record of a run; None where there is none, or none that can be read."""
    try:
        found = json.loads((folder / RESULT).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) and isinstance(found.get("certificate"), dict) else None


def is_whole(folder: Path, run: Mapping[str, Any]) -> bool:
    """Whether every file of a run is there as the run wrote it."""
    files = run.get("files")
    if not isinstance(files, dict) or not files:
        return False
    try:
        return all(sha256(folder / name) == digest for name, digest in files.items())
    except (OSError, ValueError, TypeError):
        return False


def _about(item: Item, code: int) -> dict[str, Any]:
    return {
        "name": item.name,
        "target": item.target,
        "options": dict(item.varied),
        "code": code,
        "expect": item.expect,
        "is_expected": code in item.expect,
    }


def _of_run(item: Item, run: Mapping[str, Any], folder: Path, root: Path, code: int, word: str) -> dict[str, Any]:
    measures = {**run["certificate"], **{name: (run.get("measures") or {}).get(name) for name in MEASURES}}
    return {
        **_about(item, code),
        "outcome": word,
        "reason": str(run.get("reason", "")),
        "status": run.get("status"),
        "certified": run.get("certified"),
        "tiles": run.get("tiles"),
        "holes": run.get("holes"),
        "iterations": run.get("iterations"),
        "measures": measures,
        "warnings": tuple(run.get("warnings") or ()),
        "failures": tuple((run.get("certificate_beside") or {}).get("failures") or ()),
        "folder": folder.relative_to(root).as_posix(),
    }
