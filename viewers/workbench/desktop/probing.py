"""Whether Qt can open a window here: asked in a child process, because Qt ends one in which it cannot."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

from viewers.opengl import OpenGL, probe_display
from viewers.workbench.desktop.qt import INSTALL_LINE, LIBRARY_LINE, is_installed

_PROBE = """
from PySide6.QtWidgets import QApplication
QApplication(["kirisurf"])
print("shown")
"""


def probe_workbench(seconds: float = 60.0) -> OpenGL:
    """Say whether the workbench can be opened, and in one sentence why not and what to do.

    The plain window may open all the same: see :func:`viewers.opengl.probe_display`, which is asked too.
    """
    if not is_installed():
        return OpenGL(False, "", f"The workbench needs Qt; this line installs it: {INSTALL_LINE}")
    with ThreadPoolExecutor(1) as pool:
        display = pool.submit(probe_display)
        ending = ending_of_qt(seconds)
        answer = display.result()
    if not answer.available:
        return answer
    if ending:
        return OpenGL(False, "", f"Qt cannot open a window here ({ending}); {LIBRARY_LINE}")
    return answer


def ending_of_qt(seconds: float = 60.0) -> str:
    """How a child process ended that opened Qt; empty where it did well."""
    try:
        child = subprocess.run(
            [sys.executable, "-P", "-c", _PROBE],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=seconds,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as problem:
        return str(problem)
    if "shown" in child.stdout and child.returncode == 0:
        return ""
    lines = [line for line in child.stderr.splitlines() if line.strip()]
    return lines[0].strip().rstrip(".") if lines else f"code {child.returncode}"
