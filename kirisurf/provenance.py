"""What a run was made from: hashes of its inputs, of its spec, and of the program itself.

Two runs of one key hold the same numbers, whoever made them and when: a batch that is started again believes a
finished run if its key is the one it would ask for now.
"""

from __future__ import annotations

import hashlib
import json
import os
import stat
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from kirisurf.naming import is_file_name
from kirisurf.runs.record import versions
from kirisurf.spec import RECTANGLE, FitSpec

ROOMS = ("kirisurf", "analysis", "viewers", "sample_surfaces")
_CODE = (".py", ".html", ".toml", ".js", ".css", ".json")


@cache
def source_digest() -> str:
    """Return a hash (16 hexadecimal digits) of the code of kirisurf: what is being written has no version yet."""
    home, digest = Path(__file__).resolve().parent.parent, hashlib.sha256()
    for room in ROOMS:
        for path in sorted((home / room).rglob("*")):
            if path.suffix in _CODE and path.is_file():
                digest.update(f"{path.relative_to(home).as_posix()}\0".encode())
                digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


def inputs(spec: FitSpec) -> dict[str, str | None]:
    """Return the hash of every file that a resolved spec names: of target, tessellation and contracted outline.

    None stands for a file that cannot be read; what is no file has no entry.
    """
    named = {"target": spec.target, "tessellation": spec.tessellation, "contracted": spec.contracted}
    return {
        name: _file_hash(value)
        for name, value in named.items()
        if is_file_name(value) and not (name == "contracted" and value.startswith(f"{RECTANGLE}:"))
    }


def key(spec: FitSpec, found: Mapping[str, str | None], pictures: bool) -> str:
    """Return one hash (64 hexadecimal digits) of all that a run depends on.

    Parameters
    ----------
    spec : FitSpec
        Resolved, as it was asked for.
    found : mapping
        The hashes of its :func:`inputs`.
    pictures : bool
        Whether pictures are drawn.
    """
    # the content of a file counts, not where it lies
    asked = {name: value for name, value in spec.as_dict().items() if name not in found}
    parts = {
        "spec": asked,
        "inputs": {name: found[name] for name in sorted(found)},
        "names": {name: os.path.basename(str(getattr(spec, name))) for name in sorted(found)},
        "pictures": pictures,
        "versions": versions(),
        "source": source_digest(),
    }
    # surrogates stand for bytes of file names that are no text
    text = json.dumps(parts, sort_keys=True, ensure_ascii=True)
    return hashlib.sha256(text.encode("ascii")).hexdigest()


def _file_hash(name: str) -> str | None:
    try:
        handle = os.open(name, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except (OSError, ValueError):
        return None
    found = os.fstat(handle)
    # a file of no size is empty, or a door to the system of which no end is known
    if not stat.S_ISREG(found.st_mode) or not found.st_size:
        os.close(handle)
        return hashlib.sha256(b"").hexdigest() if stat.S_ISREG(found.st_mode) else None
    with os.fdopen(handle, "rb") as file:
        try:
            return hashlib.file_digest(file, "sha256").hexdigest()
        except OSError:
            return None
