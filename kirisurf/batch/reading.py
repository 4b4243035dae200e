"""What a batch is asked to do: a TOML file, a folder of targets, or a table (CSV, TSV) with one fit a row."""

from __future__ import annotations

import glob
import itertools
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from kirisurf.batch.entries import BESIDE, check_names, expected, given_name, label, listed, table
from kirisurf.batch.items import Asked, Item, items_of, option_names
from kirisurf.batch.tables import of_folder, of_table
from kirisurf.errors import ParameterError, UnreadableError
from kirisurf.formats.source import read_bytes
from kirisurf.spec import parse_toml

TABLES = {".csv": ",", ".tsv": "\t"}
MOST_ITEMS = 100_000
_KEYS = ("title", "targets", "options", "matrix", "items", "limits", "expect", "tolerances")
_LIMIT_MB = 16


@dataclass(frozen=True)
class Limits:
    """What one item may take.

    Attributes
    ----------
    seconds : float
        Wall-clock seconds; then it is asked to save what it has, and soon after that it is ended.
    memory_mb : float
        Memory of its own, in megabytes.
    """

    seconds: float = 3600.0
    memory_mb: float = 8000.0

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Limits:
        """Return limits from plain values.

        Raises
        ------
        ParameterError
            Where a name is unknown or a number out of range.
        """
        check_names(values, ("seconds", "memory_mb"), "limits")
        for name, number in values.items():
            least = {"seconds": 0.0, "memory_mb": 16.0}[name]
            if isinstance(number, bool) or not isinstance(number, (int, float)) or not least < number < 1e9:
                raise ParameterError(f"limits: expected {name} above {least:g} and below 1e9, got {number!r}")
        return cls(**{name: float(number) for name, number in values.items()})


@dataclass(frozen=True)
class BatchSpec:
    """A batch: what is fitted, and within which limits.

    Attributes
    ----------
    title : str
    items : tuple of Item
    limits : Limits
    tolerances : mapping of str to float
        Relative changes of measures against a baseline that count as none, where they are not the usual ones.
    notes : tuple of str
        What was left out.
    source : str
        Name of the file or folder that it was read from.
    """

    title: str
    items: tuple[Item, ...]
    limits: Limits
    tolerances: Mapping[str, float]
    notes: tuple[str, ...] = ()
    source: str = ""

    @property
    def varied(self) -> tuple[str, ...]:
        """Names of the options in which items may differ."""
        return tuple(dict.fromkeys(name for item in self.items for name in item.varied))


def read_batch(path: str | os.PathLike[str], given: Mapping[str, Any] | None = None) -> BatchSpec:
    """Read what a batch is asked to do.

    Parameters
    ----------
    path : path
        A TOML file; a folder, whose meshes and outlines are all fitted; or a table (CSV, TSV) whose columns are
        options of a fit, `target` among them.
    given : mapping, optional
        Options of a fit that all items take, whatever the file says.

    Raises
    ------
    UnreadableError
        Where it cannot be read.
    ParameterError
        Where it says something that is not known, or nothing.
    """
    return replace(_read(Path(path), dict(given or {})), source=Path(path).name)


def _read(path: Path, given: Mapping[str, Any]) -> BatchSpec:
    if path.is_dir():
        asked, notes = of_folder(path)
        return _built(path.absolute().name or "batch", asked, given, {}, {}, notes)
    suffix = path.suffix.lower()
    if suffix not in (".toml", *TABLES):
        raise UnreadableError(f"{path}: expected a batch (TOML, CSV, TSV) or a folder of targets, got {_got(path)}")
    try:
        text = read_bytes(path, _LIMIT_MB).decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise UnreadableError(f"{path}: expected text in UTF-8, got {problem.reason}") from None
    folder = path.absolute().parent
    if suffix in TABLES:
        return _built(path.stem, of_table(text, TABLES[suffix], folder, str(path)), given, {}, {}, ())
    values = parse_toml(text, str(path))
    check_names(values, _KEYS, str(path))
    asked = _of_values(values, folder, str(path))
    limits, tolerances = table(values, "limits", str(path)), table(values, "tolerances", str(path))
    return _built(str(values.get("title", path.stem)), asked, given, limits, tolerances, ())


def _built(
    title: str,
    asked: Sequence[Asked],
    given: Mapping[str, Any],
    limits: Mapping[str, Any],
    tolerances: Mapping[str, Any],
    notes: tuple[str, ...],
) -> BatchSpec:
    for name, number in tolerances.items():
        if isinstance(number, bool) or not isinstance(number, (int, float)) or not 0 <= number < 1e3:
            raise ParameterError(f"tolerances: expected a relative change from 0 for {name}, got {number!r}")
    clash = {name for each in asked for name in each.varied} & set(given)
    if clash:
        names = ", ".join(sorted(f"--{name.replace('_', '-')}" for name in clash))
        raise ParameterError(f"{names}: expected options that the batch does not vary, got one of its matrix")
    full = [replace(each, options=_over(each.options, given)) for each in asked]
    return BatchSpec(
        title, items_of(full), Limits.of(limits), {name: float(number) for name, number in tolerances.items()}, notes
    )


def _over(options: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Options with others on top; a size replaces the other kind of size."""
    below = {**options}
    if {"cells", "tiles"} & set(given):
        below = {name: value for name, value in below.items() if name not in ("cells", "tiles")}
    return {**below, **given}


def _of_values(values: Mapping[str, Any], folder: Path, source: str) -> list[Asked]:
    """Targets times matrix, then the items that are given one by one."""
    common, matrix = table(values, "options", source), table(values, "matrix", source)
    for several_options in (common, matrix):
        check_names(several_options, tuple(name for name in option_names() if name != "target"), source)
    for name, several in matrix.items():
        if not isinstance(several, list) or not several:
            raise ParameterError(f"{source}: expected a list of values for {name} of the matrix, got {several!r}")
    usual = expected(values, source)
    combinations = [dict(zip(matrix, each, strict=True)) for each in itertools.product(*matrix.values())]
    if {"cells", "tiles"} <= set(matrix):
        raise ParameterError(f"{source}: expected cells or tiles in the matrix, got both")
    targets = listed(values, "targets", source)
    asked: list[Asked] = []
    for entry in targets:
        for own in _targets_of(entry, folder, source):
            beside = {key: own.pop(key) for key in BESIDE if key in own}
            if combinations[1:] and "name" in beside:
                raise ParameterError(f"{source}: expected no name for a target that a matrix multiplies, got one")
            if len(asked) + len(combinations) > MOST_ITEMS:
                raise ParameterError(f"{source}: expected at most {MOST_ITEMS} items, got more")
            for varied in combinations:
                options = _over(_over(common, own), varied)
                codes, name = expected(beside, source) or usual, given_name(beside.get("name", ""), source)
                asked.append(Asked(options, folder, label(str(own["target"])), varied, codes, name))
    entries = listed(values, "items", source)
    differ = _different([{**common, **entry} for entry in entries if isinstance(entry, Mapping)])
    for entry in entries:
        if not isinstance(entry, Mapping) or not isinstance(entry.get("target"), str):
            raise ParameterError(f"{source}: expected a table with a target for each of the items, got {entry!r}")
        check_names(entry, (*option_names(), *BESIDE), source)
        own = {key: value for key, value in entry.items() if key not in BESIDE}
        varied = {key: value for key, value in own.items() if key in differ}
        codes, name = expected(entry, source) or usual, given_name(entry.get("name", ""), source)
        asked.append(Asked(_over(common, own), folder, label(own["target"]), varied, codes, name))
    return asked


def _different(entries: Sequence[Mapping[str, Any]]) -> set[str]:
    """Names of the options that are not the same in all entries."""
    names = {name for entry in entries for name in entry} - {"target", *BESIDE}
    return {name for name in names if len({repr(entry.get(name)) for entry in entries}) > 1}


def _targets_of(entry: Any, folder: Path, source: str) -> list[dict[str, Any]]:
    """The targets that one entry stands for: itself, or the files of a pattern such as meshes/*.stl."""
    own = {"target": entry} if isinstance(entry, str) else dict(entry) if isinstance(entry, Mapping) else {}
    if not isinstance(own.get("target"), str) or not own["target"].strip():
        raise ParameterError(f"{source}: expected targets as names or as tables with a target, got {entry!r}")
    check_names(own, (*option_names(), *BESIDE), source)
    target = own["target"]
    if not glob.has_magic(target) or (folder / target).exists():
        return [own]
    found = sorted(glob.glob(target, root_dir=folder, recursive=True))
    files = [name for name in found if (folder / name).is_file()]
    if not files:
        raise ParameterError(f"{source}: expected files that match {target!r}, got none")
    return [{**own, "target": name if os.path.isabs(name) else f"./{name}"} for name in files]


def _got(path: Path) -> str:
    return f"a file called {path.suffix or path.name}" if path.exists() else "a name that does not exist"
