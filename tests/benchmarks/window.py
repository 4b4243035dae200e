"""Times of the workbench as its user feels them: a Markdown table on standard output and in a file.

    python tests/benchmarks/window.py                       the sizes of the README, about two minutes
    python tests/benchmarks/window.py --grids 16 --target peaks

Every size is a process of its own with a real window; where there is no display, `xvfb-run` gives one if it is
installed. Needs the extra kirisurf[desktop].
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
REPEATS = 5
FRAMES = 30
PATIENCE = 300.0
COLUMNS = {
    "window": "first window",
    "first fit": "first fit",
    "bound": "bound",
    "bound colored": "colored",
    "opening": "opening",
    "opening colored": "colored",
    "pattern": "pattern",
    "pattern colored": "colored",
    "frame": "turning, ms a frame",
}


def measure(target: str, grid: int, began: float) -> dict[str, float]:
    """Return seconds (frame: milliseconds) on one window; the median of several changes of an option.

    Parameters
    ----------
    target : str
    grid : int
        Quadrilateral tiles along a side.
    began : float
        When the process was asked for, by `time.time`.
    """
    from viewers.workbench.desktop.show import application, prepare
    from viewers.workbench.desktop.window import Workbench
    from viewers.workbench.opening import open_any
    from viewers.workbench.pipeline import Stage
    from viewers.workbench.session import Session

    engine = prepare()
    state, results = open_any(target, cells=(grid // 2, grid // 2))
    app = application()
    bench = Workbench(Session(state, results, engine), "benchmark")
    bench.window.show()
    found: dict[str, float] = {}
    half = grid // 2

    def wait(done: Callable[[], bool]) -> float:
        """Seconds until something is so, and on the screen."""
        start = time.perf_counter()
        while not done():
            if time.perf_counter() - start > PATIENCE:
                raise TimeoutError(f"no end within {PATIENCE:g} s: {bench.status.text()}")
            app.processEvents()
            time.sleep(0.001)
            if problem := bench.session.results.problem:
                raise RuntimeError(problem)
        painted()
        return time.perf_counter() - start

    def painted() -> None:
        if bench._is_behind:
            bench.refresh()
        bench.canvas.widget.repaint()

    def is_seen() -> bool:
        return is_colored() or bench.session.results.running is Stage.HOLES

    def is_colored() -> bool:
        return bench.session.results.is_current

    def is_done() -> bool:
        return bench.session.results.running is None

    def change(name: str, values: list[Any]) -> tuple[float, float]:
        """Median seconds until the new sheet is seen, and until it is colored and measured."""
        seen, colored = [], []
        for value in values:
            start = time.perf_counter()
            bench.change(name, value)
            wait(is_seen)
            seen.append(time.perf_counter() - start)
            wait(is_colored)
            colored.append(time.perf_counter() - start)
            wait(is_done)
        return statistics.median(seen), statistics.median(colored)

    try:
        app.processEvents()
        painted()
        found["window"] = time.time() - began
        bench.fit()
        wait(is_colored)
        found["first fit"] = time.time() - began
        wait(is_done)
        for key, name, values in (
            ("bound", "min_angle", [4.0 + 0.5 * k for k in range(REPEATS)]),
            ("opening", "opening", [40.0 + 2 * k for k in range(REPEATS)]),
            ("pattern", "cells", [(side, side) for side in (half + 1, half - 1, half + 1, half)]),
        ):
            found[key], found[f"{key} colored"] = change(name, values)
        frames = []
        for _ in range(FRAMES):
            bench.canvas.plotter.renderers[1].camera.Azimuth(3.0)
            start = time.perf_counter()
            bench.canvas.plotter.render_window.Render()
            frames.append(time.perf_counter() - start)
        found["frame"] = 1000 * statistics.median(frames)
    finally:
        bench.window.close()
        app.processEvents()
    return found


def in_a_process(target: str, grid: int) -> dict[str, float]:
    """Measure in a process of its own, under a virtual display where there is no other.

    Raises
    ------
    RuntimeError
        Where it ended without an answer; with its last line.
    """
    command = [sys.executable, "-m", "tests.benchmarks.window", "--measure", target, str(grid), str(time.time())]
    if not os.environ.get("DISPLAY") and shutil.which("xvfb-run"):
        command = ["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24", *command]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=4 * PATIENCE, check=False)
    lines = ended.stdout.strip().splitlines()
    if ended.returncode or not lines:
        said = ended.stderr.strip().splitlines() or ["nothing"]
        raise RuntimeError(f"code {ended.returncode}: {said[-1]}")
    answer: dict[str, float] = json.loads(lines[-1])
    return answer


def line(name: str, row: dict[str, float]) -> str:
    """One row of the table."""
    cells = [f"{row[key]:.1f}" if key == "frame" else f"{row[key]:.2f}" for key in COLUMNS]
    return "| " + " | ".join([name, *cells]) + " |"


def header() -> list[str]:
    """The first two lines of the table."""
    titles = ["tiles", *COLUMNS.values()]
    return ["| " + " | ".join(titles) + " |", "|" + " --- |" * len(titles)]


def main(words: list[str] | None = None) -> int:
    """Measure, print and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--grids", nargs="+", type=int, default=[8, 16, 32, 64], metavar="N", help="tiles along a side")
    parser.add_argument("--target", default="hypar", help="default: hypar")
    parser.add_argument("--measure", nargs=3, metavar=("TARGET", "GRID", "BEGAN"), help=argparse.SUPPRESS)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "build" / "bench-window.md", metavar="FILE")
    chosen = parser.parse_args(words)
    if chosen.measure:
        target, grid, began = chosen.measure
        print(json.dumps(measure(target, int(grid), float(began))))
        return 0
    lines = header()
    print(*lines, sep="\n", flush=True)
    for grid in chosen.grids:
        try:
            row = line(f"{chosen.target} {grid}x{grid}", in_a_process(chosen.target, grid))
        except (RuntimeError, subprocess.TimeoutExpired) as problem:
            row = f"| {chosen.target} {grid}x{grid} | {' | '.join('–' for _ in COLUMNS)} |\n\n{problem}\n"
        lines.append(row)
        print(row, flush=True)
    chosen.output.parent.mkdir(parents=True, exist_ok=True)
    chosen.output.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
