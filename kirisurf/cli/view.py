"""`kirisurf view`: the workbench, a window on a run or a target."""

from __future__ import annotations

import argparse
from typing import Any

from kirisurf.cli.fit import add_spec_options, given_options
from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command, whole

_TEXT = """\
Opens a run folder, or a target that is fitted at once, in a window: the flat and the open sheet side by side, all
options of `fit` in a panel, and a new fit as soon as one changes. Tiles and holes are colored by any measure and
picked by a click; the pattern is turned and sized by dragging; runs, pictures and animations are saved from there.

That needs a display, and Qt: pip install 'kirisurf[desktop]'. Without Qt a plain window shows the run or the target
alone, and the command ends with code 1; without a display too (report.html in the run shows the pictures).
Ctrl-C in the terminal closes the window."""

_EXAMPLES = """\
  kirisurf view hypar
  kirisurf view hood.stl --tiles 400 --tessellation kagome
  kirisurf view runs/hood"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "view", "open a run or a target in the workbench", _TEXT, _EXAMPLES)
    parser.add_argument("target", metavar="RUN|TARGET", help="run folder, mesh or outline file, or a sample's name")
    parser.add_argument("--web", action="store_true", help="in a browser: not available in this version")
    parser.add_argument("--port", metavar="N", type=whole, help=argparse.SUPPRESS)
    parser.add_argument("--no-browser", action="store_true", help=argparse.SUPPRESS)
    add_spec_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.errors import ParameterError
    from kirisurf.publishing import show_workbench

    if arguments.web or arguments.port is not None or arguments.no_browser:
        raise ParameterError("--web is not available in this version: leave it out for a window, or open report.html.")
    warning = show_workbench(arguments.target, given_options(arguments))
    if warning:
        output.warning(warning)
    return Outcome(1 if warning else 0, {"shown": arguments.target, "warning": warning})
