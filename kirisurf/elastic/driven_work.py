"""What CalculiX answers: the work done on the driven nodes, which is the elastic energy of the sheet.

The solver's own sum of internal energy is of no use here: version 2.20 adds, at every increment of a step with large
displacements, half of the whole stress times the whole strain, so that it grows with the number of increments.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.errors import UnreadableError

_STEP_END = 1e-6  # of a step: times are printed with seven digits
_HEAD = re.compile(r"^ *(displacements|forces) \(\w+,\w+,\w+\) for set (\w+) and time +([-+.\dE]+) *$")
_Rows = list[list[float]]


@dataclass(frozen=True, eq=False)
class DrivenWork:
    """Forces and work along a way.

    Attributes
    ----------
    times : (k,)
        Ends of increments; a step lasts 1.
    shifts, forces : (k, n, 3)
        Displacements of the driven nodes, and the forces that hold them there.
    work : (k,)
        Integral of force by displacement from the flat sheet on, by the trapezoid rule.
    vertices : (s, v, 3)
        Displacements of the vertices at the ends of the steps.
    """

    times: Float[np.ndarray, " k"]
    shifts: Float[np.ndarray, "k n 3"]
    forces: Float[np.ndarray, "k n 3"]
    work: Float[np.ndarray, " k"]
    vertices: Float[np.ndarray, "s v 3"]

    def at(self, time: float) -> float:
        """Return the work at a time, interpolated between increments."""
        return float(np.interp(time, np.r_[0.0, self.times], np.r_[0.0, self.work]))


def read_driven_work(path: str | os.PathLike[str]) -> DrivenWork:
    """Read the table file (`.dat`) that CalculiX writes for an exported sheet.

    Raises
    ------
    UnreadableError
        Where the file is missing, or holds no tables of driven nodes.
    """
    tables: dict[tuple[str, str], list[_Rows]] = {}
    times: dict[str, list[float]] = {"DRIVEN": [], "VERTICES": []}
    rows: _Rows = []
    try:
        with open(path, encoding="ascii", errors="replace") as lines:
            for line in lines:
                head = _HEAD.match(line)
                if head:
                    kind, name, time = head.groups()
                    rows = []
                    tables.setdefault((kind, name), []).append(rows)
                    if kind == "displacements" and name in times:
                        times[name].append(float(time))
                elif line.strip():
                    rows.append([float(x) for x in line.split()[1:]])
        shifts, forces, vertices = (
            np.array(tables.get(key, []), float)
            for key in (("displacements", "DRIVEN"), ("forces", "DRIVEN"), ("displacements", "VERTICES"))
        )
    except (OSError, ValueError) as problem:
        raise UnreadableError(f"{path}: expected a table file of CalculiX, got {problem}") from None
    if not times["DRIVEN"] or shifts.shape != forces.shape or shifts.ndim != 3:
        raise UnreadableError(f"{path}: expected displacements and forces of the set DRIVEN, got none, or not as many")
    path_shifts = np.concatenate([np.zeros_like(shifts[:1]), shifts])
    path_forces = np.concatenate([np.zeros_like(forces[:1]), forces])
    steps = 0.5 * (path_forces[1:] + path_forces[:-1]) * np.diff(path_shifts, axis=0)
    return DrivenWork(
        frozen(np.array(times["DRIVEN"])),
        frozen(shifts),
        frozen(forces),
        frozen(np.cumsum(steps.sum(axis=(1, 2)))),
        frozen(vertices[_ends(times["VERTICES"])] if vertices.ndim == 3 else np.zeros((0, 0, 3))),
    )


def _ends(times: list[float]) -> np.ndarray:
    """Rows (s,) of the tables at the ends of steps, which last 1."""
    found = np.array(times)
    return np.flatnonzero(np.abs(found - found.round()) <= _STEP_END * np.maximum(found, 1.0))
