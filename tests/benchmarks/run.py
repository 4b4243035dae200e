"""Speed of the solver: ours and SciPy's on the same problems, in one run; prints a Markdown table.

    make bench                       all of it, some minutes
    python tests/benchmarks/run.py --sizes 8 16

Columns: steps; seconds of the solve, of it in factorizations and in solves with them; the ratio of the two;
peak memory of the process so far; the largest constraint row at the end.
"""

from __future__ import annotations

import argparse
import os
import platform
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import sample_surfaces
from kirisurf.formulation import Formulation, Weights
from kirisurf.scaling import unit_scale
from kirisurf.solvers.choice import default_steps, make_solver
from kirisurf.solvers.multifrontal import Cholesky
from kirisurf.solvers.outcome import Limits
from kirisurf.spec import FitSpec
from kirisurf.start import make_start


@dataclass
class Clock:
    """Seconds spent in wrapped functions."""

    seconds: float = 0.0
    restore: list[Callable[[], None]] = field(default_factory=list)

    def wrap(self, owner: Any, name: str) -> None:
        """Time every call of a method."""
        method = getattr(owner, name)

        def timed(*args: Any, **options: Any) -> Any:
            began = time.perf_counter()
            try:
                return method(*args, **options)
            finally:
                self.seconds += time.perf_counter() - began

        setattr(owner, name, timed)
        self.restore.append(lambda: setattr(owner, name, method))

    def stop(self) -> None:
        """Put the methods back."""
        for undo in self.restore:
            undo()


def measure(target: str, tiles: int, method: str) -> str:
    """Solve one problem and return its row of the table."""
    surface = sample_surfaces.load(target)
    start = make_start(surface, FitSpec(target=target, cells=(tiles // 2, tiles // 2)))
    frame, scaled = unit_scale(surface, start.tessellation, start.points)
    points = frame.into(start.points)
    made = Formulation(start.tessellation, points, scaled, Weights())
    solver = make_solver(method, Limits(max_steps=default_steps(method), max_seconds=300))
    clock = Clock()
    clock.wrap(Cholesky, "__init__")
    clock.wrap(Cholesky, "solve")
    began = time.perf_counter()
    try:
        outcome = solver.solve(made.problem_at(points), points, made.problem_at)
    finally:
        clock.stop()
    seconds = time.perf_counter() - began
    worst = max(made.problem_at(outcome.points).violations(outcome.points).values())
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    ratio = f"{seconds / clock.seconds:.2f}" if clock.seconds else "-"
    return (
        f"| {target} {tiles}x{tiles} | {method} | {len(outcome.history) - 1} | {seconds:.2f} | {clock.seconds:.2f} | "
        f"{ratio} | {memory:.0f} | {worst:.0e} | {outcome.status.name} |"
    )


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=[8, 16, 32, 64], help="tiles a side")
    parser.add_argument("--targets", nargs="+", default=["hypar", "peaks"])
    parser.add_argument("--peers", nargs="*", default=["slsqp"], help="SciPy's solvers, at 8x8 tiles only")
    chosen = parser.parse_args()
    lines = [
        f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, 1 thread, "
        f"Python {platform.python_version()}",
        "",
        "| problem | solver | steps | seconds | factorizations | ratio | MB | worst row | end |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    sys.stdout.write("\n".join(lines) + "\n")
    for target in chosen.targets:
        for tiles in chosen.sizes:
            for method in ["newton", *(chosen.peers if tiles == 8 else [])]:
                sys.stdout.write(measure(target, tiles, method) + "\n")
                sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
