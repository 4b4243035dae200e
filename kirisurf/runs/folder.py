"""The run folder as a transaction: all files of a run appear together, or the folder is as it was.

Everything is written to a hidden folder inside the run folder (same disk, works where the parent is
read-only, and in a mounted folder), then moved into place, `result.json` last: without it a run does not count.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from kirisurf.errors import OutputError, ParameterError
from kirisurf.runs.lock import FolderLock

RESULT, SPEC = "result.json", "run.toml"
_STAGING, _PREVIOUS = ".kirisurf-partial-", ".kirisurf-previous-"


def is_certified(folder: Path) -> bool:
    """Return whether a folder holds a complete run that is certified."""
    try:
        record = json.loads((folder / RESULT).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(record, dict) and record.get("certified") is True


class RunFolder:
    """A run folder that is being written; use it as a context.

    Entering checks that the folder is new, empty or (with `overwrite`) an old run, makes it, locks it and
    opens `staging`, where the files are to be written. `commit` moves them into place. Leaving without a
    commit removes what was staged, and the folder itself where it was made here.

    Parameters
    ----------
    path : path
    overwrite : bool
        Replace an old run once the new one is complete. Other files in the folder stay.
    record : str
        Name of the file that is written last and lists all others.
    patience : float
        Seconds to wait where another process writes to the folder, as one that is about to end may do.

    Raises
    ------
    ParameterError
        Where the folder holds a run and `overwrite` is False, or holds files that are no run.
    OutputError
        Where it cannot be made or written, or is locked by another process.
    """

    def __init__(
        self, path: str | os.PathLike[str], overwrite: bool = False, record: str = RESULT, patience: float = 0.0
    ) -> None:
        try:
            self.path = Path(os.path.abspath(path))
        except OSError:
            raise OutputError(f"{path}: expected a folder, got a current one that is gone: change to another") from None
        self.overwrite = overwrite
        self.record = record
        self._patience = patience
        self.committed = False
        self._staging: Path | None = None
        self._made: list[Path] = []
        self._lock = FolderLock(self.path)

    @property
    def staging(self) -> Path:
        """Folder to write the files to, between entering and commit."""
        if self._staging is None:
            raise OutputError(f"{self.path}: expected an open run folder, got one that is closed")
        return self._staging

    def __enter__(self) -> RunFolder:
        try:
            with _as_output_error(self.path):
                self._make()
                self._take_lock()
                # Before the check: a process killed in the middle of a commit left the old run for us to put back.
                self._remove_leftovers()
                self._check()
                self._staging = Path(tempfile.mkdtemp(prefix=_STAGING, dir=self.path))
        except BaseException:
            self._close()
            raise
        return self

    def __exit__(self, *exception: object) -> None:
        self._close()

    def commit(self) -> None:
        """Move the staged files into place; on failure the old run is put back.

        Raises
        ------
        OutputError
            Where a file cannot be moved, or the record is not among the staged files.
        """
        names = sorted(entry.name for entry in self.staging.iterdir())
        if self.record not in names:
            raise OutputError(f"{self.path}: expected a {self.record} among the files, got {', '.join(names)}")
        here = {entry.name for entry in self.path.iterdir()}
        old = sorted(set(_listed_files(self.path, self.record)) | ({*names} & here))
        names.remove(self.record)
        with _as_output_error(self.path):
            for name in [*names, self.record]:
                _sync(self.staging / name)
            previous = Path(tempfile.mkdtemp(prefix=_PREVIOUS, dir=self.path))
            moved: list[tuple[Path, Path]] = []
            try:
                # Backward through old: the record leaves first, so a half-replaced folder never passes for a run.
                for name in sorted(old, key=lambda name: name != self.record):
                    moved.append(_move(self.path / name, previous / name))
                for name in [*names, self.record]:
                    moved.append(_move(self.staging / name, self.path / name))
                _sync(self.path)
            except BaseException:
                for source, target in reversed(moved):
                    with contextlib.suppress(OSError):
                        os.replace(target, source)
                with contextlib.suppress(OSError):
                    previous.rmdir()
                raise
        self.committed = True
        shutil.rmtree(previous, ignore_errors=True)

    def _check(self) -> None:
        found = sorted(entry.name for entry in self.path.iterdir())
        if not found:
            return
        if not self.overwrite:
            what = "a run" if self.record in found else f"a folder with other files ({', '.join(found[:3])}, ...)"
            hint = " (--overwrite replaces the run)" if RESULT in found else ""
            raise ParameterError(f"{self.path}: expected a new or empty folder, got {what}{hint}")
        if not self._is_old():
            raise ParameterError(
                f"{self.path}: expected a folder with {self.record} to overwrite, got one with other files "
                f"({', '.join(found[:3])}{', ...' if len(found) > 3 else ''})"
            )

    def _is_old(self) -> bool:
        """Whether the folder holds what this writes, and is not somebody's folder with other files."""
        if _listed_files(self.path, self.record):
            return True
        return self.record == RESULT and (self.path / SPEC).is_file()

    def _make(self) -> None:
        if os.path.lexists(self.path) and not self.path.is_dir():
            raise OutputError(f"{self.path}: expected a folder or a new name, got a file")
        missing = []
        folder = self.path
        while not folder.exists():
            missing.append(folder)
            folder = folder.parent
        for folder in reversed(missing):
            folder.mkdir(exist_ok=True)
            self._made.append(folder)

    def _take_lock(self) -> None:
        while True:
            if not self._lock.take(self._patience):
                self._made.clear()
                raise OutputError(f"{self.path}: expected a free folder, got one that another run is writing to")
            if self._lock.is_on_its_folder():
                return
            self._lock.release()
            self._make()

    def _remove_leftovers(self) -> None:
        """Remove what a killed process staged; bring back a run that it was about to replace."""
        for entry in sorted(self.path.iterdir()):
            if entry.name.startswith(_STAGING):
                shutil.rmtree(entry, ignore_errors=True)
            elif entry.name.startswith(_PREVIOUS):
                if not (self.path / self.record).exists() and (entry / self.record).exists():
                    for file in sorted(entry.iterdir(), key=lambda file: file.name == self.record):
                        if file.is_dir():
                            # a folder, as of the pieces of a time series, is replaced only where there is none
                            shutil.rmtree(self.path / file.name, ignore_errors=True)
                        os.replace(file, self.path / file.name)
                shutil.rmtree(entry, ignore_errors=True)

    def _close(self) -> None:
        if self._staging is not None:
            shutil.rmtree(self._staging, ignore_errors=True)
            self._staging = None
        if not self.committed:
            for folder in reversed(self._made):
                with contextlib.suppress(OSError):
                    folder.rmdir()
        self._made.clear()
        self._lock.release()


def _listed_files(folder: Path, record: str) -> list[str]:
    """Names of the files that the run in this folder consists of, as far as they exist."""
    try:
        files = json.loads((folder / record).read_text(encoding="utf-8"))["files"]
        names = [str(name) for name in files]
    except (OSError, ValueError, KeyError, TypeError):
        return []
    plain = [name for name in names if name == os.path.basename(name) and (folder / name).is_file()]
    return [*plain, record]


def _move(source: Path, target: Path) -> tuple[Path, Path]:
    os.replace(source, target)
    return source, target


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        with contextlib.suppress(OSError):
            os.fsync(handle)
    finally:
        os.close(handle)


@contextlib.contextmanager
def _as_output_error(path: Path) -> Iterator[None]:
    try:
        yield
    except OutputError:
        raise
    except OSError as problem:
        raise OutputError(f"{path}: expected to write this run folder, got: {problem.strerror or problem}") from problem
