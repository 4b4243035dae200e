"""Writing a file whole or not at all: a temporary file beside the target, flushed, synced, renamed.

Mesh libraries return normally from a full disk and leave a truncated file (or abort the process), so
nothing in kirisurf lets a library open an output file: bytes are made in memory and written here.
"""

from __future__ import annotations

import os
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from kirisurf.errors import OutputError

TEMPORARY = ".kirisurf-"
"""First letters of the names of files and folders that are not finished: what is left of a killed process."""

_asking = threading.Lock()
"""The mask of permissions is asked for by setting it: two threads that do so at once would leave none."""


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write `content` to `path`, replacing an old file only when the new one is safely on the disk.

    Raises
    ------
    OutputError
        Where the file cannot be written; the old file, if any, is untouched.
    """
    with replacing(path) as file:
        file.write(content)


def write_text(path: str | os.PathLike[str], content: str) -> None:
    """Write `content` as UTF-8 with the line ends that it holds; see :func:`write_bytes`.

    What UTF-8 cannot hold, as names of files may, becomes its escape.
    """
    write_bytes(path, content.encode("utf-8", "backslashreplace"))


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a temporary binary file that becomes `path` when the block ends without an exception.

    Raises
    ------
    OutputError
        Where the file cannot be created, written, synced or renamed. Other exceptions of the block
        pass through. In every case the temporary file is gone and an old file is untouched.
    """
    target = Path(path)
    temporary: Path | None = None
    try:
        if target.is_dir():
            raise IsADirectoryError("it is a folder")
        handle, made = tempfile.mkstemp(prefix=TEMPORARY, suffix=".tmp", dir=target.parent)
        temporary = Path(made)
        with os.fdopen(handle, "wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
            _copy_mode(target, temporary)
        os.replace(temporary, target)
        temporary = None
        _sync_folder(target.parent)
    except OutputError:
        raise
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise OutputError(f"{target}: expected to write this file, got: {reason}") from problem
    finally:
        if temporary is not None:
            with suppress(OSError):
                temporary.unlink()


def _copy_mode(target: Path, temporary: Path) -> None:
    """Give the new file the old one's permissions, or those that a plain open would give."""
    with suppress(OSError):
        if target.exists():
            os.chmod(temporary, target.stat().st_mode & 0o7777)
        else:
            with _asking:
                mask = os.umask(0)
                os.umask(mask)
            os.chmod(temporary, 0o666 & ~mask)


def _sync_folder(folder: Path) -> None:
    """Make the rename itself durable where the system can (folders cannot be opened everywhere)."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
