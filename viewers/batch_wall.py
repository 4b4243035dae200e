"""The wall of a batch: its items as a grid, targets by varied options, where they are such a matrix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from viewers.batch_rows import BatchRow

MOST_COLUMNS = 60
_LEAST_FILLED = 0.5


@dataclass(frozen=True)
class Span:
    """One cell of a head: a value over so many columns."""

    value: str
    n_columns: int


@dataclass(frozen=True)
class Wall:
    """Items by target and varied options.

    Attributes
    ----------
    heads : tuple of (str, tuple of Span)
        One line for each varied option, coarse ones first: its name, and its values over the columns.
    lines : tuple of (str, tuple of BatchRow or None)
        One for each target: its name, and an item or nothing for each column.
    """

    heads: tuple[tuple[str, tuple[Span, ...]], ...]
    lines: tuple[tuple[str, tuple[BatchRow | None, ...]], ...]

    @property
    def n_columns(self) -> int:
        """Number of combinations of options."""
        return len(self.lines[0][1])


def batch_wall(rows: Sequence[BatchRow], varied: Sequence[str]) -> Wall | None:
    """Return the items as a grid; None where they are none.

    They are one where no two have the same target and options, there are at least two targets and 2 to 60
    combinations of options, and at least half of the cells have an item.
    """
    targets = list(dict.fromkeys(row.target for row in rows))
    at = {(row.target, row.options): row for row in rows}
    order = [list(dict.fromkeys(row.options[k] for row in rows)) for k in range(len(varied))]
    combinations = sorted(
        {row.options for row in rows}, key=lambda each: [order[k].index(value) for k, value in enumerate(each)]
    )
    cells = len(targets) * len(combinations)
    if (
        len(at) < len(rows)
        or len(targets) < 2
        or not 2 <= len(combinations) <= MOST_COLUMNS
        or len(rows) < _LEAST_FILLED * cells
    ):
        return None
    heads = tuple((name.replace("_", " "), _spans(combinations, k)) for k, name in enumerate(varied))
    names = {row.target: row.target_name for row in rows}
    lines = tuple((names[target], tuple(at.get((target, each)) for each in combinations)) for target in targets)
    return Wall(heads, lines)


def _spans(combinations: Sequence[tuple[str, ...]], place: int) -> tuple[Span, ...]:
    """Values of one option over the columns, equal ones joined where the coarser options are equal too."""
    spans: list[Span] = []
    last: tuple[str, ...] | None = None
    for each in combinations:
        if each[: place + 1] == last:
            spans[-1] = Span(spans[-1].value, spans[-1].n_columns + 1)
        else:
            spans.append(Span(each[place] or "\u2013", 1))
        last = each[: place + 1]
    return tuple(spans)
