"""Input of CalculiX (its solver `ccx`), in the keyword format of Abaqus: a sheet of shells and how it is driven."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from kirisurf.elastic.sheet_mesh import SheetMesh
from kirisurf.errors import ParameterError

_DIGITS = 13  # the solver reads 20 characters of a number, and a sign, a point and an exponent take seven
_PER_LINE = 8  # numbers of a set on a line; the format allows 16


@dataclass(frozen=True)
class Material:
    """Rubber-like material, neo-Hookean: W = C10 (I1 - 3) + (J - 1)^2 / D1.

    At small strain it is linear elastic with Young's modulus and Poisson's ratio. Why not linear elastic throughout:
    ligaments are strained by tens of percent as a sheet opens, and a linear law in finite strain goes soft, and
    through itself, in compression.

    Attributes
    ----------
    young : float
        Force per squared length.
    poisson : float
        From 0 to less than 0.5.
    thickness : float
        Of the sheet, in the units of the points.

    Raises
    ------
    ParameterError
        Where a value is out of its range.
    """

    young: float
    poisson: float
    thickness: float

    def __post_init__(self) -> None:
        for name, value in (("young", self.young), ("thickness", self.thickness)):
            if not (np.isfinite(value) and value > 0):
                raise ParameterError(f"{name}: expected a number above 0, got {value:.6g}")
        if not 0 <= self.poisson < 0.5:
            raise ParameterError(f"poisson: expected a number from 0 to less than 0.5, got {self.poisson:.6g}")

    @property
    def constants(self) -> tuple[float, float]:
        """C10 and D1."""
        shear = self.young / (2 * (1 + self.poisson))
        bulk = self.young / (3 * (1 - 2 * self.poisson))
        return float(shear / 2), float(2 / bulk)


@dataclass(frozen=True, eq=False)
class Drive:
    """Nodes that are moved, step by step.

    Attributes
    ----------
    nodes : (k,)
    shifts : (s, k, 3), units
        From the flat sheet, at the end of every step; not a number where a direction is free.
    """

    nodes: Int[np.ndarray, " k"]
    shifts: Float[np.ndarray, "s k 3"]


def calculix_text(
    mesh: SheetMesh, material: Material, drive: Drive, about: Sequence[str] = (), increments: int = 4
) -> str:
    """Return the input file.

    Sets: elements `SHEET`, and `TILE_k` of every tile; nodes `VERTICES` (corners of tiles, those of the tessellation
    in its order, which are the nodes 1, 2, ...), `DRIVEN`, and `LIGAMENT_k` of every ligament, from hinge to tip.

    Parameters
    ----------
    mesh : SheetMesh
    material : Material
    drive : Drive
        At least one step.
    about : sequence of str
        Comment lines for the head of the file.
    increments : int
        Into which a step is divided at first; the solver takes smaller ones where it must.
    """
    lines = ["** " + line for line in about]
    lines += ["*NODE, NSET=ALL"]
    lines += [f"{k}, {_number(x)}, {_number(y)}, 0." for k, (x, y) in enumerate(mesh.nodes.tolist(), 1)]
    lines += ["*ELEMENT, TYPE=S6, ELSET=SHEET"]
    lines += [f"{k}, " + ", ".join(map(str, row)) for k, row in enumerate((mesh.triangles + 1).tolist(), 1)]
    for tile in range(int(mesh.tiles.max()) + 1):
        lines += _set("ELSET", f"TILE_{tile}", np.flatnonzero(mesh.tiles == tile))
    lines += _set("NSET", "VERTICES", mesh.vertices)
    lines += _set("NSET", "DRIVEN", drive.nodes)
    for k, nodes in enumerate(mesh.ligaments):
        lines += _set("NSET", f"LIGAMENT_{k}", nodes)
    first, second = material.constants
    lines += [
        f"** neo-Hookean; at small strain Young's modulus {material.young:.9g}, Poisson's ratio {material.poisson:.9g}",
        "*MATERIAL, NAME=SHEET_MATERIAL",
        "*HYPERELASTIC, NEO HOOKE",
        f"{_number(first)}, {_number(second)}",
        "*SHELL SECTION, ELSET=SHEET, MATERIAL=SHEET_MATERIAL",
        _number(material.thickness),
    ]
    for shifts in drive.shifts:
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", f"{_number(1 / increments)}, 1., 1e-6, 1.", "*BOUNDARY"]
        lines += _held(drive.nodes, shifts)
        lines += [
            "*NODE FILE, OUTPUT=2D",
            "U",
            "*EL FILE, OUTPUT=2D",
            "S, E",
            "*NODE PRINT, NSET=DRIVEN",
            "U, RF",
            # no frequency here: the solver takes the last one for all prints, and forces are wanted at every increment
            "*NODE PRINT, NSET=VERTICES",
            "U",
            "*END STEP",
        ]
    return "\n".join(lines) + "\n"


def _held(nodes: np.ndarray, shifts: np.ndarray) -> Iterable[str]:
    for node, shift in zip((nodes + 1).tolist(), shifts.tolist(), strict=True):
        for axis, value in enumerate(shift, 1):
            if np.isfinite(value):
                yield f"{node}, {axis}, {axis}, {_number(value)}"


def _number(value: float) -> str:
    return f"{value:.{_DIGITS}g}"


def _set(kind: str, name: str, numbers: np.ndarray) -> list[str]:
    found = (np.asarray(numbers) + 1).tolist()
    rows = [", ".join(map(str, found[k : k + _PER_LINE])) + "," for k in range(0, len(found), _PER_LINE)]
    return [f"*{kind}, {kind}={name}", *rows]
