"""`kirisurf report`: one self-contained HTML file on one run or several."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command

_TEXT = """\
Writes one HTML file that holds everything it shows (pictures too), can be mailed, and prints well. For one run it
goes to report.html in the run folder unless -o names another file; for several runs it compares them, and -o is
needed. Pictures that a run does not hold are drawn, where that is possible here.

A name that ends in .json gets every number of the page instead, in full precision; so does --json."""

_EXAMPLES = """\
  kirisurf report runs/hood
  kirisurf report runs/a runs/b runs/c -o comparison.html
  kirisurf report runs/hood -o numbers.json"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "report", "write the report of a run, or compare several", _TEXT, _EXAMPLES)
    parser.add_argument("folders", metavar="RUN", nargs="+", help="run folders")
    parser.add_argument("-o", "--output", metavar="FILE", help=".html or .json (default: report.html in the run)")
    parser.add_argument("--no-pictures", action="store_true", help="draw none; those that the run holds are shown")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.errors import ParameterError
    from kirisurf.publishing import REPORT
    from kirisurf.reporting import check_report, report, report_numbers
    from kirisurf.runs import read_run
    from kirisurf.runs.record import renewed_record

    if arguments.output is None and len(arguments.folders) > 1:
        raise ParameterError(f"-o: expected a file for the comparison of {len(arguments.folders)} runs, got none")
    if arguments.output is not None:
        check_report(arguments.output)
    runs = [read_run(folder) for folder in arguments.folders]
    path = Path(arguments.output) if arguments.output is not None else runs[0].folder / REPORT
    report(runs, path, pictures=not arguments.no_pictures)
    if arguments.output is None:
        renewed_record(runs[0].folder, [REPORT])
    output.product(str(path))
    numbers = report_numbers(runs) if output.json else {}
    return Outcome(0, {"report": str(path), "runs": [str(each.folder) for each in runs], "numbers": numbers})
