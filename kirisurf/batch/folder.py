"""The folder of a batch: one folder a run, one record an item, and a lock.

batch.toml            every item, so that `kirisurf batch DIR/batch.toml` repeats the batch
runs/NAME/            the run of an item
outcomes/NAME.json    how the item ended, whether there is a run or not
summary.csv, summary.json, report.html
"""

from __future__ import annotations

import contextlib
import json
import os
from pathlib import Path
from typing import Any

from kirisurf.batch.items import Item
from kirisurf.batch.making import PATIENCE
from kirisurf.batch.outcome import FINISHED, Outcome, is_whole, outcome_of_run, read_result
from kirisurf.batch.reading import BatchSpec
from kirisurf.errors import OutputError, ParameterError
from kirisurf.formats.atomic import TEMPORARY, write_text
from kirisurf.provenance import inputs, key
from kirisurf.runs import RunFolder
from kirisurf.runs.folder import RESULT
from kirisurf.runs.lock import FolderLock
from kirisurf.runs.record import json_text

SPEC, RUNS, OUTCOMES = "batch.toml", "runs", "outcomes"


class BatchFolder:
    """The folder of a batch, entered as a context: it is made, checked, locked, and cleaned of what was left half done.

    Parameters
    ----------
    path : path
    text : str
        Content of `batch.toml`: what the folder is about.

    Raises
    ------
    ParameterError
        Where the folder holds files that are no batch.
    OutputError
        Where it cannot be made or written, or another batch is writing to it.
    """

    def __init__(self, path: str | os.PathLike[str], text: str) -> None:
        try:
            self.path = Path(os.path.abspath(path))
        except OSError:
            raise OutputError(f"{path}: expected a folder, got a current one that is gone: change to another") from None
        self._text = text
        self._lock = FolderLock(self.path)

    def __enter__(self) -> BatchFolder:
        try:
            if os.path.lexists(self.path) and not self.path.is_dir():
                raise OutputError(f"{self.path}: expected a folder or a new name, got a file")
            self.path.mkdir(parents=True, exist_ok=True)
            self._check()
            self._take_lock()
            write_text(self.path / SPEC, self._text)  # before all else: by this file the folder is known
            for name in (RUNS, OUTCOMES):
                (self.path / name).mkdir(exist_ok=True)
            for folder in (self.path, self.path / OUTCOMES):
                for left in folder.glob(f"{TEMPORARY}*"):
                    left.unlink(missing_ok=True)
        except OutputError:
            self._lock.release()
            raise
        except OSError as problem:
            self._lock.release()
            why = problem.strerror or problem
            raise OutputError(f"{self.path}: expected to write this folder, got: {why}") from problem
        except BaseException:
            self._lock.release()
            raise
        return self

    def __exit__(self, *exception: object) -> None:
        self._lock.release()

    def run(self, item: Item) -> Path:
        """Return the run folder of an item."""
        return self.path / RUNS / item.name

    def write(self, name: str, text: str) -> Path:
        """Write one file of the batch, whole or not at all."""
        write_text(self.path / name, text)
        return self.path / name

    def record(self, found: Outcome) -> None:
        """Write the outcome of an item."""
        write_text(self.path / OUTCOMES / f"{found.name}.json", json_text(found.as_dict()))

    def finished(self, item: Item, pictures: bool) -> Outcome | None:
        """Return the outcome of an item that need not be made again.

        It has a commit record for the same inputs, spec and version, every file is as it was written, and it would
        end alike. What a killed process left half done is removed.
        """
        folder = self.run(item)
        if item.spec is None or not folder.is_dir():
            return None
        _clean(folder)
        run = read_result(folder)
        if run is None:
            with contextlib.suppress(OSError):
                folder.rmdir()  # only where it is empty
            return None
        found = inputs(item.spec)
        # pictures that nobody asked for this time are no reason to make a run again
        asked = {key(item.spec, found, drawn) for drawn in {pictures, True}}
        if (run.get("provenance") or {}).get("key") not in asked or run.get("exit_code") not in FINISHED:
            return None
        if not is_whole(folder, run):
            return None
        before = self._outcome(item)
        return outcome_of_run(item, run, folder, self.path, before.get("peak_mb"))

    def clear(self, item: Item) -> None:
        """Remove what an item that ended without a run left in its folder, and the folder where nothing else is there.

        A process that dies in the middle, here or on a worker that is lost with it, cannot remove what it began.
        """
        folder = self.run(item)
        if folder.is_dir():
            with contextlib.suppress(OSError, OutputError):
                _clean(folder)
                folder.rmdir()

    def forgotten(self, spec: BatchSpec) -> tuple[str, ...]:
        """Return the names of runs in the folder that belong to no item of a batch."""
        names = {item.name for item in spec.items}
        return tuple(sorted(each.name for each in (self.path / RUNS).iterdir() if each.name not in names))

    def forget_outcomes(self, spec: BatchSpec) -> None:
        """Remove the records of items that are none any more."""
        names = {f"{item.name}.json" for item in spec.items}
        for each in (self.path / OUTCOMES).iterdir():
            if each.suffix == ".json" and each.name not in names:
                each.unlink(missing_ok=True)

    def _outcome(self, item: Item) -> dict[str, Any]:
        try:
            found = json.loads((self.path / OUTCOMES / f"{item.name}.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return found if isinstance(found, dict) else {}

    def _check(self) -> None:
        found = sorted(each.name for each in self.path.iterdir() if not each.name.startswith(TEMPORARY))
        if found and SPEC not in found:
            what = (
                "a run (batch makes a folder of runs)" if RESULT in found else f"other files ({', '.join(found[:3])})"
            )
            raise ParameterError(f"{self.path}: expected a new or empty folder or that of a batch, got {what}")

    def _take_lock(self) -> None:
        if not self._lock.take():
            raise OutputError(f"{self.path}: expected a free folder, got one that another batch is writing to")


def _clean(folder: Path) -> None:
    """Remove what a killed process left in a run folder, once the last of it has gone."""
    with contextlib.suppress(ParameterError), RunFolder(folder, overwrite=True, patience=PATIENCE):
        return  # opening it cleans it
