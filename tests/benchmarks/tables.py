"""Measurements as Markdown: the table, and what follows from it."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tests.benchmarks.measuring import Measurement
from tests.benchmarks.problems import OURS, Problem
from tests.benchmarks.stopwatch import PARTS

COLUMNS = ("problem", "tiles", "solver", "end", "steps", "fit s", "solve s", *(f"{part} s" for part in PARTS))
COLUMNS += ("ratio", "MB", "worst rigid row", "rms", "coverage")
LEGEND = """\
*fit s*: reading, start, solve and contraction, as a user waits for them; *solve s*: the solve alone, of which
*evaluate* (residuals, derivatives, closest points), *assemble* (sums into matrices), *symbolic* and *factor* (our
factorization), *substitute* (solves with its factors), and the *rest*, which for a peer is its own linear algebra.
*ratio*: solve over symbolic and factor. *MB*: peak of the process. *worst rigid row* and *rms* (distance to the target)
are the certificate's, over the tile edge and in radians. Quick solves are the fastest of three. A peer is given one
solve at the full size, and must end within 1e-8 of complementarity; ours may end at its own last barrier."""
LEAST_GRID = 32


def header() -> list[str]:
    """The first two lines of the table."""
    return [_line(COLUMNS), _line(["---"] * len(COLUMNS))]


def line(row: Measurement) -> str:
    """One row of the table."""
    parts = [_seconds(row.parts[part]) if row.parts.get(part) else "–" for part in PARTS]
    ratio = factor_ratio(row)
    done = row.solve > 0
    return _line(
        [
            row.problem,
            str(row.tiles) if row.tiles else "–",
            row.solver,
            row.end,
            str(row.steps) if done else "–",
            _seconds(row.fit) if done else "–",
            _seconds(row.solve) if done else "–",
            *parts,
            "–" if ratio is None else f"{ratio:.2f}",
            f"{row.megabytes:.0f}" if row.megabytes else "–",
            "–" if row.rigid is None else f"{row.rigid:.0e}",
            "–" if row.rms is None else f"{row.rms:.2g}",
            "–" if row.coverage is None else f"{row.coverage:.3f}",
        ]
    )


def factor_ratio(row: Measurement) -> float | None:
    """Seconds of the solve over those of our own factorizations; None where there are none."""
    own = row.parts.get("symbolic", 0.0) + row.parts.get("factor", 0.0)
    return row.solve / own if own > 0 else None


def derived(problems: Sequence[Problem], rows: Sequence[Measurement]) -> list[str]:
    """What follows from the rows: growth with the number of tiles, ratios to peers, and what needs to be read."""
    return [*_growth(problems, rows), *_peers(rows), *_notes(rows)]


def exponent(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Slope of log(value) over log(size) by least squares.

    Examples
    --------
    >>> round(exponent([1, 10, 100], [2, 20, 200]), 6)
    1.0
    """
    x, y = [math.log(size) for size in sizes], [math.log(value) for value in values]
    middle_x, middle_y = sum(x) / len(x), sum(y) / len(y)
    over = sum((a - middle_x) ** 2 for a in x)
    return sum((a - middle_x) * (b - middle_y) for a, b in zip(x, y, strict=True)) / over


def _growth(problems: Sequence[Problem], rows: Sequence[Measurement]) -> list[str]:
    grids = {problem.name: problem.grid for problem in problems}
    lines = []
    for target in dict.fromkeys(problem.target for problem in problems):
        names = {problem.name for problem in problems if problem.target == target and problem.grid >= LEAST_GRID}
        found = [row for row in rows if row.solver == OURS and row.problem in names and row.has_converged]
        if len(found) < 2:
            continue
        tiles = [row.tiles for row in found]
        per_step = [row.solve / max(1, row.steps) for row in found]
        own = [row.parts.get("factor", 0.0) for row in found]
        factor = f", factorizations by {exponent(tiles, own):.2f}" if min(own) > 0 else ""
        lines.append(
            f"- {target}, {grids[found[0].problem]} to {grids[found[-1].problem]} tiles a side: the solve grows by the "
            f"power {exponent(tiles, [row.solve for row in found]):.2f} of the number of tiles, a step by "
            f"{exponent(tiles, per_step):.2f}{factor}, peak memory by "
            f"{exponent(tiles, [row.megabytes for row in found]):.2f}."
        )
    return lines


def _peers(rows: Sequence[Measurement]) -> list[str]:
    ours = {row.problem: row for row in rows if row.solver == OURS and row.has_converged}
    lines = []
    for row in rows:
        own = ours.get(row.problem)
        if row.solver == OURS or own is None or not row.solve > 0:
            continue
        least = "" if row.has_converged else "at least "
        end = "" if row.has_converged else f"; it ended with: {row.end}"
        lines.append(
            f"- {row.problem}: {row.solver} takes {least}{row.solve / own.solve:.1f} times as long as ours "
            f"({row.solve:.2f} s in {row.steps} steps against {own.solve:.2f} s in {own.steps}{end})."
        )
    return lines


def _notes(rows: Sequence[Measurement]) -> list[str]:
    return [f"- {row.problem}, {row.solver}: {row.note}" for row in rows if row.note]


def _seconds(value: float) -> str:
    return f"{value:.2f}" if value >= 0.1 else f"{value:.3f}"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(" ".join(cell.split()).replace("|", "/") for cell in cells) + " |"
