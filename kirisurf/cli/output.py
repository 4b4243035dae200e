"""What a command prints: its product on standard output, everything else on standard error."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from kirisurf.naming import printable


@dataclass(frozen=True)
class Outcome:
    """How a command ended.

    Attributes
    ----------
    code : int
        Exit code.
    result : mapping
        What `--json` prints.
    """

    code: int = 0
    result: Mapping[str, Any] = field(default_factory=dict)


class Output:
    """The two streams of a command.

    Parameters
    ----------
    json : bool
        Standard output carries one JSON object, printed at the end, and nothing else.
    quiet : bool
        No messages but errors and warnings.
    """

    def __init__(self, json: bool = False, quiet: bool = False) -> None:
        self.json = json
        self.quiet = quiet

    def product(self, text: str) -> None:
        """Print what the user asked for."""
        if not self.json:
            _write("stdout", text)

    def message(self, text: str) -> None:
        """Print what is good to know."""
        if not self.quiet:
            _write("stderr", text)

    def warning(self, text: str) -> None:
        """Print what needs reading."""
        _write("stderr", f"warning: {text}")

    def error(self, text: str) -> None:
        """Print why the command failed, on one line."""
        _write("stderr", printable(f"kirisurf: {text}"))

    def finish(self, command: str, outcome: Outcome) -> None:
        """Print the JSON object, if asked for, and flush."""
        if self.json:
            from kirisurf.runs.record import json_text

            _write("stdout", json_text({"command": command, "exit_code": outcome.code, **outcome.result}).rstrip())
        for name in ("stdout", "stderr"):
            _guarded(name, getattr(sys, name).flush)

    @property
    def is_terminal(self) -> bool:
        """Whether progress may be drawn as a bar that moves."""
        return sys.stderr.isatty() and os.environ.get("TERM", "") != "dumb" and not self.quiet


def prepare_streams() -> None:
    """Let no character stop a message (a terminal without it shows its code), and a closed stream take all."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 (lives as long as the process)
        stream = getattr(sys, name)
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def _write(name: str, text: str) -> None:
    _guarded(name, lambda: print(printable(text, "\n\t"), file=getattr(sys, name)))


def _guarded(name: str, act: Callable[[], None]) -> None:
    """Act on a stream; where its reader has gone (as after `| head`), go on in silence."""
    try:
        act()
    except BrokenPipeError:
        # Python flushes again at exit and would complain: give it a stream that takes all.
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, getattr(sys, name).fileno())
        os.close(nothing)
