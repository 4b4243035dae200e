"""Compute the README's tables of results again and write them into it: `python docs/results/make.py`.

The published designs are read where they lie, in shared/reference beside the project; nothing of them is copied.
It takes about a minute.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

import kirisurf
from analysis.certificate import Certificate, certify
from analysis.sheet import coincident
from kirisurf.formats import read_polygons, read_surface

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT.parent / "shared" / "reference" / "choi2019"
README = ROOT / "README.md"
START, END = "<!-- results -->", "<!-- /results -->"
RIGID = ("length", "angle", "planarity", "isometry")
WELD = 1e-3
SEVEN = ("hypar", "paraboloid", "peaks", "peaks2", "mexicanhat", "mexicanhat2", "sphere")
SMOOTH = ("hypar", "paraboloid", "peaks")


class Published(NamedTuple):
    """A published design: file name without its end, target, unit cells."""

    name: str
    target: str
    cells: tuple[int, int]

    def certificate(self) -> Certificate:
        """Certify the published files against the published target mesh.

        Copies of a contracted point coincide only roughly there: those closer than `WELD` tile edges are one.
        """
        deployed, tiles = read_polygons(REFERENCE / "3d" / f"{self.name}_deployed.obj")
        contracted, _ = read_polygons(REFERENCE / "3d" / f"{self.name}_contracted.obj")
        target = read_surface(REFERENCE / "targets" / f"{self.target}.obj")
        scale = certify(deployed, contracted, tiles).edge_length
        return certify(deployed, contracted, tiles, target, coincident(contracted, WELD * scale))


@cache
def design(target: str, cells: tuple[int, int], closeness: str = "best") -> kirisurf.Design:
    """Design a sheet for a published target: its published mesh, or the sample surface of that name.

    The published sphere is closed and has no cut pattern of this kind: there, and for exact designs, which lie
    on the smooth surface, the sample is the target.
    """
    mesh = REFERENCE / "targets" / f"{target}.obj"
    chosen = target if target == "sphere" or closeness == "exact" else mesh
    return kirisurf.fit(chosen, cells=cells, closeness=closeness)


def published() -> list[Published]:
    """Return the published quad designs on surfaces."""
    found = []
    for path in sorted((REFERENCE / "3d").glob("quad_*_deployed.obj")):
        name = path.name.removesuffix("_deployed.obj")
        target, columns, rows = re.fullmatch(r"quad_(\w+?)_w(\d+)_h(\d+)_.*", name).groups()
        found.append(Published(name, target, (int(columns), int(rows))))
    return found


def beside_published() -> Iterable[Sequence[str]]:
    """Rows of the table of published designs and ours at the same target and cells: theirs / ours."""
    yield (
        "target, cells",
        "published as",
        "rigid",
        "smallest edge",
        "distance",
        "farthest",
        "coverage",
        "ours",
        "seconds",
    )
    for each in published():
        theirs, ours = each.certificate().rows, design(each.target, each.cells)
        rows = ours.certificate.rows
        plain = ("min_edge", "distance_rms", "distance_max", "coverage")
        yield (
            f"{each.target} {each.cells[0]}×{each.cells[1]}",
            f"`{each.name.split('_', 4)[4]}`",
            f"{_small(_worst(theirs))} / {_small(_worst(rows))}",
            *(f"{_plain(theirs[row])} / {_plain(rows[row])}" for row in plain),
            _status(ours),
            _seconds(ours),
        )


def at_four_by_four() -> Iterable[Sequence[str]]:
    """Rows of the table of the seven published targets at 4 x 4 unit cells, by both kinds of closeness."""
    yield (
        "target",
        "closeness",
        "ended",
        "rigid",
        "distance",
        "farthest",
        "off smooth",
        "smallest edge",
        "coverage",
        "reach",
        "K off by",
        "steps",
        "seconds",
    )
    for target, closeness in [(target, "best") for target in SEVEN] + [(target, "exact") for target in SMOOTH]:
        ours = design(target, (4, 4), closeness)
        rows, smooth = ours.certificate.rows, ours.certificate.extra.get("distance_smooth_max")
        yield (
            target,
            closeness,
            _status(ours),
            _small(_worst(rows)),
            _plain(rows["distance_rms"]),
            _plain(rows["distance_max"]),
            "–" if smooth is None else _plain(smooth),
            _plain(rows["min_edge"]),
            _plain(rows["coverage"]),
            _plain(rows["reach_max"]),
            _percent(ours.measures.numbers["gaussian_curvature_difference_relative"]),
            str(len(ours.result.fit.history)),
            _seconds(ours),
        )


def _worst(rows: dict) -> float:
    return max(np.inf if rows[name] is None else rows[name] for name in RIGID)


def _status(ours: kirisurf.Design) -> str:
    return "certified" if ours.status is kirisurf.Status.CONVERGED and ours.certificate.passed else ours.status.name


def _seconds(ours: kirisurf.Design) -> str:
    return f"{sum(ours.result.seconds.values()):.2f}"


def _small(value: float) -> str:
    return f"{value:.0e}".replace("e-0", "e-")


def _plain(value: float | None) -> str:
    if value is None:
        return "–"
    return _small(value) if value < 0.0005 else f"{value:.3f}"


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if share < 0.1 else f"{100 * share:.0f} %"


def _table(rows: Iterable[Sequence[str]]) -> str:
    head, *body = rows
    lines = [head, ["---"] * len(head), *body]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def main() -> None:
    """Write the tables into the README."""
    if not REFERENCE.is_dir():
        raise SystemExit("expected the published designs in ../shared/reference/choi2019 beside the project, got none")
    text = README.read_text(encoding="utf-8")
    before, rest = text.split(START)
    after = rest.split(END)[1]
    # The solver's first call pays for what it imports: not part of anybody's time.
    kirisurf.fit("hypar", cells=(2, 2))
    edges = [each.certificate().rows["min_edge"] for each in published()]
    results = RESULTS.format(
        beside=_table(beside_published()),
        four=_table(at_four_by_four()),
        count=len(edges),
        collapsed=sum(edge < 0.01 for edge in edges),
    )
    README.write_text(f"{before}{START}\n{results}{END}{after}", encoding="utf-8")


RESULTS = """\
**Beside the published designs.** Every quadrilateral design on a surface that the paper's authors published, certified
from its own files, and ours (`best`) for the same target mesh and number of unit cells: *theirs / ours*. *Rigid* is the
largest residual of length, angle, planarity and isometry; *distance* (root mean square) and *farthest* are from the
deployed vertices to the target mesh. Lengths are in tile edges, angles in radians. Theirs ask for every vertex on the
surface, and lie nearer to it; ours are sheets of rigid tiles to rounding, and keep their edges: {collapsed} of the
{count} published ones have an edge below 1 % of the median. The sphere is closed: ours is for a cap of it.

{beside}

**The published targets at 4×4 unit cells**, that is 8×8 tiles: `best` on the published meshes (sphere: our cap), and
`exact`, which puts every vertex on the smooth surface, on our samples of them (*off smooth*: the largest distance to
it). *Reach* is the largest distance from the target to the sheet. *K off by* is the median difference of the holes'
Gaussian curvature to the target's, over the median of the target's: 64 tiles do not resolve the curvature of peaks and
hats, and with every vertex on the surface peaks is off as much.

{four}

Seconds are for reading, start, solve and contraction, on a Linux machine with two cores; measuring and drawing the
pictures takes longer. `.venv/bin/python docs/results/make.py` computes both tables again, where the published files
lie in `../shared/reference/choi2019`, and `.venv/bin/python docs/pictures/make.py` draws the pictures.
"""

if __name__ == "__main__":
    main()
