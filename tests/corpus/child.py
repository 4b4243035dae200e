"""One `kirisurf` command in a child process with limits on time and memory, and what became of it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

LAUNCHER = Path(__file__).with_name("launcher.py")
ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Ended:
    """How a command ended.

    Attributes
    ----------
    code : int or None
        Exit code; None where it was killed for its time, or died by a signal.
    death : str
        Empty where it ended by itself; else words on what ended it.
    seconds : float
    output, messages : str
        Standard output and standard error.
    opened : tuple of str
        Files outside the installation that it opened, and addresses of sockets.
    """

    code: int | None
    death: str
    seconds: float
    output: str
    messages: str
    opened: tuple[str, ...]


def run(arguments: Sequence[str], seconds: float, memory_mb: int) -> Ended:
    """Run `kirisurf` with the given arguments."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
    with tempfile.TemporaryDirectory(prefix="kirisurf-corpus-") as folder:
        notes = Path(folder, "opened")
        notes.touch()
        began = time.monotonic()
        process = subprocess.Popen(
            [sys.executable, "-P", str(LAUNCHER), str(notes), str(memory_mb), *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
            start_new_session=True,
        )
        try:
            output, messages = process.communicate(timeout=seconds)
            death = signal.Signals(-process.returncode).name if process.returncode < 0 else ""
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)  # children of its own too
            output, messages = process.communicate()
            death = f"no end within {seconds:g} s"
        return Ended(
            None if death else process.returncode,
            death,
            time.monotonic() - began,
            output.decode("utf-8", "replace"),
            messages.decode("utf-8", "replace"),
            tuple(os.fsdecode(notes.read_bytes()).splitlines()),
        )
