"""The kirisurf program as a child process of ParaView: found, started, listened to, stopped.

ParaView brings a Python, a NumPy and a VTK of its own, and two VTKs in one process clash. So nothing of kirisurf is
imported here: this file needs Python 3.9 and its standard library alone, and the program runs in its own environment.
"""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

VARIABLE = "KIRISURF"
_GRACE = 20.0  # seconds to save the best point so far, before the program is ended
_STEP = re.compile(r"step +(\d+): (.*?) +\([\d.]+ s\)")
_NUMBER = re.compile(r"\d+\.\d+e[+-]\d+")


class ProgramError(Exception):
    """Why there is no answer, in one sentence for the user."""


@dataclass(frozen=True)
class Answer:
    """How the program ended.

    Attributes
    ----------
    code : int
        Its exit code: 0 done, 1 done with warnings, 5, 6 and 130 with the best result so far.
    result : dict
        The JSON object that it printed; empty where there was none.
    said : tuple of str
        Its messages, line by line.
    """

    code: int
    result: dict[str, Any]
    said: tuple[str, ...]

    @property
    def complaint(self) -> str:
        """The sentence to show where it did not do what was asked."""
        if "error" in self.result:
            return str(self.result["error"])
        return (
            self.said[-1].removeprefix("kirisurf: ")
            if self.said
            else f"kirisurf ended with code {self.code} and without a word"
        )


def find_program(given: str = "") -> str:
    """Return the path of the kirisurf program.

    Parameters
    ----------
    given : str
        The program, or the folder of the environment that it is installed in. Where it is empty, the variable
        KIRISURF says so, and where that is empty too, the program on the path is taken.

    Raises
    ------
    ProgramError
        Where there is none.
    """
    wanted = os.path.expanduser((given or os.environ.get(VARIABLE, "")).strip())
    if not wanted:
        found = shutil.which("kirisurf")
        if found is None:
            raise ProgramError(
                "expected the program kirisurf on the path, got none: set the property Program or the variable "
                f"{VARIABLE} to it (such as /home/me/kirisurf/.venv/bin/kirisurf)"
            )
        return found
    inside = [os.path.join(wanted, folder, "kirisurf") for folder in ("bin", "Scripts")]
    for place in (wanted, *inside):
        found = shutil.which(place)
        if found is not None:
            return found
    raise ProgramError(f"expected the program kirisurf or the folder of its environment, got {wanted!r}")


def environment() -> dict[str, str]:
    """Return the variables for the program: without those by which ParaView leads Python to its own libraries."""
    found = {key: text for key, text in os.environ.items() if not key.startswith("PYTHON")}
    paths = [path for path in found.pop("LD_LIBRARY_PATH", "").split(os.pathsep) if "paraview" not in path.lower()]
    if any(paths):
        found["LD_LIBRARY_PATH"] = os.pathsep.join(paths)
    return found


def run(
    command: Sequence[str],
    tell: Callable[[float, str], None] = lambda share, line: None,
    should_stop: Callable[[], bool] = lambda: False,
) -> Answer:
    """Run the program to its end.

    Parameters
    ----------
    command : sequence of str
        The program and its arguments, `--json` among them.
    tell : callable
        Receives the share that is done, from 0 to 1, and the message that says so.
    should_stop : callable
        Asked ten times a second; once it is true the program is interrupted and saves what it has.

    Raises
    ------
    ProgramError
        Where it cannot be started.
    """
    try:
        process = subprocess.Popen(
            list(command),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            env=environment(),
        )
    except OSError as problem:
        raise ProgramError(f"expected to start {command[0]}, got: {problem.strerror or problem}") from problem
    printed: list[str] = []
    said: list[str] = []
    streams = ((process.stdout, printed), (process.stderr, said))
    readers = [threading.Thread(target=_collect, args=pair, daemon=True) for pair in streams]
    for reader in readers:
        reader.start()
    try:
        _watch(process, readers, said, tell, should_stop)
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        for reader in readers:
            reader.join(timeout=5.0)
    return Answer(process.returncode, _parsed("".join(printed)), tuple(line.rstrip() for line in said))


def _watch(
    process: subprocess.Popen[str],
    readers: Sequence[threading.Thread],
    said: list[str],
    tell: Callable[[float, str], None],
    should_stop: Callable[[], bool],
) -> None:
    """Hand on the messages until the program ends; interrupt it where asked."""
    share, first, heard = 0.02, 0.0, 0
    patience: float | None = None
    while True:
        ended = process.poll() is not None
        if ended:
            for reader in readers:
                reader.join(timeout=5.0)  # its last words
        for line in said[heard:]:
            heard += 1
            share, first = _share_done(line, share, first)
            tell(share, line.strip())
        if ended:
            return
        if patience is None and should_stop():
            _interrupt(process)
            patience = time.monotonic() + _GRACE
        if patience is not None and time.monotonic() > patience:
            process.kill()
        time.sleep(0.1)


def _interrupt(process: subprocess.Popen[str]) -> None:
    if os.name == "posix":
        process.send_signal(signal.SIGINT)
    else:
        process.terminate()  # Windows has no such signal for a single child


def _share_done(line: str, share: float, first: float) -> tuple[float, float]:
    """Share that is done after a message: in the solve by the digits that the worst residual has won."""
    step = _STEP.match(line)
    if step is None:
        for word, reached in (("solving", 0.1), ("measuring", 0.8), ("certifying", 0.9), ("writing", 0.95)):
            if line.startswith(word):
                return max(share, reached), first
        return share, first
    worst = max([float(number) for number in _NUMBER.findall(step[2])], default=0.0)
    first = max(first, worst)
    if not worst > 0.0:
        return share, first
    digits = min(_digits(first, worst) / 10.0, 1.0)
    return max(share, 0.1 + 0.7 * digits), first


def _digits(first: float, last: float) -> float:
    return max(math.log10(first / last), 0.0)


def _collect(stream: Any, lines: list[str]) -> None:
    with stream:
        for line in stream:
            lines.append(line)


def _parsed(text: str) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}
