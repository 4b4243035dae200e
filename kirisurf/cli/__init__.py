"""The command line: the only room that knows all others, and the only one that prints.

Modules that compute or draw are imported inside the functions that run, so that `kirisurf --help` starts at once.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import threading
import traceback
from collections.abc import Sequence

from kirisurf.cli import audit, batch, curvature, demo, deploy, export, fit, report, reproduce, samples, view
from kirisurf.cli.output import Outcome, Output, prepare_streams
from kirisurf.cli.parser import Parser, add_common
from kirisurf.cli.rooms import check_rooms
from kirisurf.failures import explained

__all__ = ["build_parser", "main"]

_TEXT = """\
kirisurf designs kirigami: a flat sheet of rigid tiles, cut along slits, that opens into a target surface.
It writes the cut pattern to scale, both states of the sheet, a certificate of every residual, and the
curvature of the holes against that of the target."""

_EXAMPLES = """\
start here:
  kirisurf demo                             design a sheet for a bundled surface, and see what comes out
  kirisurf samples                          list the bundled surfaces
  kirisurf fit hood.stl -o runs/hood        design a sheet for your own surface
  kirisurf COMMAND --help                   the page of a command

exit codes: 0 done, 1 done with warnings that need reading, 2 wrong parameter, 3 input unreadable, 4 input
unusable, 5 fit not within tolerance, 6 time or memory limit, 7 output cannot be written, 8 batch finished but
some items failed, 70 internal error, 130 interrupted"""


def build_parser() -> Parser:
    """Return the parser of all commands."""
    parser = Parser(prog="kirisurf", description=_TEXT, epilog=_EXAMPLES)
    parser.add_argument("--version", action="store_true", help="print the version and end")
    add_common(parser)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", title="commands", parser_class=Parser)
    for module in (demo, fit, audit, curvature, deploy, report, view, export, batch, reproduce, samples):
        module.add(commands)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit code; never raises, never ends the process.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the program's name; by default those of the process.
    """
    end_cleanly_on_signals()
    words = list(sys.argv[1:] if argv is None else argv)
    options = words[: words.index("--")] if "--" in words else words
    output = Output("--json" in options, "-q" in options or "--quiet" in options)
    prepare_streams()
    command = ""
    try:
        arguments = build_parser().parse_args(words)
        command = arguments.command or ""
        outcome = _run(arguments, output)
        output.finish(command, outcome)
        return outcome.code
    except SystemExit as end:  # argparse after --help
        return int(end.code or 0)
    except (Exception, KeyboardInterrupt) as problem:
        return _fail(problem, command, output, "--debug" in options)


def end_cleanly_on_signals() -> None:
    """Let SIGTERM and SIGHUP end a command as Ctrl-C does, from its first moment on."""
    if threading.current_thread() is not threading.main_thread():
        return
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, signal.default_int_handler)


def _run(arguments: argparse.Namespace, output: Output) -> Outcome:
    if arguments.version:
        import kirisurf

        output.product(f"kirisurf {kirisurf.__version__}")
        return Outcome(0, {"version": kirisurf.__version__})
    if arguments.command is None:
        build_parser().error("expected a command, got none")
    check_rooms()
    outcome: Outcome = arguments.run(arguments, output)
    return outcome


def _fail(problem: BaseException, command: str, output: Output, debug: bool) -> int:
    code, message = explained(problem)
    if debug:
        traceback.print_exception(problem, file=sys.stderr)
    try:
        output.error(message)
        output.finish(command, Outcome(code, {"error": message}))
    except OSError as also:
        # Standard output itself cannot be written (a full disk behind it): only the code can still tell.
        code = explained(also)[0]
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 (Python flushes it at exit)
    return code
