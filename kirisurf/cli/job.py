"""The main job of `fit` and `demo`: read, solve, save, and say how it went."""

from __future__ import annotations

from kirisurf.cli.certificate_table import certificate_table
from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.progress import Bar, Lines, Progress
from kirisurf.execution import execute
from kirisurf.interruption import Interruption
from kirisurf.runs import Run, RunFolder
from kirisurf.spec import FitSpec
from kirisurf.status import Status


def run_job(spec: FitSpec, folder: str, overwrite: bool, pictures: bool, output: Output) -> Outcome:
    """Fit a resolved spec and write the run folder.

    Raises
    ------
    KirisurfError
        Where the input or the output is at fault; the folder is then as it was.
    KeyboardInterrupt
        Where it was interrupted before there was anything to keep, or twice.
    """
    progress: Progress = Bar(spec.tolerance) if output.is_terminal else Lines(output.message)

    def kept(beside: str) -> None:
        output.warning(f"the certified run in {folder} was kept; what was reached lies in {beside}")

    with RunFolder(folder, overwrite) as opened, Interruption(output.message) as stop, progress:
        run = execute(spec, opened, stop, progress, pictures=pictures, kept=kept)
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
