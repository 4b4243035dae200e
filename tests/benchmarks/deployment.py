"""States in equilibrium per second on the way from flat to deployed: a Markdown table on standard output and in a file.

    python tests/benchmarks/deployment.py               20x20 and 40x40 tiles, two planar sheets and hypar, every drive
    python tests/benchmarks/deployment.py --grids 8 --drives free --steps 10

A sheet is followed alone, without verdict, minima and collisions; in space the way of rigid tiles, which the others
follow, is the row 'free' with lambda = 0. Run it beside nothing else.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))

import kirisurf  # noqa: E402
from kirisurf.deployment import Path as Way  # noqa: E402
from kirisurf.deployment.drive import DRIVES, driven_vertices  # noqa: E402
from kirisurf.deployment.following import (  # noqa: E402
    follow_free_planar,
    follow_held,
    follow_rigid,
    follow_supported,
)
from kirisurf.deployment.guide import Guide  # noqa: E402
from kirisurf.deployment.springs import energy_of  # noqa: E402
from kirisurf.design import Design  # noqa: E402
from kirisurf.formats.atomic import write_text  # noqa: E402
from kirisurf.one_thread import on_one_thread  # noqa: E402

TARGETS = {
    "disc": ("circle", "free"),
    "square-to-disc": ("circle", "rectangle:1"),
    "hypar": ("hypar", "free"),
}
TORSION = 1e-4
COLUMNS = ("sheet", "tiles", "drive", "lambda", "states", "s", "states/s", "Newton steps", "worst residual", "end")


@dataclass(frozen=True)
class Timed:
    """One path with its time."""

    sheet: str
    tiles: int
    drive: str
    torsion: float
    seconds: float
    way: Way

    def line(self) -> str:
        """One row of the table."""
        states, way = len(self.way.fractions), self.way
        cells = [self.sheet, self.tiles, self.drive, f"{self.torsion:g}", states, f"{self.seconds:.2f}"]
        cells += [f"{states / self.seconds:.1f}", int(way.steps.sum()), f"{way.residuals.max():.0e}", way.status.name]
        return _row(cells)


def header() -> list[str]:
    """The first two lines of the table."""
    return [_row(COLUMNS), _row(["---"] * len(COLUMNS))]


@on_one_thread
def measured(sheet: str, design: Design, drive: str, torsion: float, steps: int) -> Timed:
    """Follow a design and take the time, what is done once for a sheet included."""
    tessellation, flat, points = design.tessellation, design.contracted_points, design.deployed_points
    is_planar = sheet != "hypar"
    points = points[:, :2] if is_planar else points
    fractions = np.linspace(0.0, 1.0, steps + 1)
    still = None
    if not is_planar and (torsion or drive != "free"):
        plain, guide = energy_of(tessellation, flat, 0.0, 3), Guide(tessellation, flat, points)
        still = follow_rigid(plain, guide, fractions)
    began = time.perf_counter()
    energy, guide = energy_of(tessellation, flat, torsion, points.shape[1]), Guide(tessellation, flat, points)
    if drive != "free":
        places = guide.places(fractions) if still is None else still.points
        way = follow_held(energy, guide, driven_vertices(tessellation, drive), fractions, places, drive=drive)
    elif still is not None:
        way = follow_supported(energy, guide, still)
    elif is_planar:
        way = follow_free_planar(energy, guide, fractions)
    else:
        way = follow_rigid(energy, guide, fractions)
    return Timed(sheet, tessellation.n_tiles, drive, torsion, time.perf_counter() - began, way)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--grids", type=int, nargs="+", default=[20, 40], help="tiles along a side, even")
    parser.add_argument("--sheets", nargs="+", choices=list(TARGETS), default=list(TARGETS))
    parser.add_argument("--drives", nargs="+", choices=DRIVES, default=list(DRIVES))
    parser.add_argument("--lambdas", type=float, nargs="+", default=[0.0, TORSION])
    parser.add_argument("--steps", type=int, default=50)
    parser.add_argument("-o", "--output", type=Path, help="write the table here too")
    asked = parser.parse_args(argv)
    lines = header()
    print("\n".join(lines), flush=True)
    for grid in asked.grids:
        for sheet in asked.sheets:
            target, contracted = TARGETS[sheet]
            design = kirisurf.fit(target, cells=(grid // 2, grid // 2), contracted=contracted)
            for drive in asked.drives:
                for torsion in asked.lambdas:
                    lines.append(measured(sheet, design, drive, torsion, asked.steps).line())
                    print(lines[-1], flush=True)
    if asked.output is not None:
        write_text(asked.output, "\n".join(lines) + "\n")
    return 0


def _row(cells: Sequence[object]) -> str:
    return f"| {' | '.join(map(str, cells))} |"


if __name__ == "__main__":
    sys.exit(main())
