"""Progress of a job on standard error: a bar with residuals on a terminal, plain lines elsewhere."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from kirisurf.execution import Followed

if TYPE_CHECKING:
    from kirisurf.states import Step


class Progress(Followed, Protocol):
    """What shows the progress of a job."""

    def __enter__(self) -> Progress: ...

    def __exit__(self, *exception: object) -> None: ...


def step_text(number: int, step: Step) -> str:
    """Return one line on a step: its number, the largest residual of every block, the seconds so far.

    Examples
    --------
    >>> from kirisurf.states import Step
    >>> step_text(3, Step({"length": 1.5e-4, "angle": 2e-6}, 0.1, 1e-3, 0.2, 1.25))
    'step   3: length 1.5e-04  angle 2.0e-06  (1.2 s)'
    """
    rows = "  ".join(f"{name} {value:.1e}" for name, value in step.residuals.items())
    return f"step {number:3d}: {rows}  ({step.seconds:.1f} s)"


class Lines:
    """Plain lines, at most one a second, with the first and last step always among them.

    Parameters
    ----------
    tell : callable
        Prints one line.
    clock : callable
        Seconds, for tests.
    """

    def __init__(self, tell: Callable[[str], None], clock: Callable[[], float] = time.monotonic) -> None:
        self._tell = tell
        self._clock = clock
        self._steps = 0
        self._told_at = -math.inf
        self._pending = ""

    def __enter__(self) -> Lines:
        return self

    def __exit__(self, *exception: object) -> None:
        self._finish()

    def stage(self, name: str) -> None:
        """Print the stage's name."""
        self._finish()
        self._tell(f"{name} ...")

    def step(self, step: Step) -> None:
        """Print the step, unless one was printed less than a second ago."""
        self._steps += 1
        self._pending = step_text(self._steps, step)
        if self._clock() - self._told_at >= 1.0:
            self._told_at = self._clock()
            self._finish()

    def say(self, words: str) -> None:
        """Print it."""
        self._finish()
        self._tell(words)

    def _finish(self) -> None:
        if self._pending:
            self._tell(self._pending)
            self._pending = ""


class Bar:
    """A rich progress bar; its length is the number of digits won between the first residual and the tolerance.

    Parameters
    ----------
    tolerance : float
        Residual at which the bar is full.
    """

    def __init__(self, tolerance: float) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, SpinnerColumn, TextColumn, TimeElapsedColumn
        from rich.progress import Progress as RichProgress

        self._tolerance = tolerance
        self._first = 0.0
        self._steps = 0
        self._shown: Any = RichProgress(
            SpinnerColumn(),
            TextColumn("{task.description}"),
            BarColumn(bar_width=24),
            TimeElapsedColumn(),
            TextColumn("{task.fields[residuals]}"),
            console=Console(stderr=True),
            transient=True,
        )
        self._task = self._shown.add_task("starting", total=1.0, residuals="")

    def __enter__(self) -> Bar:
        self._shown.start()
        return self

    def __exit__(self, *exception: object) -> None:
        self._shown.stop()

    def stage(self, name: str) -> None:
        """Show the stage's name."""
        self._shown.update(self._task, description=name, residuals="")

    def step(self, step: Step) -> None:
        """Move the bar and show the residuals."""
        self._steps += 1
        worst = max([value for value in step.residuals.values() if math.isfinite(value)], default=0.0)
        self._first = max(self._first, worst)
        share = 1.0
        if worst > self._tolerance and self._first > self._tolerance:
            share = math.log(self._first / worst) / math.log(self._first / self._tolerance)
        rows = " ".join(f"{name} {value:.0e}" for name, value in step.residuals.items())
        self._shown.update(self._task, description=f"step {self._steps}", completed=share, residuals=rows)

    def say(self, words: str) -> None:
        """Print it above the bar."""
        self._shown.console.print(words, markup=False, highlight=False)
