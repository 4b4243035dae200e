"""One run of a batch, inside the process that makes it."""

from __future__ import annotations

import sys
import tempfile

from kirisurf.batch.order import Order
from kirisurf.execution import execute
from kirisurf.failures import explained
from kirisurf.interruption import Interruption
from kirisurf.provenance import source_digest
from kirisurf.runs import RunFolder
from kirisurf.spec import FitSpec
from kirisurf.states import Step

PATIENCE = 20.0
"""Seconds that a process has to go that made this run before, whose batch, host or worker was lost."""


class _Unfollowed:
    """Nobody looks on: what a run says stands in its record."""

    def stage(self, name: str) -> None:
        """Take a stage."""

    def step(self, step: Step) -> None:
        """Take a step."""

    def say(self, words: str) -> None:
        """Take words."""


def make(order: Order) -> tuple[int, str]:
    """Make a run and return its exit code, and its error where there is one; nothing is raised."""
    try:
        spec = FitSpec.from_dict(order.options)
        with RunFolder(order.folder, overwrite=True, patience=PATIENCE) as folder, Interruption(_told) as stop:
            run = execute(spec, folder, stop, _Unfollowed(), pictures=order.pictures)
        return int(run.result["exit_code"]), ""
    except (Exception, KeyboardInterrupt) as problem:
        return explained(problem)


def warm_up() -> None:
    """Make a small run and throw it away, so that the processes that make others start with all that this needs.

    Imports, fonts, and the first use of every library take ten times as long as a small fit.
    """
    # the spec of the smallest fit that comes by everything: a sheet that is bent into a surface, certified and drawn
    with tempfile.TemporaryDirectory(prefix="kirisurf-") as folder:
        options = FitSpec(target="hypar", cells=(2, 2)).as_dict()
        make(Order(options, f"{folder}/run", False, 0.0, 0.0))
    source_digest()


def _told(words: str) -> None:
    sys.stderr.write(f"{words}\n")
