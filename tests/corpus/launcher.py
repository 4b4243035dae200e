"""Program of a child: limits its own memory, notes which files it opens, then becomes `python -m kirisurf`.

    launcher.py NOTES MEMORY_MB ARGUMENT...

Every file that Python opens outside the installation, and every address that it connects or binds to, becomes one
line of NOTES. It imports nothing of kirisurf before the limits hold.
"""

from __future__ import annotations

import os
import runpy
import sys
import sysconfig
import tempfile

OWN = (
    *(sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib", "scripts")),
    sys.prefix,
    sys.base_prefix,
    os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))),
    tempfile.gettempdir(),
    "/proc/",
    "/sys/",
    "/dev/null",
)
"""Where the interpreter, its libraries and temporary files lie."""


def is_own(path: str) -> bool:
    """Return whether a path belongs to the installation or to temporary files, as it is written or as it is meant."""
    return any(found.startswith(OWN) for found in (path, os.path.abspath(path), os.path.realpath(path)))


def watch(notes: str) -> None:
    """Write every file that is opened from now on, and every socket's address, into a file of notes."""
    handle = os.open(notes, os.O_WRONLY | os.O_CREAT | os.O_APPEND)

    def heard(event: str, arguments: tuple) -> None:
        if event == "open" and isinstance(arguments[0], (str, bytes)):
            path = os.fsdecode(arguments[0])
            if not is_own(path):
                os.write(handle, os.fsencode(f"open {path}\n"))
        elif event in ("socket.connect", "socket.bind"):
            os.write(handle, os.fsencode(f"{event} {arguments[1]}\n"))

    sys.addaudithook(heard)


def main(notes: str, memory_mb: str, *arguments: str) -> None:
    """Limit, watch, run."""
    try:
        import resource

        most = int(memory_mb) * 1_000_000
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    except ImportError:
        pass  # a system without such limits: the wall-clock limit of the parent remains
    sys.argv = ["kirisurf", *arguments]
    watch(notes)
    runpy.run_module("kirisurf", run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
