"""Limits of a process on itself, and the end of all that it started."""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
from pathlib import Path

_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36


def limit_memory(megabytes: float) -> None:
    """Let this process allocate so much more than it has now; where the system knows no such limit, nothing happens."""
    try:
        import resource

        limit = _address_space() + int(megabytes * 1e6)
        most = resource.getrlimit(resource.RLIMIT_AS)[1]
        if most != resource.RLIM_INFINITY:
            limit = min(limit, most)
        resource.setrlimit(resource.RLIMIT_AS, (limit, most))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    except (ImportError, ValueError, OSError):
        return


def die_with(parent: int) -> None:
    """Let this process end with its parent, whatever ends that; Linux only."""
    _prctl(_PR_SET_PDEATHSIG, int(signal.SIGKILL))
    if os.getppid() != parent:  # it ended before this was asked for
        os._exit(1)


def adopt_orphans() -> None:
    """Let what a child of this process started become this process's own when the child ends; Linux only."""
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)


def end_orphans() -> None:
    """End all that is left of the children of this process."""
    for each in _children(os.getpid()):
        end_family(each)
        with contextlib.suppress(ChildProcessError):
            os.waitpid(each, 0)


def end_family(process: int) -> None:
    """Kill a process and all that it started, the youngest last, as far as the system tells who they are."""
    family = [process]
    for each in family:
        family += _children(each)
    for each in family:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.kill(each, signal.SIGKILL)


def _prctl(option: int, value: int) -> None:
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None, use_errno=True).prctl(option, value, 0, 0, 0)


def _children(process: int) -> list[int]:
    found: list[int] = []
    try:
        for task in Path(f"/proc/{process}/task").iterdir():
            found += [int(word) for word in (task / "children").read_text().split()]
    except (OSError, ValueError):
        return found
    return found


def _address_space() -> int:
    try:
        return int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError):
        return 4 << 30
