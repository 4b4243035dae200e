"""One measurement, in a process of its own: `python -m tests.benchmarks.measuring '{...}' OUT.json`.

The fit is the product's own, `kirisurf.fit`, as a user calls it. The first fit of a process pays for what it
imports, so a tiny one goes before. Quick ones are repeated, and the fastest counts.
"""

from __future__ import annotations

import json
import resource
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import kirisurf
from kirisurf.design import Design
from kirisurf.solvers.choice import default_steps
from kirisurf.status import Status
from tests.benchmarks.problems import OURS
from tests.benchmarks.stopwatch import Stopwatch

QUICK, REPEATS = 1.0, 3
RIGID = ("length", "angle", "planarity", "isometry", "closure")


@dataclass
class Measurement:
    """One row of the table.

    Attributes
    ----------
    problem, solver : str
    end : str
        How it ended, in a word or two.
    tiles, steps : int
    fit, solve : float
        Seconds of the whole fit (reading, start, solve, contraction) and of its solve.
    parts : dict of str to float
        Seconds of the solve by `stopwatch.PARTS`; they add up to `solve`.
    megabytes : float
        Peak memory of the process until the fit was done.
    rigid : float
        Worst rigid row of the certificate.
    rms, coverage : float
        Distance to the target over the tile edge; share of the target that is covered.
    note : str
        What needs to be read.
    """

    problem: str
    solver: str
    end: str = ""
    tiles: int = 0
    steps: int = 0
    fit: float = 0.0
    solve: float = 0.0
    parts: dict[str, float] = field(default_factory=dict)
    megabytes: float = 0.0
    rigid: float | None = None
    rms: float | None = None
    coverage: float | None = None
    note: str = ""

    @property
    def has_converged(self) -> bool:
        """Did the solver reach its own end?"""
        return self.end in ("certified", "not certified")


def measure(name: str, target: str, options: dict[str, Any], solver: str, max_seconds: float | None) -> Measurement:
    """Fit once, or as often as it takes to trust the clock."""
    row = Measurement(name, solver)
    if max_seconds is not None:
        options = {**options, "max_seconds": max_seconds}
    if solver != OURS:
        # a limit of steps that is asked for keeps the fit from going on in stages: the peer's own solve is measured
        options = {**options, "solver": solver, "max_steps": default_steps(solver)}
    kirisurf.fit("hypar", cells=(1, 1), **({"solver": solver, "max_steps": 3} if solver != OURS else {}))
    watch = Stopwatch()
    watch.start()
    try:
        design = _fastest(row, watch, target, options)
    finally:
        watch.stop()
    row.megabytes = _peak_megabytes()
    row.tiles, row.steps = design.tessellation.n_tiles, max(0, len(design.result.fit.history) - 1)
    row.note = f"not measured: {', '.join(watch.missing)}" if watch.missing else ""
    _judge(row, design)
    return row


def _fastest(row: Measurement, watch: Stopwatch, target: str, options: dict[str, Any]) -> Design:
    row.solve = float("inf")
    for _ in range(REPEATS):
        watch.reset()
        design = kirisurf.fit(target, **options)
        seconds = design.result.seconds
        if seconds["solve"] < row.solve:
            row.solve, row.fit = seconds["solve"], sum(seconds.values())
            row.parts = {part: spent for part, spent in watch.seconds.items() if part != "rest"}
            row.parts["rest"] = row.solve - sum(row.parts.values())
        if seconds["solve"] > QUICK:
            break
    return design


def _judge(row: Measurement, design: Design) -> None:
    converged = design.status is Status.CONVERGED
    row.end = design.status.name.replace("_", " ").lower()
    try:
        certificate = design.certificate
    except kirisurf.KirisurfError as problem:
        row.note = f"no certificate: {problem}"
        return
    rows = certificate.rows
    rigid = [rows[name] for name in RIGID if rows[name] is not None]
    row.rigid = float(max(rigid)) if rigid else None
    row.rms, row.coverage = rows["distance_rms"], rows["coverage"]
    if converged:
        row.end = "certified" if certificate.passed else "not certified"
        row.note = row.note or " ".join(certificate.failures[:1])


def _peak_megabytes() -> float:
    """Peak of resident memory of this program; getrusage also counts what its parent held at the fork."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
        return next(float(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM:"))
    except (OSError, StopIteration):
        unit = 2**20 if sys.platform == "darwin" else 2**10
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def main(words: list[str]) -> int:
    """Measure what the first word describes, and write the row to the file that the second names."""
    wanted, path = json.loads(words[0]), Path(words[1])
    try:
        row = measure(**wanted)
    except (kirisurf.KirisurfError, MemoryError) as problem:
        row = Measurement(wanted["name"], wanted["solver"], "refused", note=str(problem) or type(problem).__name__)
    path.write_text(json.dumps(asdict(row)), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
