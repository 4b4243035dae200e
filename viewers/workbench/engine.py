"""The engine's side that a window talks to: fits in a process of their own, so that the window never waits.

Why a process and not a thread: a crash in native code takes down its own process alone, and a solve holds the
interpreter's lock at times. Measured at 16x16 tiles on two cores: a 60 Hz timer beside it in a thread comes late by
1 to 3 ms on average and up to 107, beside a process by 0.2 and up to 3.
"""

from __future__ import annotations

import multiprocessing
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from multiprocessing.synchronize import Event as Flag
from typing import Any

from kirisurf.spec import FitSpec
from viewers.workbench.events import CutFile, Draw, Event, Job, Lost, Request, SaveRun
from viewers.workbench.pipeline import Stage

PATIENCE = 2.0
"""Seconds that a process gets to end by itself when the engine is closed."""


def compute(connection: Connection, stop: Flag, began: float) -> None:
    """Run :func:`viewers.workbench.worker.work`; the solver is imported where it is needed, and only there."""
    from viewers.workbench.worker import work

    work(connection, stop, began)


class Engine:
    """Runs fits and writes files in a child process; one per workbench.

    Every method returns at once. What happens is told by :meth:`events`, which a window asks for on a timer, and a
    server in a loop.

    Parameters
    ----------
    target : callable, optional
        What the process runs instead of :func:`compute`: for tests.

    Examples
    --------
    A window would do this (the process imports the script that starts it: guard a script by `__main__`)::

        with Engine() as engine:
            engine.start(FitSpec(target="hypar", cells=(4, 4)))
            for event in engine.events(wait=1.0):
                results = results.received(event)
    """

    def __init__(self, target: Callable[..., None] = compute) -> None:
        self._target = target
        self._context = multiprocessing.get_context("spawn")
        self._stop = self._context.Event()
        self._connection: Connection | None = None
        self._process: BaseProcess | None = None
        self._number = 0

    def __enter__(self) -> Engine:
        self.warm_up()
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    @property
    def is_alive(self) -> bool:
        """Whether the process runs."""
        return self._process is not None and self._process.is_alive()

    def warm_up(self) -> None:
        """Start the process, where there is none: its imports take a second, which a window can open in."""
        if self._connection is not None:
            return
        ours, theirs = self._context.Pipe()
        self._stop.clear()
        process = self._context.Process(
            target=self._target, args=(theirs, self._stop, time.time()), name="kirisurf engine", daemon=True
        )
        with _interrupts_ignored():
            process.start()
        theirs.close()
        self._connection, self._process = ours, process

    def start(self, spec: FitSpec, since: Stage = Stage.HOLES, until: Stage = Stage.HOLES, resume: bool = False) -> int:
        """Ask for a fit and return the number of its job; a job that runs or waits gives way to it.

        Parameters
        ----------
        spec : FitSpec
            Resolved (:func:`kirisurf.targets.resolved`).
        since, until : Stage
            See :class:`viewers.workbench.events.Job`.
        resume : bool
            Go on from the best point of the last fit.
        """
        self._number += 1
        self._ask(Job(self._number, spec, since, until, resume))
        return self._number

    def cancel(self) -> None:
        """Ask the solver to end at its best point, which is then reported as any other."""
        self._stop.set()

    def save(self, folder: str, overwrite: bool = False, pictures: bool = True, carries_target: bool = False) -> None:
        """Ask for a run folder of the last fit; see :class:`viewers.workbench.events.SaveRun`."""
        self._ask(SaveRun(folder, overwrite, pictures, carries_target))

    def cut(self, path: str, hinge_width: float | None = None, kerf: float = 0.0) -> None:
        """Ask for a cut file of the last fit, .svg or .dxf."""
        self._ask(CutFile(path, hinge_width, kerf))

    def draw(self, request: Draw) -> None:
        """Ask for a picture or an animation."""
        self._ask(request)

    def events(self, wait: float = 0.0) -> Iterator[Event]:
        """Give what was reported since, in order; with `wait` seconds at most until something is.

        An end of the process that nobody asked for is the event `Lost`.
        """
        while self._connection is not None:
            try:
                if not self._connection.poll(wait):
                    return
                event = self._connection.recv()
            except (EOFError, OSError):
                yield Lost(self._ending())
                return
            wait = 0.0
            yield event

    def close(self) -> None:
        """End the process."""
        connection, process = self._connection, self._process
        self._connection = self._process = None
        self._stop.set()
        if connection is not None:
            connection.close()
        if process is not None:
            process.join(PATIENCE)
            if process.is_alive():
                process.kill()
                process.join()
            process.close()

    def _ask(self, request: Request) -> None:
        self.warm_up()
        self._stop.clear()
        try:
            if self._connection is not None:
                self._connection.send(request)
        except OSError:
            # it has just ended; the next look at the events says so
            return

    def _ending(self) -> str:
        """Take leave of a process that ended by itself, and say how it did."""
        process: Any = self._process
        process.join(PATIENCE)
        code = process.exitcode
        self.close()
        how = f"signal {-code}" if code is not None and code < 0 else f"code {code}"
        return f"The engine ended unexpectedly ({how}); what was shown stays, and the next fit starts it again."


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """Let a process that is started here ignore Ctrl-C in the terminal from its first moment on.

    Only the main thread may say so; from another one, the process does it itself a little later.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
