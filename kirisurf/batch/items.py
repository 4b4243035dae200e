"""The items of a batch: each one target with its options, under a name that is safe as a folder."""

from __future__ import annotations

import dataclasses
import hashlib
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from kirisurf.errors import KirisurfError, ParameterError
from kirisurf.naming import is_file_name
from kirisurf.spec import FitSpec
from kirisurf.targets import resolved

LONGEST_NAME = 120
"""Bytes of a name: a folder of that name, and files beside it with longer endings, exist on every disk."""

FINE = (0, 1)
"""Exit codes that an item is expected to end with, where nothing else is said."""


@dataclass(frozen=True)
class Asked:
    """One target with its options, as a spec of a batch says it.

    Attributes
    ----------
    options : mapping
        Options of a fit by their names, the target among them; relative paths start at `folder`.
    folder : Path
    label : str
        What the item is called after: the target, relative to the batch where it lies there.
    varied : mapping
        The options in which this item may differ from others of the same target.
    expect : tuple of int, optional
        Exit codes that count as expected.
    name : str
        Name of the item; empty where it follows from label and varied options.
    """

    options: Mapping[str, Any]
    folder: Path
    label: str
    varied: Mapping[str, Any] = field(default_factory=dict)
    expect: tuple[int, ...] | None = None
    name: str = ""


@dataclass(frozen=True)
class Item:
    """One fit of a batch.

    Attributes
    ----------
    name : str
        Unique in the batch; name of its folder.
    target : str
        As it was asked for.
    varied : mapping
        Options in which this item may differ from others of the same target.
    expect : tuple of int
        Exit codes that count as expected.
    is_stated : bool
        Whether they were stated, and are not just the usual ones.
    spec : FitSpec or None
        Resolved; None where the options are wrong.
    problem : str
        Why there is no spec.
    problem_code : int
        Exit code of that.
    """

    name: str
    target: str
    varied: Mapping[str, Any]
    expect: tuple[int, ...]
    is_stated: bool
    spec: FitSpec | None
    problem: str = ""
    problem_code: int = 2


def items_of(asked: Sequence[Asked]) -> tuple[Item, ...]:
    """Return the items in their order, each with a name of its own.

    An option that is wrong spoils its item, not the batch.

    Raises
    ------
    ParameterError
        Where two items were given one name, or there are none.
    """
    if not asked:
        raise ParameterError("batch: expected at least one target, got none")
    names = [each.name or _name_of(each) for each in asked]
    given = Counter(each.name for each in asked if each.name)
    for name, times in given.items():
        if times > 1:
            raise ParameterError(f"batch: expected a name for every item alone, got {name!r} {times} times")
    # file systems may take A and a for one
    often = Counter(name.lower() for name in names)
    found: list[Item] = []
    used: set[str] = set()
    for each, name in zip(asked, names, strict=True):
        if often[name.lower()] > 1:
            name = _marked(name, f"{each.folder}\0{sorted(each.options.items(), key=lambda pair: pair[0])}")
        if name.lower() in used:
            raise ParameterError(f"batch: expected every item once, got {each.label!r} again with the same options")
        used.add(name.lower())
        found.append(_item(each, name))
    return tuple(found)


def safe_name(text: str) -> str:
    """Return a text as a file name: letters, digits, and ._- alone, none of which leads; what is lost is a hash.

    Examples
    --------
    >>> safe_name("hood.stl"), safe_name("--rm -rf/é.stl")
    ('hood.stl', 'x--rm_-rf__.stl-b4604a')
    """
    plain = re.sub(r"[^A-Za-z0-9._-]", "_", text)
    if not plain[:1].isalnum():  # neither hidden nor an option
        plain = f"x{plain}"
    return plain if plain == text and len(plain) <= LONGEST_NAME else _marked(plain, text)


def _marked(name: str, of: str) -> str:
    digits = hashlib.sha256(of.encode("utf-8", "surrogateescape")).hexdigest()[:6]
    return f"{name[: LONGEST_NAME - 7]}-{digits}"


def _name_of(each: Asked) -> str:
    parts = [each.label]
    for option, value in each.varied.items():
        text = Path(str(value)).stem if is_file_name(str(value)) and option != "contracted" else str(value)
        parts.append(text if option == "tessellation" else f"{option.replace('_', '-')}-{text}")
    return safe_name("--".join(part.replace("/", "-").replace("\\", "-").replace(":", "-") for part in parts))


def _item(each: Asked, name: str) -> Item:
    target = str(each.options.get("target", ""))
    expect = FINE if each.expect is None else each.expect
    # bytes of a path that are no UTF-8 cannot be written to any table
    target = target.encode("utf-8", "backslashreplace").decode("utf-8")
    spec, problem, code = None, "", 0
    try:
        sized = bool({"cells", "tiles"} & set(each.options))
        spec = resolved(FitSpec.from_dict(each.options, name), each.folder, sized)
    except KirisurfError as found:
        problem, code = str(found), found.exit_code
    return Item(name, target, dict(each.varied), expect, each.expect is not None, spec, problem, code)


def option_names() -> tuple[str, ...]:
    """Return the names of the options of a fit."""
    return tuple(each.name for each in dataclasses.fields(FitSpec))
