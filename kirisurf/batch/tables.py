"""Batches that are no TOML: a folder of targets, and a table with one fit a row."""

from __future__ import annotations

import csv
import io
import os
from pathlib import Path
from typing import Any

from kirisurf.batch.entries import BESIDE, check_names, codes, given_name, label
from kirisurf.batch.items import Asked, option_names
from kirisurf.errors import ParameterError
from kirisurf.formats.source import FORMATS as MESHES
from kirisurf.outlines import FORMATS as OUTLINES

SUFFIXES = (*MESHES, *OUTLINES)
_TEXTS = ("target", "tessellation", "contracted", "units", "initial", "solver", "closeness", "prefer", "cells")


def of_folder(path: Path) -> tuple[list[Asked], tuple[str, ...]]:
    """Return all meshes and outlines in a folder and below it, by name; hidden ones are left out."""
    asked: list[Asked] = []
    left: list[str] = []
    for folder, inner, names in os.walk(path):
        inner[:] = sorted(name for name in inner if not name.startswith("."))
        for name in sorted(names):
            file = Path(folder, name)
            if name.startswith("."):
                continue
            if file.suffix.lower() in SUFFIXES:
                inside = str(file.relative_to(path))
                asked.append(Asked({"target": f"./{inside}"}, path.absolute(), inside))
            else:
                left.append(str(file.relative_to(path)))
    if not asked:
        raise ParameterError(f"{path}: expected meshes or outlines ({', '.join(SUFFIXES)}), got a folder without")
    shown = ", ".join(left[:5]) + (", ..." if len(left) > 5 else "")
    note = f"{len(left)} file{'s' * (len(left) > 1)} left out, no mesh or outline by name: {shown}."
    return asked, (note,) if left else ()


def of_table(text: str, delimiter: str, folder: Path, source: str) -> list[Asked]:
    """Return the fits of a table."""
    try:
        rows = list(csv.reader(io.StringIO(text), delimiter=delimiter, strict=True))
    except csv.Error as problem:
        raise ParameterError(f"{source}: expected a table, got {problem}") from None
    rows = [row for row in rows if any(cell.strip() for cell in row)]
    if len(rows) < 2:
        raise ParameterError(f"{source}: expected a line of names and one line a fit, got {len(rows)} lines")
    head = [name.strip() for name in rows[0]]
    check_names(head, (*option_names(), *BESIDE), source)
    if "target" not in head or len(set(head)) < len(head):
        raise ParameterError(f"{source}: expected a column target, and every column once, got {', '.join(head)}")
    differ = [
        name
        for k, name in enumerate(head)
        if name not in ("target", *BESIDE) and len({row[k].strip() for row in rows[1:] if k < len(row)}) > 1
    ]
    asked = []
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(head):
            raise ParameterError(f"{source}: expected {len(head)} cells in line {number}, got {len(row)}")
        cells = {name: cell.strip() for name, cell in zip(head, row, strict=True) if cell.strip()}
        expect = codes(cells.pop("expect").split("|"), source) if "expect" in cells else None
        name = given_name(cells.pop("name", ""), source)
        options = {key: _value(key, cell) for key, cell in cells.items()}
        if "target" not in options:
            raise ParameterError(f"{source}: expected a target in line {number}, got none")
        varied = {key: options[key] for key in differ if key in options}
        asked.append(Asked(options, folder, label(str(options["target"])), varied, expect, name))
    return asked


def _value(name: str, cell: str) -> Any:
    """Return a cell as the value that TOML would hold: numbers and truths where options are such."""
    if name in _TEXTS:
        return cell
    if cell.lower() in ("true", "false"):
        return cell.lower() == "true"
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell
