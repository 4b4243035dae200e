"""An advisory lock on a folder, so that two processes do not write to it at once."""

from __future__ import annotations

import os
import time
from pathlib import Path
from types import ModuleType

fcntl: ModuleType | None
try:
    import fcntl
except ImportError:  # Windows has no advisory locks of this kind; there a second writer is not noticed
    fcntl = None

_PAUSE = 0.05


class FolderLock:
    """A lock on an existing folder; the system releases it where the process ends.

    Parameters
    ----------
    path : Path
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._handle: int | None = None
        self._was_missing = False

    def take(self, patience: float = 0.0) -> bool:
        """Take the lock; return False where another process has it.

        Systems and network disks without such locks are gone on with. Whoever held it may have removed the folder:
        ask `is_on_its_folder`.

        Parameters
        ----------
        patience : float
            Seconds to wait for it.

        Raises
        ------
        OSError
            Where the folder cannot be opened.
        """
        if fcntl is None:
            return True
        self._was_missing = False
        until = time.monotonic() + patience
        while True:
            try:
                self._handle = os.open(self._path, os.O_RDONLY)
            except FileNotFoundError:
                self._was_missing = True  # removed by whoever held it: see is_on_its_folder
                return True
            try:
                fcntl.flock(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                self.release()
                if time.monotonic() >= until:
                    return False
                time.sleep(_PAUSE)
            except OSError:
                self.release()
                return True
            else:
                return True

    def is_on_its_folder(self) -> bool:
        """Whether the folder of this name is still the one that was locked."""
        if self._handle is None:
            # where it was missing, another process may have made and locked it again since
            return not self._was_missing and self._path.is_dir()
        try:
            return os.path.samestat(os.fstat(self._handle), os.stat(self._path))
        except FileNotFoundError:
            return False

    def release(self) -> None:
        """Release the lock, where it is held."""
        if self._handle is not None:
            os.close(self._handle)
            self._handle = None
