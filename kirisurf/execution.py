"""One run from its spec to its folder: read, lay, solve, save. What the command line and a batch do alike."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from kirisurf.interruption import Interruption
from kirisurf.provenance import inputs, key, source_digest
from kirisurf.runs import Run, RunFolder
from kirisurf.runs.folder import is_certified
from kirisurf.spec import FitSpec
from kirisurf.status import Status

if TYPE_CHECKING:
    from kirisurf.start import Start
    from kirisurf.states import Step

UNFINISHED = (6, 130)
"""Codes of a solve that was cut short."""


@runtime_checkable
class Followed(Protocol):
    """What is told how a run goes on."""

    def stage(self, name: str) -> None:
        """Take what the run does from now on."""
        ...

    def step(self, step: Step) -> None:
        """Take one step of the solver."""
        ...

    def say(self, words: str) -> None:
        """Take something that stays."""
        ...


def execute(
    spec: FitSpec,
    folder: RunFolder,
    stop: Interruption,
    followed: Followed,
    *,
    pictures: bool = True,
    kept: Callable[[str], None] | None = None,
) -> Run:
    """Fit a resolved spec and write the run.

    Parameters
    ----------
    spec : FitSpec
        Resolved (:func:`kirisurf.targets.resolved`).
    folder : RunFolder
        Entered: what is wrong with it should not be learned after an hour of solving.
    stop : Interruption
        Entered; it is told the stages, and asked whether to stop.
    followed : Followed
    pictures : bool
        Draw pictures, where OpenGL works.
    kept : callable, optional
        Where it is given, a certified run in the folder is not replaced by one that was cut short: that is saved
        beside it, and `kept` receives the folder where.

    Returns
    -------
    Run
        As it reads back.

    Raises
    ------
    KirisurfError
        Where the input or the output is at fault; the folder is then as it was.
    KeyboardInterrupt
        Where it was interrupted before there was anything to keep, or twice.
    """
    from kirisurf.design import fit_loaded
    from kirisurf.targets import loaded

    found = inputs(spec)
    provenance = {"key": key(spec, found, pictures), "inputs": found, "source": source_digest()}
    followed.stage(f"reading {spec.target}")
    began = time.perf_counter()
    spec, surface, notes = loaded(spec)
    seconds = time.perf_counter() - began
    stop.stage = "solving"
    followed.stage("solving")

    def laid(start: Start) -> None:
        """Say before the solve what the target asks for, and what may not be reached."""
        for sentence in (start.feasibility.sentence, start.feasibility.advice, *start.warnings):
            if sentence:
                followed.say(sentence)

    design = fit_loaded(spec, surface, notes, seconds, followed.step, stop, laid)
    stop.stage = "saving"
    if kept is not None and design.status.exit_code in UNFINISHED and is_certified(folder.path):
        # replaced only once the new one is complete: this one is not
        beside = f"{folder.path}-unfinished"
        kept(beside)
        with RunFolder(beside, overwrite=True) as other:
            return design.save_into(other, pictures=False, stage=followed.stage, provenance=provenance)
    # whoever interrupts does not wait for pictures
    drawn = pictures and design.status is not Status.INTERRUPTED
    return design.save_into(folder, pictures=drawn, stage=followed.stage, provenance=provenance)
