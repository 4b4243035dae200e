"""`kirisurf report`: one self-contained HTML file on one run or several."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command

_TEXT = """\
Writes one HTML file that holds everything it shows (pictures too) and can be mailed. For one run it goes to
report.html in the run folder unless -o names another file; for several runs it compares them, and -o is needed."""

_EXAMPLES = """\
  kirisurf report runs/hood
  kirisurf report runs/a runs/b runs/c -o comparison.html"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "report", "write the report of a run, or compare several", _TEXT, _EXAMPLES)
    parser.add_argument("folders", metavar="RUN", nargs="+", help="run folders")
    parser.add_argument("-o", "--output", metavar="FILE.html", help="file to write (default: report.html in the run)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.errors import ParameterError
    from kirisurf.publishing import REPORT, run_report_parts, write_report
    from kirisurf.runs import read_run
    from kirisurf.runs.record import renewed_record

    if arguments.output is None and len(arguments.folders) > 1:
        raise ParameterError(f"-o: expected a file for the comparison of {len(arguments.folders)} runs, got none")
    runs = [read_run(folder) for folder in arguments.folders]
    parts = [run_report_parts(each) for each in runs]
    path = Path(arguments.output) if arguments.output is not None else runs[0].folder / REPORT
    write_report(parts[0] if len(parts) == 1 else parts, path)
    if arguments.output is None:
        renewed_record(runs[0].folder, [REPORT])
    output.product(str(path))
    return Outcome(0, {"report": str(path), "runs": [str(each.folder) for each in runs]})
