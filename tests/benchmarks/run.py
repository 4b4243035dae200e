"""Speed of the solver, ours and its peers' on the same problems: a Markdown table on standard output and in a file.

    make bench                                                     all of it, some minutes
    python tests/benchmarks/run.py --large                         with 128x128 and 256x256 tiles
    python tests/benchmarks/run.py --meshes FOLDER                 with the mesh files in a folder
    python tests/benchmarks/run.py --problems peaks:32x32 dome:360 --peers ipopt

Every measurement is a process of its own. The peers ipopt and uno need the extra kirisurf[peers].
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path

from kirisurf.errors import KirisurfError
from tests.benchmarks.measuring import Measurement
from tests.benchmarks.problems import OURS, PEERS, Problem, installed_peers, parsed, standard
from tests.benchmarks.tables import LEGEND, derived, header, line

ROOT = Path(__file__).resolve().parents[2]
GRACE = 900.0
"""Seconds that a process may take beyond the limit of its solve, for the start, the certificate and the repeats."""
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


class Report:
    """Lines that go to standard output and to a file, which is complete after every line."""

    def __init__(self, path: Path) -> None:
        self._path, self._lines = path, list[str]()
        path.parent.mkdir(parents=True, exist_ok=True)

    def add(self, *lines: str) -> None:
        """Add lines."""
        self._lines += lines
        print(*lines, sep="\n", flush=True)
        self._path.write_text("\n".join(self._lines) + "\n", encoding="utf-8")


def measured(problem: Problem, solver: str, max_seconds: float | None) -> Measurement:
    """Measure in a process of its own; what ends it early is the row's end."""
    wanted = {
        "name": problem.name,
        "target": problem.target,
        "options": problem.options,
        "solver": solver,
        "max_seconds": max_seconds,
    }
    with tempfile.TemporaryDirectory(prefix="kirisurf-") as folder:
        path = Path(folder, "row.json")
        command = [sys.executable, "-m", "tests.benchmarks.measuring", json.dumps(wanted), str(path)]
        limit = None if max_seconds is None else max_seconds + GRACE
        try:
            ended = subprocess.run(
                command, cwd=ROOT, env={**ONE_THREAD, **os.environ}, capture_output=True, text=True, timeout=limit
            )
        except subprocess.TimeoutExpired:
            return Measurement(problem.name, solver, "killed", note=f"no end within {limit:.0f} s")
        if not path.is_file():
            said = ended.stderr.strip().splitlines() or ["nothing"]
            return Measurement(problem.name, solver, "crashed", note=f"code {ended.returncode}: {said[-1][:200]}")
        return Measurement(**json.loads(path.read_text(encoding="utf-8")))


def machine() -> list[str]:
    """Lines on what was measured, and where."""
    libraries = ("kirisurf", "numpy", "scipy", "ipyopt", "unopy")
    versions = []
    for name in libraries:
        try:
            versions.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            versions.append(f"{name} not installed")
    load = f", load {os.getloadavg()[0]:.1f} at the start" if hasattr(os, "getloadavg") else ""
    return [
        f"{platform.system()} {platform.machine()}, {_processor()}, {os.cpu_count()} cores{load}; "
        f"OMP_NUM_THREADS={os.environ.get('OMP_NUM_THREADS', ONE_THREAD['OMP_NUM_THREADS'])}; "
        f"Python {platform.python_version()}, {', '.join(versions)}.",
    ]


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(text.partition(":")[2].strip() for text in lines if text.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "unknown processor"


def main(words: list[str] | None = None) -> int:
    """Measure, print and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--large", action="store_true", help="also 128x128 and 256x256 tiles")
    parser.add_argument("--meshes", type=Path, metavar="FOLDER", help="also every mesh file of a folder, ~360 tiles")
    parser.add_argument(
        "--problems", nargs="+", metavar="NAME:SIZE", help="only these: NxN, a grid of tiles, or N, about so many"
    )
    parser.add_argument("--peers", nargs="*", choices=PEERS, help="default: all that are installed")
    parser.add_argument("--peer-seconds", type=float, default=120.0, help="time limit of a peer's solve; default: 120")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "build" / "bench.md", metavar="FILE")
    chosen = parser.parse_args(words)
    try:
        named = [parsed(text) for text in chosen.problems or ()]
    except KirisurfError as problem:
        parser.error(str(problem))
    if chosen.meshes is not None and not chosen.meshes.is_dir():
        parser.error(f"--meshes: expected a folder, got {chosen.meshes}")
    problems = named or standard(chosen.large, chosen.meshes)
    peers = installed_peers() if chosen.peers is None else chosen.peers
    report, rows = Report(chosen.output), list[Measurement]()
    report.add(*machine(), "", *header())
    for problem in problems:
        for solver in problem.solvers(peers):
            row = measured(problem, solver, None if solver == OURS else chosen.peer_seconds)
            rows.append(row)
            report.add(line(row))
    report.add("", LEGEND)
    report.add("", *(derived(problems, rows) or ["- Nothing to compare: one size, one solver."]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
