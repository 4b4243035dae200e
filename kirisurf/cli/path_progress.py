"""Progress along a path on standard error: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

from kirisurf.cli.output import Output


class PathProgress:
    """Shows which stage a command is in, and how many states of a path are found; use it as a context.

    Parameters
    ----------
    output : Output
    clock : callable
        Seconds, for tests.
    """

    def __init__(self, output: Output, clock: Callable[[], float] = time.monotonic) -> None:
        self._tell = output.message
        self._clock = clock
        self._told_at = -math.inf
        self._bar: Any = None
        if output.is_terminal:
            from rich.console import Console
            from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

            columns = SpinnerColumn(), TextColumn("{task.description}"), BarColumn(bar_width=24), TimeElapsedColumn()
            self._bar = Progress(*columns, console=Console(stderr=True), transient=True)
            self._task = self._bar.add_task("starting", total=None)

    def __enter__(self) -> PathProgress:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, *exception: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def stage(self, name: str) -> None:
        """Show the stage's name."""
        if self._bar is None:
            self._tell(f"{name} ...")
        else:
            self._bar.update(self._task, description=name, completed=0, total=None)

    def state(self, done: int, total: int) -> None:
        """Move the bar, or print a line every two seconds at most; after the last state minima are sought."""
        if self._bar is not None:
            words = "following the path" if done < total else "looking for states of rest"
            self._bar.update(self._task, description=words, completed=done, total=total if done < total else None)
            return
        if done == total:
            self._tell(f"{done} states found; looking for states of rest ...")
        elif self._clock() - self._told_at >= 2.0:
            self._told_at = self._clock()
            self._tell(f"state {done} of {total}")
