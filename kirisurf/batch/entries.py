"""The entries of a batch, checked: names that are known, exit codes, names of items."""

from __future__ import annotations

import difflib
import os
from collections.abc import Mapping, Sequence
from typing import Any

from kirisurf.batch.items import safe_name
from kirisurf.errors import ParameterError

BESIDE = ("name", "expect")
"""What an entry may say beside options of a fit."""


def label(target: str) -> str:
    """Return what an item is called after: a relative path as it is, of a path that leads elsewhere the file's name."""
    plain = os.path.normpath(target) if target.strip() else target
    return os.path.basename(plain) if os.path.isabs(plain) or plain.startswith("..") else plain


def expected(values: Mapping[str, Any], source: str) -> tuple[int, ...] | None:
    """Return the exit codes that an entry expects; None where it says nothing."""
    found = values.get("expect")
    return None if found is None else codes(found if isinstance(found, list) else [found], source)


def codes(values: Sequence[Any], source: str) -> tuple[int, ...]:
    """Return exit codes, checked."""
    try:
        found = tuple(sorted({int(code) for code in values if not isinstance(code, (bool, float))}))
    except (TypeError, ValueError):
        found = ()
    if not found or not all(0 <= code <= 255 for code in found):
        raise ParameterError(f"{source}: expected exit codes for expect, such as 0 or [3, 4], got {list(values)!r}")
    return found


def given_name(name: Any, source: str) -> str:
    """Return the name that an item was given, checked."""
    if not isinstance(name, str) or (name and safe_name(name) != name):
        raise ParameterError(f"{source}: expected names of items of letters, digits and ._- alone, got {name!r}")
    return name


def table(values: Mapping[str, Any], name: str, source: str) -> dict[str, Any]:
    """Return a table of the values, checked."""
    found = values.get(name, {})
    if not isinstance(found, dict):
        raise ParameterError(f"{source}: expected a table [{name}], got {found!r}")
    return dict(found)


def listed(values: Mapping[str, Any], name: str, source: str) -> list[Any]:
    """Return a list of the values, checked."""
    found = values.get(name, [])
    if not isinstance(found, list):
        raise ParameterError(f"{source}: expected a list of {name}, got {found!r}")
    return found


def check_names(names: Any, known: Sequence[str], source: str) -> None:
    """Check that names are among those that are known."""
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(str(name), known, n=1)
            hint = f" (did you mean {near[0]!r}?)" if near else f" (known: {', '.join(known)})"
            raise ParameterError(f"{source}: expected known names, got {name!r}{hint}")
