"""Rows of a batch: every item of its summary as the page shows it, with how it ended, against what, and a safe link."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

from kirisurf.errors import ParameterError

CODES: Mapping[object, str] = {
    0: "done",
    1: "done with warnings",
    2: "wrong parameter",
    3: "unreadable",
    4: "unusable",
    5: "not within tolerance",
    6: "time or memory limit",
    7: "output not written",
    70: "internal error",
    130: "interrupted",
}
_ORDER = (
    "done",
    "done with warnings",
    "not within tolerance",
    "time limit",
    "memory limit",
    "unusable",
    "unreadable",
    "wrong parameter",
    "output not written",
    "crashed",
    "internal error",
    "interrupted",
    "not run",
)
_LINES = 8
_MARKS = {"good": "\u2713", "warn": "!", "bad": "\u2717", "kept": "\u25cb", "none": "\u2013"}
# marks that turn the direction of the text round them
_TURNING = frozenset("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")


@dataclass(frozen=True)
class BatchRow:
    """One item as the page shows it.

    Attributes
    ----------
    index : int
        Its place in the summary.
    name, target, outcome, reason : str
        The reason without the failures, which are sentences of their own.
    kind : str
        good, warn (done, with warnings), bad (not as expected), kept (failed, as expected) or none (not run).
    mark : str
        A sign for the kind, so that color is never alone.
    expected : str
        The outcomes that were expected, in words.
    options : tuple of str
        Values of the varied options, in their order; empty where it has none.
    sentences : tuple of str
        Failures and warnings.
    said : tuple of str
        The last lines that its process wrote.
    href : str or None
        Relative address of its report.
    verdict : str
        Against the baseline: better, same, worse or new; empty where nothing is compared.
    """

    index: int
    name: str
    target: str
    outcome: str
    reason: str
    kind: str
    mark: str
    expected: str
    options: tuple[str, ...]
    sentences: tuple[str, ...]
    said: tuple[str, ...]
    href: str | None
    verdict: str

    @property
    def severity(self) -> int:
        """Rank of the outcome, the better the lower."""
        return severity(self.outcome)

    @property
    def target_name(self) -> str:
        """The target without the folders of who asked for it: the page may be mailed."""
        return self.target.rsplit("/", 1)[-1] if self.target.startswith(("/", "../")) else self.target

    @property
    def needs_attention(self) -> bool:
        """Whether it did not end as expected, or is worse than the baseline."""
        return self.kind == "bad" or self.verdict == "worse"


def batch_rows(summary: Mapping[str, Any]) -> tuple[BatchRow, ...]:
    """Return a row for every item of a summary, in its order.

    Raises
    ------
    ParameterError
        Where the items are no list of mappings with a name each.
    """
    items = summary.get("items")
    if not isinstance(items, Sequence) or not all(
        isinstance(item, Mapping) and isinstance(item.get("name"), str) for item in items
    ):
        raise ParameterError(
            f"summary of a batch: expected a list of items with a name each, got {type(items).__name__}"
        )
    verdicts = {
        entry.get("name"): str(entry.get("verdict") or "")
        for entry in (summary.get("comparison") or {}).get("items", ())
    }
    varied = tuple(summary.get("varied") or ())
    return tuple(_row(k, item, varied, verdicts.get(item["name"], "")) for k, item in enumerate(items))


def severity(outcome: str) -> int:
    """Return the rank of an outcome, the better the lower; unknown ones come last."""
    return _ORDER.index(outcome) if outcome in _ORDER else len(_ORDER)


def legible(text: object) -> str:
    r"""Return a text that shows what is in it: control characters as pictures, lone surrogates and what turns as codes.

    Examples
    --------
    >>> legible("a\nb") == "a\u240ab", legible("caf\udce9") == r"caf\udce9"
    (True, True)
    """
    return "".join(map(_shown, str(text)))


def legible_document(document: Any) -> Any:
    """Return a JSON document with every text in it made legible, names of members too."""
    if isinstance(document, str):
        return legible(document)
    if isinstance(document, Mapping):
        return {legible(key): legible_document(value) for key, value in document.items()}
    if isinstance(document, (list, tuple)):
        return [legible_document(value) for value in document]
    return document


def report_address(folder: object) -> str | None:
    """Return the address of the report in a run folder, relative to the page; None where there can be none.

    A folder is what it says, never a scheme or a host, and it lies below the page.

    Examples
    --------
    >>> report_address("runs/a b#1"), report_address("javascript:alert(1)"), report_address("../other")
    ('./runs/a%20b%231/report.html', './javascript%3Aalert%281%29/report.html', None)
    """
    if not isinstance(folder, str) or not folder.strip("/") or "\0" in folder or ".." in folder.split("/"):
        return None
    try:
        # the bytes that the file system has, of names that are no UTF-8 too
        plain = "/".join(part for part in folder.split("/") if part).encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        return None
    return f"./{quote(plain, safe='/')}/report.html"


def _row(index: int, item: Mapping[str, Any], varied: Sequence[str], verdict: str) -> BatchRow:
    outcome = legible(item.get("outcome") or "not run")
    kind = _kind(outcome, item.get("is_expected"))
    options = item.get("options") or {}
    failures = [str(sentence) for sentence in item.get("failures") or ()]
    sentences = [*failures, *(item.get("warnings") or ())]
    codes = [code for code in (item.get("expect") or ()) if isinstance(code, int)]
    return BatchRow(
        index,
        legible(item["name"]),
        legible(item.get("target") or ""),
        outcome,
        legible(_without(str(item.get("reason") or ""), failures)),
        kind,
        _MARKS[kind],
        " or ".join(CODES.get(code, f"exit code {code}") for code in codes),
        tuple(legible(options[name]) if options.get(name) is not None else "" for name in varied),
        tuple(legible(sentence) for sentence in sentences),
        tuple(legible(line) for line in (item.get("said") or ())[-_LINES:]),
        report_address(item.get("folder")),
        legible(verdict),
    )


def _without(reason: str, failures: Sequence[str]) -> str:
    """A reason without the failures that follow in it: they are shown as a list."""
    places = [reason.find(sentence) for sentence in failures if sentence and sentence in reason]
    return (reason[: min(places)] if places else reason).strip() or reason


def _kind(outcome: str, is_expected: object) -> str:
    if outcome in ("not run", "interrupted"):
        return "none"
    if is_expected is False:
        return "bad"
    return {"done": "good", "done with warnings": "warn"}.get(outcome, "kept")


def _shown(letter: str) -> str:
    number = ord(letter)
    if number < 0x20 or number == 0x7F:
        return chr(0x2421 if number == 0x7F else 0x2400 + number)
    if letter in _TURNING or unicodedata.category(letter) in ("Cc", "Cs"):
        return f"\\u{number:04x}"
    return letter
