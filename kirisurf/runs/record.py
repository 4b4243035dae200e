"""The commit record of a run: `result.json`, with the hash of every other file."""

from __future__ import annotations

import hashlib
import json
import math
import platform
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from kirisurf.formats.atomic import write_text
from kirisurf.runs.folder import RESULT

_LIBRARIES = ("kirisurf", "numpy", "scipy", "libigl", "vtk", "pyvista")
SECONDS = ("total", "load", "start", "solve", "contract", "analyse", "draw")


def versions() -> dict[str, str]:
    """Return the versions of Python and of the libraries that a result depends on."""
    found = {"python": platform.python_version()}
    for name in _LIBRARIES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "unknown"
    return found


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def hashes(folder: Path) -> dict[str, str]:
    """Return {name: SHA-256} of every file in a folder but the record itself, by name."""
    names = sorted(entry.name for entry in folder.iterdir() if entry.is_file() and entry.name != RESULT)
    return {name: sha256(folder / name) for name in names}


def plain(value: Any) -> Any:
    """Return a value as JSON knows it: numbers that are not finite become null, arrays become lists.

    Examples
    --------
    >>> plain({"a": float("nan"), "b": (1, 2.5)})
    {'a': None, 'b': [1, 2.5]}
    """
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def json_text(value: Any) -> str:
    """Return indented JSON text of a value, never with NaN or Infinity."""
    return json.dumps(plain(value), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_record(folder: Path, result: Mapping[str, Any]) -> dict[str, Any]:
    """Hash the files of a folder and write its record, last; return what was written.

    Raises
    ------
    OutputError
        Where it cannot be written.
    """
    complete = plain({**result, "versions": versions(), "files": hashes(folder)})
    write_text(folder / RESULT, json_text(complete))
    return complete


def renewed_record(folder: Path, names: Sequence[str]) -> None:
    """Hash some files of a finished run anew, after they were rewritten on request.

    Raises
    ------
    OutputError
        Where the record cannot be written.
    """
    result = json.loads((folder / RESULT).read_text(encoding="utf-8"))
    result["files"] = dict(sorted({**result["files"], **{name: sha256(folder / name) for name in names}}.items()))
    write_text(folder / RESULT, json_text(result))
