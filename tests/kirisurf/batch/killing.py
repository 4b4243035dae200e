"""Rounds of start, kill -9 at a random moment, start again; the tree must end as one that nobody disturbed.

python tests/kirisurf/batch/killing.py [ROUNDS]
"""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TEXT = """
targets = ["hypar", "./junk.obj", "circle", "sphere"]
[matrix]
cells = ["1x1", "2x2"]
"""
VICTIMS = ("batch", "host", "run", "all")


def start(folder: Path, out: Path, workers: int = 2) -> subprocess.Popen[bytes]:
    """Start a batch in a session of its own."""
    words = ["batch", str(folder / "batch.toml"), "-o", str(out), "-q", "--workers", str(workers)]
    return subprocess.Popen(
        [sys.executable, "-m", "kirisurf", *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )


def rounds(n: int, folder: Path, seed: int, longest: float) -> dict[str, int]:
    """Return how many batches were killed, where, and how many times the tree was finished and found equal.

    Raises
    ------
    AssertionError
        Where a finished tree differs from the one that was left in peace.
    """
    from tests.kirisurf.batch.trees import differences

    chance = random.Random(seed)
    (folder / "batch.toml").write_text(TEXT)
    (folder / "junk.obj").write_text("v 0 0 0\n")
    peace, out = folder / "peace", folder / "out"
    assert finish(folder, peace) == 8
    counts = {"finished and equal": 0, **dict.fromkeys((f"killed: {victim}" for victim in VICTIMS), 0)}
    for _ in range(n):
        process = start(folder, out)
        time.sleep(longest * chance.random())
        victim = chance.choice(VICTIMS)
        if process.poll() is None:
            counts[f"killed: {victim}"] += 1
            kill(process, victim)
        if victim in ("host", "run"):
            # the batch itself lives on, and has to come to its end
            assert process.wait(600) in (8, -signal.SIGKILL)
        process.wait(600)
        if process.stderr is not None:
            process.stderr.close()
        if chance.random() < 0.25:
            assert finish(folder, out) == 8
            assert differences(peace, out) == [], differences(peace, out)
            counts["finished and equal"] += 1
            shutil.rmtree(out)
    assert finish(folder, out) == 8
    assert differences(peace, out) == [], differences(peace, out)
    counts["finished and equal"] += 1
    return counts


def finish(folder: Path, out: Path) -> int:
    """Run a batch to its end and return its code; that junk fails is expected."""
    process = start(folder, out)
    _, said = process.communicate(timeout=900)
    if process.returncode != 8:
        sys.stderr.write(said.decode())
    return process.returncode


def kill(process: subprocess.Popen[bytes], victim: str) -> None:
    """Kill the batch, one of its hosts, the run of one, or all of them."""
    hosts = children(process.pid)
    runs = [run for host in hosts for run in children(host)]
    chosen = {
        "batch": [process.pid],
        "host": hosts[:1],
        "run": runs[:1],
        "all": [process.pid, *hosts, *runs],
    }[victim]
    for each in chosen:
        try:
            os.kill(each, signal.SIGKILL)
        except ProcessLookupError:
            continue


def children(process: int) -> list[int]:
    """Return the processes that a process started, as far as the system tells."""
    found: list[int] = []
    try:
        for task in Path(f"/proc/{process}/task").iterdir():
            found += [int(word) for word in (task / "children").read_text().split()]
    except OSError:
        return found
    return found


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[3]))
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as made:
        found = rounds(count, Path(made), seed=2026, longest=float(sys.argv[2]) if len(sys.argv) > 2 else 8.0)
    print(f"{count} rounds in {time.monotonic() - began:.0f} s: {found}")  # noqa: T201
