"""Progress of a batch on standard error: a bar and a table that live on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Literal

from kirisurf.batch.running import Told
from kirisurf.cli.output import Output

if TYPE_CHECKING:
    from kirisurf.batch.outcome import Outcome
    from kirisurf.batch.reading import BatchSpec

SHOWN = 12
"""Items in the table that lives on a terminal: the latest."""


def progress_of(spec: BatchSpec, output: Output) -> BatchProgress:
    """Return what shows the progress of a batch."""
    n = len(spec.items)
    return Table(n) if output.is_terminal else BatchProgress(n, output.message)


class BatchProgress:
    """Plain lines: one an item that was made, and one for all that were kept.

    Parameters
    ----------
    n : int
        Number of items.
    tell : callable
        Prints one line.
    clock : callable
        Seconds, for tests.
    """

    def __init__(self, n: int, tell: Callable[[str], None], clock: Callable[[], float] = time.monotonic) -> None:
        self.outcomes: dict[str, Outcome] = {}
        self.told = Told(self.kept, self.ended)
        self._n, self._n_kept = n, 0
        self._tell, self._clock = tell, clock
        self._began = clock()

    def __enter__(self) -> BatchProgress:
        self._began = self._clock()
        return self

    def __exit__(self, *exception: object) -> None:
        return

    def kept(self, outcome: Outcome) -> None:
        """Take an item that need not be made again."""
        self.outcomes[outcome.name] = outcome
        self._n_kept += 1

    def ended(self, outcome: Outcome) -> None:
        """Take an item that was just made."""
        if self._n_kept and len(self.outcomes) == self._n_kept:
            self._tell(f"{self._n_kept} of {self._n} were finished before and are kept")
        self.outcomes[outcome.name] = outcome
        self._tell(self.line(outcome))

    def line(self, outcome: Outcome) -> str:
        """Return one line on an item: counts, time left, name, how it ended."""
        done = f"{len(self.outcomes)}/{self._n}"
        left = self.seconds_left()
        words = f"{outcome_words(outcome)}" + ("" if left is None else f"  [{duration(left)} left]")
        return f"{done:>9}  {outcome.name}: {words}"

    def seconds_left(self) -> float | None:
        """Return the time that is left at the rate so far; None at the start and the end."""
        made, left = len(self.outcomes) - self._n_kept, self._n - len(self.outcomes)
        return None if made < 2 or not left else left * (self._clock() - self._began) / made


class Table(BatchProgress):
    """A bar with counts, rate and time left, above it the counts of outcomes and the latest items.

    Parameters
    ----------
    n : int
        Number of items.
    """

    def __init__(self, n: int) -> None:
        from rich.console import Console
        from rich.live import Live
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
        from rich.progress import Progress as RichProgress

        super().__init__(n, lambda line: None)
        rate = TextColumn("{task.fields[rate]}")
        self._bar: Any = RichProgress(
            BarColumn(bar_width=32), MofNCompleteColumn(), rate, TimeElapsedColumn(), TimeRemainingColumn()
        )
        self._task = self._bar.add_task("", total=n, rate="")
        self._latest: deque[Outcome] = deque(maxlen=SHOWN)
        self._live: Any = Live(console=Console(stderr=True), refresh_per_second=8, transient=True)

    def __enter__(self) -> Table:
        super().__enter__()
        self._live.start()
        self._show()
        return self

    def __exit__(self, *exception: object) -> None:
        self._live.stop()

    def kept(self, outcome: Outcome) -> None:
        """Take an item that need not be made again."""
        super().kept(outcome)
        self._bar.reset(self._task, total=self._n, completed=len(self.outcomes))
        self._show()

    def ended(self, outcome: Outcome) -> None:
        """Take an item that was just made."""
        super().ended(outcome)
        self._latest.append(outcome)
        made, elapsed = len(self.outcomes) - self._n_kept, self._clock() - self._began
        rate = f"{60 * made / elapsed:.1f} a minute" if elapsed > 1.0 else ""
        self._bar.update(self._task, completed=len(self.outcomes), rate=rate)
        self._show()

    def _show(self) -> None:
        from rich.console import Group
        from rich.table import Table as RichTable
        from rich.text import Text

        table = RichTable(box=None, pad_edge=False, show_header=bool(self._latest), header_style="dim")
        for name in ("item", "outcome", "tiles", "rms", "s"):
            side: Literal["left", "right"] = "left" if name in ("item", "outcome") else "right"
            table.add_column(name, justify=side, no_wrap=True, overflow="ellipsis")
        for each in self._latest:
            style = "" if each.is_expected else "red"
            table.add_row(*(Text(cell, style) for cell in _cells(each)))
        counts = Counter(each.outcome for each in self.outcomes.values())
        words = "   ".join(f"{word}: {n}" for word, n in sorted(counts.items(), key=lambda pair: -pair[1]))
        self._live.update(Group(table, Text(words, "bold"), self._bar))


def outcome_words(outcome: Outcome) -> str:
    """Return in a few words how an item ended."""
    words = outcome.outcome if outcome.is_expected else f"{outcome.outcome.upper()} (code {outcome.code})"
    distance = outcome.measures.get("distance_rms")
    if outcome.tiles is not None:
        words += f", {outcome.tiles} tiles"
    if distance is not None:
        words += f", rms {distance:.2g}"
    if outcome.seconds is not None:
        words += f", {outcome.seconds:.1f} s"
    return words if outcome.is_expected or not outcome.reason else f"{words}: {' '.join(outcome.reason.split())[:200]}"


def summary_lines(summary: Mapping[str, Any]) -> list[str]:
    """Return the summary as lines: what did not end as expected, one by one, then the counts."""
    lines = [
        f"{item['name']}: {item['outcome']} (code {item['code']}, expected {_codes(item['expect'])}): {item['reason']}"
        for item in summary["items"]
        if not item["is_expected"]
    ]
    counts = {name: n for name, n in summary["counts"].items() if name not in ("total", "unexpected")}
    words = ", ".join(f"{n} {name}" for name, n in sorted(counts.items(), key=lambda pair: -pair[1]))
    return [*lines, f"{summary['counts']['total']} items: {words}"]


def comparison_lines(summary: Mapping[str, Any]) -> list[str]:
    """Return the comparison as lines: what changed, one by one, then the counts."""
    compared = summary["comparison"]
    if compared is None:
        return []
    lines = []
    for item in compared["items"]:
        if item["verdict"] == "same":
            continue
        lines.append(f"{item['verdict']}: {item['name']}")
        lines += [f"    {change['sentence']}" for change in item["changes"]]
    words = ", ".join(f"{n} {name}" for name, n in compared["counts"].items() if n)
    return [*lines, f"against {compared['baseline']}: {words}"]


def duration(seconds: float | int) -> str:
    """Return a time in words.

    Examples
    --------
    >>> duration(42), duration(330), duration(7500)
    ('42 s', '6 min', '2.1 h')
    """
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _cells(outcome: Outcome) -> tuple[str, ...]:
    distance = outcome.measures.get("distance_rms")
    return (
        outcome.name,
        outcome.outcome,
        "" if outcome.tiles is None else str(outcome.tiles),
        "" if distance is None else f"{distance:.2g}",
        "" if outcome.seconds is None else f"{outcome.seconds:.1f}",
    )


def _codes(codes: Any) -> str:
    return " or ".join(str(code) for code in codes)
