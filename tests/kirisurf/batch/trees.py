"""Trees of files that are compared, and processes that go wrong on purpose."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

POISON = """
import os, signal, sys, time
if any("kirisurf.batch" in word for word in getattr(sys, "orig_argv", ())):
    import kirisurf.batch.making as making
    sound = making.make
    def make(order):
        name = os.path.basename(order.folder)
        if "segfault" in name:
            os.kill(os.getpid(), signal.SIGSEGV)
        if "abort" in name:
            os.abort()
        if "exit" in name:
            os._exit(3)
        if "hang" in name:
            signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM])
            while True:
                time.sleep(1)
        if "glutton" in name:
            kept = []
            while True:
                kept.append(bytes(10**7))
        if "raise" in name:
            raise RuntimeError("on purpose")
        if "killer" in name:
            os.kill(os.getppid(), signal.SIGKILL)
            time.sleep(60)
        if "patient" in name and not os.path.exists(order.folder + ".pid"):
            # the first time only
            with open(order.folder + ".half", "w") as file:
                file.write(str(os.getpid()))
            os.rename(order.folder + ".half", order.folder + ".pid")
            time.sleep(600)
        if "midway" in name:
            # after the folder was made, before anything was saved in it
            making.execute = lambda *parts, **options: os.kill(os.getpid(), signal.SIGKILL)
        return sound(order)
    making.make = make
"""
"""Text of sitecustomize.py: the processes that make runs go wrong where the name of a run folder says so."""

CHANGING = ("seconds", "peak_mb")
"""What is measured anew every time."""


def contents(root: Path) -> dict[str, Any]:
    """Return {path: content} of all files below a folder, without what is measured anew every time."""
    found: dict[str, Any] = {}
    for path in sorted(root.rglob("*")):
        name = path.relative_to(root).as_posix()
        if path.is_dir():
            found[f"{name}/"] = None
        elif path.suffix == ".json":
            found[name] = _timeless(json.loads(path.read_text(encoding="utf-8")))
        elif name == "summary.csv":
            lines = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
            at = [lines[0].index(column) for column in CHANGING]
            found[name] = [[cell for k, cell in enumerate(line) if k not in at] for line in lines]
        elif name != "report.html":  # that of the batch, which shows seconds; those of runs do not
            found[name] = path.read_bytes()
    return found


def differences(one: Path, other: Path) -> list[str]:
    """Return the names of files that are not in both folders alike."""
    here, there = contents(one), contents(other)
    return sorted(
        name for name in {*here, *there} if name not in here or name not in there or here[name] != there[name]
    )


def _timeless(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _timeless(each) for key, each in value.items() if key not in CHANGING}
    return [_timeless(each) for each in value] if isinstance(value, list) else value
