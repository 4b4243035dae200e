"""Uploads: files that a browser brings. Each is written into a private folder and read as any other target."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import AsyncIterator
from pathlib import Path

from kirisurf.errors import KirisurfError, OutputError, UnreadableError
from kirisurf.formats.source import FORMATS
from kirisurf.origin import moved, round_origin
from kirisurf.outlines.reading import FORMATS as OUTLINE_FORMATS
from kirisurf.spec import FitSpec
from kirisurf.targets import loaded
from kirisurf.topology import require_disk

LIMIT_MB = 200
"""Largest file that is taken; larger ones are opened from the command line."""

LONGEST = 80
"""Characters of a file name that are kept."""


def plain_name(name: str) -> str:
    """Return a file name without folders and without signs that mean something to a system.

    Raises
    ------
    UnreadableError
        Where its suffix is none of a format that can be read.

    Examples
    --------
    >>> plain_name("../../etc/hood (1).STL")
    'hood (1).stl'
    """
    last = re.split(r"[/\\]", name)[-1]
    stem, dot, ending = last.rpartition(".")
    suffix = dot + ending
    known = sorted({*FORMATS, *OUTLINE_FORMATS})
    if suffix.lower() not in known:
        shown = re.sub(r"[^\w .()-]", "_", last)[:LONGEST] or "a file without a name"
        raise UnreadableError(f"{shown}: expected one of {', '.join(known)}, got {suffix.lower()[:12] or 'no suffix'}")
    kept = re.sub(r"[^\w .()-]", "_", stem).strip(" .-")[:LONGEST]
    return f"{kept or 'target'}{suffix.lower()}"


class Uploads:
    """The private folder of one server.

    Parameters
    ----------
    folder : Path
    limit_mb : float
    """

    def __init__(self, folder: Path, limit_mb: float | int = LIMIT_MB) -> None:
        self._folder = folder
        self.limit_mb = limit_mb

    async def take(self, name: str, parts: AsyncIterator[bytes], announced: int | None = None) -> Path:
        """Write a file and return its path; what is not taken leaves nothing behind.

        Parameters
        ----------
        name : str
            As the browser gives it.
        parts : iterator of bytes
        announced : int, optional
            Bytes that are to come.

        Raises
        ------
        UnreadableError
            Where it is too large, or of no format that can be read.
        OutputError
            Where it cannot be written here.
        """
        name = plain_name(name)
        most = int(self.limit_mb * 1e6)
        if announced is not None and announced > most:
            raise self._too_large(name)
        try:
            path = Path(tempfile.mkdtemp(prefix="upload-", dir=self._folder)) / name
        except OSError as problem:
            raise OutputError(f"{name}: could not be kept: {problem.strerror}") from None
        try:
            with open(path, "xb") as file:
                size = 0
                async for part in parts:
                    size += len(part)
                    if size > most:
                        raise self._too_large(name)
                    file.write(part)
        except BaseException as problem:
            discard(path)
            if isinstance(problem, OSError) and not isinstance(problem, KirisurfError):
                raise OutputError(f"{name}: could not be kept: {problem.strerror or problem}") from None
            raise
        return path

    def _too_large(self, name: str) -> UnreadableError:
        return UnreadableError(
            f"{name}: expected at most {self.limit_mb:g} MB, got more: decimate it first, or open it from the terminal"
        )


def discard(path: Path) -> None:
    """Remove a file that was taken, and its folder."""
    path.unlink(missing_ok=True)
    path.parent.rmdir()


def check_target(path: Path, units: str | None = None) -> None:
    """Read a file as a fit would, and leave it at that.

    Raises
    ------
    KirisurfError
        Where it can be no target; the message names the file without its folder.
    """
    try:
        _, surface, _ = loaded(FitSpec(target=str(path), units=units))
        require_disk(moved(surface, round_origin(surface)))
    except KirisurfError as problem:
        raise type(problem)(str(problem).replace(f"{path.parent}{os.sep}", "")) from None
