"""`kirisurf view`: the workbench, a window or a page on a run or a target."""

from __future__ import annotations

import argparse
from typing import Any

from kirisurf.cli.fit import add_spec_options, given_options
from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command, whole
from kirisurf.errors import ParameterError

FIRST_TARGET = "hypar"
"""What a page shows that was opened without a target: files are opened from the page itself."""

_TEXT = """\
Opens a run folder, or a target that is fitted at once, in a window: the flat and the open sheet side by side, all
options of `fit` in a panel, and a new fit as soon as one changes. Tiles and holes are colored by any measure and
picked by a click; the pattern is turned and sized by dragging; runs, pictures and animations are saved from there.

That needs a display, and Qt: pip install 'kirisurf[desktop]'. Without Qt a plain window shows the run or the target
alone, and the command ends with code 1; without a display too (report.html in the run shows the pictures).

With --web the same opens in a browser, without a display here: meshes and outlines are opened on the page, cut
files and runs are downloaded from it. It is served on this machine alone, under an address with a random key that
is printed here; nothing is loaded from elsewhere. That needs trame: pip install 'kirisurf[web]'. From another
machine: ssh -L N:127.0.0.1:N HOST, with --port N. Tabs may be closed and opened again: the work stays, until
Ctrl-C ends the command.

Ctrl-C in the terminal closes the window or the page."""

_EXAMPLES = """\
  kirisurf view hypar
  kirisurf view hood.stl --tiles 400 --tessellation kagome
  kirisurf view runs/hood
  kirisurf view --web
  kirisurf view runs/hood --web --port 8080 --no-browser"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "view", "open a run or a target in the workbench", _TEXT, _EXAMPLES)
    parser.add_argument(
        "target",
        metavar="RUN|TARGET",
        nargs="?",
        help=f"run folder, mesh or outline file, or a sample's name; with --web {FIRST_TARGET} where none is given",
    )
    page = parser.add_argument_group("in a browser")
    page.add_argument("--web", action="store_true", help="open a page instead of a window")
    page.add_argument("--port", metavar="N", type=whole, help="port of the page; default: any that is free")
    page.add_argument("--no-browser", action="store_true", help="open no browser, print the page's address only")
    add_spec_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.publishing import show_workbench

    if arguments.web:
        return _serve(arguments, output)
    if arguments.port is not None or arguments.no_browser:
        raise ParameterError("--port, --no-browser: expected together with --web, got no --web")
    if arguments.target is None:
        raise ParameterError("RUN|TARGET: expected a run folder, a file or a sample's name, got none (or use --web)")
    warning = show_workbench(arguments.target, given_options(arguments))
    if warning:
        output.warning(warning)
    return Outcome(1 if warning else 0, {"shown": arguments.target, "warning": warning})


def _serve(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Serve the page until Ctrl-C; that is its ordinary end."""
    from kirisurf.publishing import serve_workbench

    port = arguments.port if arguments.port is not None else 0
    if arguments.port is not None and not 1 <= arguments.port <= 65535:
        raise ParameterError(f"--port: expected a number from 1 to 65535, got {arguments.port}")
    target = arguments.target or FIRST_TARGET

    def ready(address: str) -> None:
        # where messages are not wanted this is the product: without it the page cannot be found
        (output.product if output.quiet else output.message)(f"The workbench is at {address}")
        output.message("The address is its key: it is for you alone. Ctrl-C here closes the page.")

    address = serve_workbench(target, given_options(arguments), ready, port, not arguments.no_browser)
    return Outcome(0, {"shown": target, "address": address})
