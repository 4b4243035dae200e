"""`kirisurf view`: a window on a run or a target."""

from __future__ import annotations

import argparse
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command, whole

_TEXT = """\
Opens a run folder, or a target surface alone, in a window where it can be turned and zoomed. That needs a
display; without one the command says so and ends with code 1 (report.html in the run shows the pictures)."""

_EXAMPLES = """\
  kirisurf view runs/hood
  kirisurf view car_hood"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "view", "open a run or a target in a window", _TEXT, _EXAMPLES)
    parser.add_argument("target", metavar="RUN|TARGET", help="run folder, mesh file or name of a sample surface")
    parser.add_argument("--web", action="store_true", help="in a browser: not available in this version")
    parser.add_argument("--port", metavar="N", type=whole, help=argparse.SUPPRESS)
    parser.add_argument("--no-browser", action="store_true", help=argparse.SUPPRESS)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    import os

    from kirisurf.errors import ParameterError
    from kirisurf.publishing import show_run, show_surface
    from kirisurf.runs import read_run
    from kirisurf.targets import load

    if arguments.web or arguments.port is not None or arguments.no_browser:
        raise ParameterError("--web is not available in this version: leave it out for a window, or open report.html.")
    if os.path.isdir(arguments.target):
        show_run(read_run(arguments.target))
    else:
        show_surface(load(arguments.target))
    return Outcome(0, {"shown": arguments.target})
