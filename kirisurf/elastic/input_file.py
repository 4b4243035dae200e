"""A run as input of a finite element program: the flat sheet, cut and hinged as it is made, pulled open at its rim."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from kirisurf.arrays import checked, frozen
from kirisurf.deployment.drive import driven_vertices
from kirisurf.elastic.calculix import Drive, Material, calculix_text
from kirisurf.elastic.sheet_mesh import SheetMesh, sheet_mesh
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.formats.atomic import write_text
from kirisurf.judging import deployment
from kirisurf.runs import Run
from kirisurf.tessellation import Tessellation

DRIVES = ("rim", "corners")
STEPS = 10
"""Steps from flat to open unless asked: a rim that turns by 90 degrees is then off its arc by 1e-3 of it."""

_CONGRUENT = 1e-6  # over the sheet's size: how far the first state may be from the flat sheet


def export_elastic(
    run: Run,
    path: str | os.PathLike[str],
    *,
    thickness: float,
    young: float = 1.0,
    poisson: float = 0.3,
    hinge_width: float | None = None,
    drive: str | Sequence[int] = "rim",
    states: Sequence[ArrayLike] | np.ndarray | None = None,
    steps: int = STEPS,
    refinement: int = 4,
    units: str | None = None,
) -> Path:
    """Write the input of CalculiX for a run: `ccx -i NAME` on `NAME.inp` computes the opening.

    The flat sheet is meshed with shell elements, its slits cut but for their ligaments (:mod:`kirisurf.elastic`),
    and the driven vertices are moved from where they lie flat to where they lie deployed.

    Parameters
    ----------
    run : Run
    path : path
        Ends in .inp; replaced as a whole, or left alone where writing fails.
    thickness : float, units
        Of the sheet.
    young : float
        Young's modulus. With 1, forces come out over it, in squared units of length; with lengths in mm and
        megapascals, forces come in newtons and energies in millijoules.
    poisson : float
        From 0 to less than 0.5.
    hinge_width : float, units, optional
        Length of the ligaments along the slits; by default that of the run.
    drive : 'rim', 'corners' or sequence of int
        Which vertices are moved: the outer ones, four of them, the farthest out along the diagonals, or these numbers.
    states : (k, n, 3) or a sequence of states, units, optional
        The way, from the flat sheet to the deployed one: the driven vertices go through these, for example the points
        of a path of :func:`kirisurf.deployment.deploy_run`. By default every tile turns evenly, which is no mechanism
        but near one where there is one.
    steps : int
        Number of steps of the default way.
    refinement : int
        Number of elements across a ligament.
    units : str, optional
        Unit of length, for the comments; by default that of the run.

    Raises
    ------
    ParameterError
        Where the name does not end in .inp, or a value is out of its range.
    UnusableError
        Where a tile cannot be meshed, or the states are not of this sheet.
    OutputError
        Where the file cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() != ".inp":
        raise ParameterError(f"{path}: expected a name that ends in .inp, got {path.suffix or 'no suffix'}")
    if states is None:
        if not 1 <= steps <= 1000:
            raise ParameterError(f"steps: expected a number from 1 to 1000, got {steps}")
        shares = np.linspace(0.0, 1.0, steps + 1).tolist()
        states = [frame.points for frame in deployment(run.tessellation, run.contracted, run.deployed, shares)]
    width = float(run.result["hinge_width"]) if hinge_width is None else hinge_width
    about = [f"kirisurf: {run.result['target']['name']}, {run.spec.tessellation}, {run.tessellation.n_tiles} tiles"]
    text = elastic_text(
        run.tessellation, run.contracted, states, Material(young, poisson, thickness), width, drive, refinement,
        units or run.spec.units, about,
    )  # fmt: skip
    write_text(path, text)
    return path


def elastic_text(
    tessellation: Tessellation,
    contracted: Float[np.ndarray, "n 2"],
    states: Sequence[ArrayLike] | np.ndarray,
    material: Material,
    hinge_width: float | None = None,
    drive: str | Sequence[int] = "rim",
    refinement: int = 4,
    units: str | None = None,
    about: Sequence[str] = (),
) -> str:
    """Return the input of CalculiX for a sheet and the way that its driven vertices take.

    Parameters
    ----------
    tessellation : Tessellation
    contracted : (n, 2), units
    states : (k, n, 2) or (k, n, 3), or a sequence of states, units
        The first is the flat sheet, wherever it lies. Directions out of a plane are held at 0 for (n, 2).
    material : Material
    hinge_width, drive, refinement
        As for :func:`export_elastic`.
    units : str, optional
        Unit of length.
    about : sequence of str
        Comment lines.

    Raises
    ------
    ParameterError, UnusableError
        As :func:`export_elastic`.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(1, 1, 1e-3)
    >>> flat, opened = pattern.contracted, pattern.deployed
    >>> text = elastic_text(pattern, flat, [flat, opened], Material(1.0, 0.3, 0.1))
    >>> text.count("*STEP"), text.count("*ELSET")
    (1, 4)
    """
    mesh = sheet_mesh(tessellation, contracted, hinge_width, refinement)
    way = placed_states(contracted, states)
    vertices = _driven(tessellation, drive)
    flat = np.pad(mesh.nodes[mesh.vertices], ((0, 0), (0, 1)))
    shifts = np.stack([state[vertices] - flat[vertices] for state in way])
    return calculix_text(
        mesh, material, Drive(mesh.vertices[vertices], shifts), [*about, *_said(mesh, material, units)]
    )


def _driven(tessellation: Tessellation, drive: str | Sequence[int]) -> np.ndarray:
    """Vertices (k,) that a drive moves, each once."""
    if isinstance(drive, str) and drive not in DRIVES:
        raise ParameterError(f"drive: expected one of {', '.join(DRIVES)}, or numbers of vertices, got {drive!r}")
    return np.flatnonzero(driven_vertices(tessellation, drive if isinstance(drive, str) else np.asarray(drive)))


def placed_states(
    contracted: Float[np.ndarray, "n 2"], states: Sequence[ArrayLike] | np.ndarray
) -> tuple[Float[np.ndarray, "n 3"], ...]:
    """Return all states but the first, moved by the one rigid motion that takes the first to the flat sheet.

    Raises
    ------
    UnusableError
        Where there are less than two, or the first is not the flat sheet.
    """
    n = len(contracted)
    if len(states) < 2:
        raise UnusableError(f"states: expected the flat sheet and at least one more, got {len(states)}")
    dimension = 2 if np.shape(states[0])[-1:] == (2,) else 3
    way = [np.pad(checked(state, "states", (n, dimension)), ((0, 0), (0, 3 - dimension))) for state in states]
    flat = np.pad(contracted - contracted.mean(axis=0), ((0, 0), (0, 1)))
    middle = way[0].mean(axis=0)
    turn, _ = Rotation.align_vectors(flat, way[0] - middle)
    first, *rest = (turn.apply(state - middle) for state in way)
    size = float(np.linalg.norm(np.ptp(flat, axis=0)))
    off = float(np.abs(first - flat).max())
    if off > _CONGRUENT * size:
        raise UnusableError(
            f"states: expected the flat sheet first, got one that is off by {off / size:.2g} of its size"
        )
    shift = np.append(contracted.mean(axis=0), 0.0)
    return tuple(frozen(state + shift) for state in rest)


def _said(mesh: SheetMesh, material: Material, units: str | None) -> list[str]:
    length = units or "the unit of length of the target"
    count = len(mesh.hinges)
    said = [
        "input of CalculiX: ccx -i NAME computes it (NAME.inp is this file), cgx or ParaView show NAME.frd",
        f"lengths in {length}; forces in the unit of Young's modulus times the square of that",
        f"sheet in the plane z = 0, thickness {material.thickness:.9g}; every slit is a cut without width, and its "
        "sides do not feel each other",
        f"{count} ligaments, {float(mesh.widths.min(initial=np.inf)):.6g} to {float(mesh.widths.max(initial=0)):.6g} "
        "wide" if count else "no ligaments",
        "nodes 1, 2, ... are the vertices of the run's files, in their order",
        "work of the nodes DRIVEN (forces by displacements, NAME.dat) is the elastic energy; do not use the",
        "internal energy (ELSE), which versions up to 2.20 at least add up wrongly where there are several increments",
    ]  # fmt: skip
    if mesh.bare:
        said.append(f"{mesh.bare} hinges have no ligament: their tiles share one node, and turn about it freely")
    return said
