"""Ctrl-C and SIGTERM: the first keeps the best point, a second one abandons the command cleanly."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")


class Interruption:
    """Signal handling for the length of a job; use it as a context, and call it to ask whether to stop.

    Before the solve there is nothing to keep: a signal raises KeyboardInterrupt at once. While solving, the
    first one asks the solver to stop. While saving, the first one is answered and the saving goes on. A second
    one raises KeyboardInterrupt; the run folder then is as it was.

    Parameters
    ----------
    tell : callable
        Receives the sentence that the user reads.
    """

    def __init__(self, tell: Callable[[str], None]) -> None:
        self.requested = False
        self.stage = "loading"
        self._tell = tell
        self._pending = ""
        self._before: dict[int, Any] = {}

    def __call__(self) -> bool:
        """Return whether the solver should stop at its best point."""
        self._speak()
        return self.requested

    def __enter__(self) -> Interruption:
        if threading.current_thread() is threading.main_thread():
            for name in _SIGNALS:
                number = getattr(signal, name, None)
                # A signal that is ignored already (nohup, a shell's background job) stays ignored.
                if number is not None and signal.getsignal(number) not in (signal.SIG_IGN, None):
                    self._before[number] = signal.signal(number, self._receive)
        return self

    def __exit__(self, *exception: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before.clear()
        self._speak()

    def _receive(self, number: int, frame: FrameType | None) -> None:
        if self.requested or self.stage == "loading":
            raise KeyboardInterrupt
        self.requested = True
        if self.stage == "solving":
            self._pending = "interrupted: stopping at the best point so far, which is then saved (again: save nothing)"
        else:
            self._pending = "interrupted while saving: the run was finished first"

    def _speak(self) -> None:
        """Say what a signal left to say.

        Not in the handler itself: it may run in the middle of another message, and Python's streams refuse to be
        entered twice.
        """
        if self._pending:
            text, self._pending = self._pending, ""
            self._tell(text)
