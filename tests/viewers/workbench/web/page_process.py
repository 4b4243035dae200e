"""`kirisurf view --web` as a process of its own, as a user starts it."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path


class PageProcess:
    """A server of a page, up to the address that it prints.

    Parameters
    ----------
    *arguments : str
        After `kirisurf view --web --no-browser`.
    """

    def __init__(self, *arguments: str) -> None:
        command = [sys.executable, "-m", "kirisurf", "view", "--web", "--no-browser", *arguments]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.first = self.process.stderr.readline()
        found = re.search(r"http://\S+", self.first)
        self.address = found[0] if found else ""

    def children(self) -> list[int]:
        """Return the processes that it started."""
        task = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children")
        return [int(number) for number in task.read_text().split()] if task.exists() else []

    def interrupt(self) -> tuple[int, str, str]:
        """Send Ctrl-C, and return exit code, standard output and the rest of standard error."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        out, err = self.process.communicate(timeout=120)
        return self.process.returncode, out, err

    def __enter__(self) -> PageProcess:
        return self

    def __exit__(self, *exception: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()
