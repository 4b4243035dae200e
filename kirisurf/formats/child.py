"""Running a library that may crash, hang or eat all memory: one child process per call, killed on time.

The child gets its arrays and returns them by file (NumPy archives without pickle); what it prints on
standard output is one JSON object. It runs a script by its path, not a module of a package: so neither
the current folder nor the start-up of kirisurf has a part in it.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Ended:
    """How a child process ended.

    Attributes
    ----------
    answer : dict
        What it printed; empty where it printed nothing that can be read.
    death : str
        Empty where it ended by itself; else words on what ended it.
    complaint : str
        Last line of its standard error.
    """

    answer: dict
    death: str
    complaint: str


def run(script: Path, arguments: Sequence[str], seconds: int | float, memory_mb: int | float) -> Ended:
    """Run a Python script in a child process with limits on time and memory.

    The script gets `arguments`, then the memory limit in MB, which it must set itself with
    :func:`resource.setrlimit` (setting it between fork and exec is unsafe in a process with threads).
    """
    command = [sys.executable, "-P", str(script), *arguments, f"{memory_mb:g}"]
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "QT_QPA_PLATFORM": "offscreen"}
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=environment,
        start_new_session=os.name == "posix",  # Ctrl-C ends us, and we end the child, in that order
    )
    try:
        output, complaints = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return Ended({}, f"no answer within {seconds:g} s", "")
    except BaseException:
        process.kill()
        process.communicate()
        raise
    lines = complaints.decode("utf-8", "replace").strip().splitlines()
    death = f"death by {signal_name(-process.returncode)}" if process.returncode < 0 else ""
    return Ended(_parsed(output), death, lines[-1][:200] if lines else "")


def signal_name(number: int) -> str:
    """Name a signal by its number."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _parsed(output: bytes) -> dict:
    try:
        answer = json.loads(output.decode("utf-8", "replace").strip().splitlines()[-1])
    except (IndexError, ValueError):
        return {}
    return answer if isinstance(answer, dict) else {}
