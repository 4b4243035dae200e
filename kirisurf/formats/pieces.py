"""An index file with a folder of its pieces beside it, written whole or not at all.

VTK's multiblock and time-series files name other files. The pieces get a folder of their own, called after the
index with its suffix, so that exporting `runs/hood.vtm` never meets the run folder `runs/hood`.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from kirisurf.errors import OutputError
from kirisurf.formats import atomic

_PIECE = re.compile(r"[\w-]+\.vtp")


def pieces_folder(path: str | os.PathLike[str]) -> Path:
    """Return the folder of an index file's pieces.

    Examples
    --------
    >>> pieces_folder("runs/hood.vtm").as_posix()
    'runs/hood_vtm'
    """
    path = Path(path)
    return path.with_name(f"{path.stem}_{path.suffix.lstrip('.').lower()}")


def is_replaceable(folder: Path) -> bool:
    """Return whether nothing is at this place, or a folder that holds nothing but pieces."""
    if not os.path.lexists(folder):
        return True
    if folder.is_symlink() or not folder.is_dir():
        return False
    return all(entry.is_file() and _PIECE.fullmatch(entry.name) for entry in folder.iterdir())


def write_with_pieces(path: str | os.PathLike[str], index: str, pieces: Iterable[tuple[str, bytes]]) -> None:
    """Write an index file and the folder of its pieces.

    Parameters
    ----------
    path : path
        Of the index; old pieces and an old index are replaced once the new ones are safely on the disk.
    index : str
    pieces : iterable of (name, content)
        Files for `pieces_folder(path)`, taken one after the other.

    Raises
    ------
    OutputError
        Where something cannot be written, or the folder holds other files than pieces; what was there is untouched.
    """
    path = Path(path)
    folder = pieces_folder(path)
    try:
        if path.is_dir():
            raise OutputError(f"{path}: expected to write this file, got: it is a folder")
        if not is_replaceable(folder):
            raise OutputError(f"{folder}: expected a new folder or one of earlier pieces, got one with other files")
        staging = Path(tempfile.mkdtemp(prefix=".kirisurf-", suffix=".tmp", dir=path.parent))
    except OSError as problem:
        raise OutputError(f"{path}: expected to write this file, got: {problem.strerror or problem}") from problem
    try:
        fresh = staging / "new"
        fresh.mkdir()
        for name, content in pieces:
            atomic.write_bytes(fresh / name, content)
        _put(path, index, fresh, folder, staging / "old")
    except OSError as problem:
        raise OutputError(f"{path}: expected to write this file, got: {problem.strerror or problem}") from problem
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _put(path: Path, index: str, fresh: Path, folder: Path, aside: Path) -> None:
    """Move the pieces into place and write the index; on failure put the old pieces back."""
    was_there = folder.exists()
    if was_there:
        os.replace(folder, aside)
    try:
        os.replace(fresh, folder)
        atomic.write_text(path, index)
    except BaseException:
        with suppress(OSError):
            if folder.exists():
                os.replace(folder, fresh)
        with suppress(OSError):
            if was_there:
                os.replace(aside, folder)
        raise
