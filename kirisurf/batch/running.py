"""A batch from its spec to its summary: what is finished is kept, the rest is made, and all of it is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from kirisurf.batch.baseline import SUMMARY, Values, comparison
from kirisurf.batch.engines import Engine
from kirisurf.batch.folder import BatchFolder
from kirisurf.batch.items import Item
from kirisurf.batch.order import Order
from kirisurf.batch.outcome import Outcome, not_run, outcome_of, wrong
from kirisurf.batch.reading import BatchSpec
from kirisurf.batch.summary import csv_text, summary_of
from kirisurf.errors import KirisurfError, OutputError
from kirisurf.runs.record import json_text

REPORT, TABLE = "report.html", "summary.csv"
OUTPUT = 7


@dataclass(frozen=True)
class Asking:
    """How a batch is run.

    Attributes
    ----------
    pictures : bool
        Draw every run's pictures.
    again : bool
        Make also what is finished but did not end as expected.
    baseline : mapping, optional
        What is compared with.
    baseline_name : str
    source : str
        Name of what the batch was read from.
    """

    pictures: bool = False
    again: bool = False
    baseline: Values | None = None
    baseline_name: str = ""
    source: str = ""


@dataclass
class Told:
    """Receives what happens; every field may be replaced.

    Attributes
    ----------
    kept : callable
        Receives every outcome of an item that need not be made again.
    ended : callable
        Receives every outcome of an item that was just made.
    """

    kept: Callable[[Outcome], None] = field(default=lambda outcome: None)
    ended: Callable[[Outcome], None] = field(default=lambda outcome: None)


def run_batch(spec: BatchSpec, folder: BatchFolder, engine: Engine, asking: Asking, told: Told) -> dict[str, Any]:
    """Run a batch into its folder, and return its summary.

    The summary is written in every case: where the batch is interrupted, items that nobody came to are 'not run'.

    Raises
    ------
    OutputError
        Where the disk is full or cannot be written: what is finished stays, and the batch can be started again.
    KeyboardInterrupt
        Where it was interrupted; what is finished stays.
    """
    folder.forget_outcomes(spec)
    outcomes: dict[str, Outcome] = {}
    to_make: list[Item] = []
    for item in spec.items:
        found = wrong(item) if item.spec is None else folder.finished(item, asking.pictures)
        if found is None or (asking.again and item.spec is not None and not found.is_expected):
            to_make.append(item)
            continue
        outcomes[item.name] = found
        folder.record(found)
        (told.kept if item.spec is not None else told.ended)(found)
    orders = [_order(item, spec, folder, asking) for item in to_make]
    problem: BaseException | None = None
    answers = engine(orders)
    try:
        for number, answer in answers:
            item = to_make[number]
            found = outcome_of(item, answer, folder.run(item), folder.path)
            if found.folder is None:
                folder.clear(item)
            outcomes[item.name] = found
            folder.record(found)
            told.ended(found)
            if answer.code == OUTPUT:
                raise OutputError(answer.message)
    except (KirisurfError, KeyboardInterrupt) as found_problem:
        problem = found_problem
    finally:
        close = getattr(answers, "close", None)
        if close is not None:
            close()
    summary = _written(spec, folder, outcomes, asking, problem)
    if problem is not None:
        raise problem
    return summary


def _order(item: Item, spec: BatchSpec, folder: BatchFolder, asking: Asking) -> Order:
    options = {} if item.spec is None else item.spec.as_dict()
    return Order(options, str(folder.run(item)), asking.pictures, spec.limits.seconds, spec.limits.memory_mb)


def _written(
    spec: BatchSpec,
    folder: BatchFolder,
    outcomes: dict[str, Outcome],
    asking: Asking,
    problem: BaseException | None,
) -> dict[str, Any]:
    """Write the summary in its three forms and return it."""
    import kirisurf
    from kirisurf.publishing import write_batch_report

    reason = "interrupted before its turn" if problem is None or not str(problem) else str(problem)
    all_outcomes = [outcomes.get(item.name) or not_run(item, reason) for item in spec.items]
    compared = None
    if asking.baseline is not None:
        compared = comparison(spec, all_outcomes, asking.baseline, asking.baseline_name)
    summary = summary_of(spec, asking.source, kirisurf.__version__, all_outcomes, compared)
    folder.write(TABLE, csv_text(all_outcomes, spec.varied))
    folder.write(SUMMARY, json_text(summary))
    write_batch_report(summary, folder.path, folder.path / REPORT)
    return summary
