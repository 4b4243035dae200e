"""The main job of `fit` and `demo`: read, solve, save, and say how it went."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from kirisurf.cli.certificate_table import certificate_table
from kirisurf.cli.interruption import Interruption
from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.progress import Bar, Lines, Progress
from kirisurf.runs import Run, RunFolder
from kirisurf.runs.folder import is_certified
from kirisurf.spec import FitSpec
from kirisurf.status import Status

if TYPE_CHECKING:
    from kirisurf.start import Start

UNFINISHED = (6, 130)
"""Codes of a solve that was cut short."""


def run_job(spec: FitSpec, folder: str, overwrite: bool, pictures: bool, output: Output) -> Outcome:
    """Fit a resolved spec and write the run folder.

    Raises
    ------
    KirisurfError
        Where the input or the output is at fault; the folder is then as it was.
    KeyboardInterrupt
        Where it was interrupted before there was anything to keep, or twice.
    """
    from kirisurf.design import fit_loaded
    from kirisurf.targets import loaded

    progress: Progress = Bar(spec.tolerance) if output.is_terminal else Lines(output.message)
    # The folder is opened first: what is wrong with it should not be learned after an hour of solving.
    with RunFolder(folder, overwrite) as opened, Interruption(output.message) as stop, progress:
        progress.stage(f"reading {spec.target}")
        began = time.perf_counter()
        spec, surface, notes = loaded(spec)
        seconds = time.perf_counter() - began
        stop.stage = "solving"
        progress.stage("solving")

        def laid(start: Start) -> None:
            """Say before the solve what the target asks for, and what may not be reached."""
            for sentence in (start.feasibility.sentence, start.feasibility.advice, *start.warnings):
                if sentence:
                    progress.say(sentence)

        design = fit_loaded(spec, surface, notes, seconds, progress.step, stop, laid)
        stop.stage = "saving"
        unfinished = design.status.exit_code in UNFINISHED
        if unfinished and is_certified(opened.path):
            # replaced only once the new one is complete: this one is not
            beside = f"{opened.path}-unfinished"
            output.warning(f"the certified run in {folder} was kept; what was reached lies in {beside}")
            with RunFolder(beside, overwrite=True) as other:
                run = design.save_into(other, pictures=False, stage=progress.stage)
        else:
            # whoever interrupts does not wait for pictures
            drawn = pictures and design.status is not Status.INTERRUPTED
            run = design.save_into(opened, pictures=drawn, stage=progress.stage)
    _tell(run, output)
    report = run.folder / "report.html"
    output.product(str(report))
    code = int(run.result["exit_code"])
    return Outcome(code, {**run.result, "exit_code": code, "folder": str(run.folder), "report": str(report)})


def _tell(run: Run, output: Output) -> None:
    """Print what a person needs to know of a finished run, the verdict last."""
    result, beside = run.result, run.result["certificate_beside"]
    foretold = (result.get("feasibility") or {}).get("sentence")
    for sentence in result["notes"]:
        # that was said before the solve
        if not (foretold and sentence.startswith(foretold)):
            output.message(f"note: {sentence}")
    output.message(certificate_table(result["certificate"], beside["limits"]))
    edge = f"{result['edge_length']:.6g} {result['units']}"
    output.message(f"{result['tiles']} tiles, {result['holes']} holes, median tile edge {edge}")
    if run.spec.units is None:
        output.message("The target names no unit: pattern.svg takes it as mm; --units sets it.")
    for sentence in [*result["warnings"], *beside["failures"]]:
        output.warning(sentence)
    verdict = "certified" if result["certified"] else "not certified"
    say = output.message if result["certified"] and result["status"] == "CONVERGED" else output.warning
    say(f"{verdict}. {Status[result['status']].value}")
    output.message(f"run folder: {run.folder} ({result['seconds']['total']:.1f} s)")
