"""Export of a run to cutting files and interchange formats, chosen by suffix."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from kirisurf.dxf import dxf_text
from kirisurf.elastic.input_file import export_elastic
from kirisurf.errors import ParameterError
from kirisurf.exporting_blocks import FRAMES, MOST_FRAMES, write_blocks, write_series
from kirisurf.fabrication import Fabrication, SheetPlace, cut_lines, solid_part
from kirisurf.field_units import described_file
from kirisurf.formats import write_obj, write_vtp
from kirisurf.formats.atomic import write_bytes, write_text
from kirisurf.formats.pieces import is_replaceable, pieces_folder
from kirisurf.formats.stl import stl_bytes
from kirisurf.formats.triangulation import triangulated
from kirisurf.runs import Run
from kirisurf.runs.table import curvature_csv
from kirisurf.svg import svg_text

STATES = ("contracted", "deployed")
CUTTING = (".svg", ".dxf")
BLOCKS, SERIES = ".vtm", ".pvd"
SHELLS = ".inp"
_LATER = (".pdf", ".step", ".stp", ".3mf", ".ply")


def export(
    run: Run,
    path: str | os.PathLike[str],
    state: str | None = None,
    hinge_width: float | None = None,
    units: str | None = None,
    making: Fabrication | None = None,
    frames: int = FRAMES,
) -> Path:
    """Write one file of a run; its suffix chooses the format.

    =======  ==============================================================
    .svg     cut pattern to scale, layers cut, hinge and outline
    .dxf     the same, layers CUT, HINGE and OUTLINE
    .obj     polygons of a state (contracted, unless `state` says deployed)
    .vtp     the same with every named field
    .vtm     tiles, holes, target and contracted tiles as named blocks, in a folder beside it
    .pvd     the sheet opening, frame by frame, in a folder beside it: interpolated, no mechanism
    .stl     triangles of a state, or with a thickness the sheet as a solid (binary, single precision)
    .inp     the sheet as elastic shells that are pulled open, for CalculiX (needs a thickness)
    .csv     curvature of every hole
    =======  ==============================================================

    Parameters
    ----------
    run : Run
    path : path
        Replaced as a whole, or left alone where writing fails.
    state : str, optional
        contracted (default) or deployed.
    hinge_width, units : optional
        Short for those of `making`.
    making : Fabrication, optional
        Scale, sheet, kerf and thickness of cutting files and solids.
    frames : int
        Of a time series, from closed to open.

    Raises
    ------
    ParameterError
        Where the suffix, the state, a length or the number of frames is wrong, or the pattern does not fit the sheet.
    OutputError
        Where the file cannot be written.
    """
    making = making or Fabrication()
    if hinge_width is not None:
        making = replace(making, hinge_width=hinge_width)
    if units is not None:
        making = replace(making, units=units)
    return export_with_remarks(run, path, state, making, frames).path


@dataclass(frozen=True)
class Exported:
    """A file that was written.

    Attributes
    ----------
    path : Path
    placement : SheetPlace or None
        Scale, turn and size of a cutting file or solid.
    warnings : tuple of str
        What is not as it was asked for.
    """

    path: Path
    placement: SheetPlace | None = None
    warnings: tuple[str, ...] = ()


def export_with_remarks(
    run: Run,
    path: str | os.PathLike[str],
    state: str | None = None,
    making: Fabrication | None = None,
    frames: int = FRAMES,
) -> Exported:
    """Write one file as :func:`export` does, and return what is to be said about it."""
    making = making or Fabrication()
    check_names([path], state, making, frames)
    written = _written(run, Path(path), state, making, frames)
    return written if run.result["certified"] else replace(written, warnings=(_uncertified(run), *written.warnings))


def _uncertified(run: Run) -> str:
    failures = run.result["certificate_beside"]["failures"]
    because = f": {failures[0]}" if failures else "."
    return f"The run is not certified, and what is cut from it may not close or open{because}"


def _written(run: Run, path: Path, state: str | None, making: Fabrication, frames: int) -> Exported:
    suffix = path.suffix.lower()
    if suffix in CUTTING:
        lines, placement = cut_lines(run, making)
        units = making.units or run.spec.units
        if suffix == ".dxf":
            write_text(path, dxf_text(lines, units))
        else:
            page = making.sheet.size if making.sheet is not None else None
            write_text(path, svg_text(lines, units, f"{run.result['target']['name']}: cut pattern", page))
        return Exported(path, placement, lines.warnings)
    if suffix == ".stl" and making.thickness is not None:
        part, placement = solid_part(run, making)
        write_bytes(path, stl_bytes(part.corners))
        return Exported(path, placement, part.warnings)
    if suffix == SHELLS:
        export_elastic(run, path, thickness=making.thickness or 0.0, hinge_width=making.hinge_width, units=making.units)
    elif suffix == SERIES:
        write_series(run, path, frames)
    elif suffix == BLOCKS:
        write_blocks(run, path)
    else:
        _WRITERS[suffix](run, path, state or STATES[0])
    return Exported(path)


def check_names(
    paths: Sequence[str | os.PathLike[str]],
    state: str | None,
    making: Fabrication | None = None,
    frames: int = FRAMES,
) -> None:
    """Check suffixes, state, number of frames and what goes with them before anything is read or written.

    Raises
    ------
    ParameterError
        Where one is unknown, or they do not go together.
    """
    making = making or Fabrication()
    if state is not None and state not in STATES:
        raise ParameterError(f"--state: expected one of {', '.join(STATES)}, got {state!r}")
    if not 2 <= frames <= MOST_FRAMES:
        raise ParameterError(f"--frames: expected a number from 2 to {MOST_FRAMES}, got {frames}")
    for path in paths:
        suffix = Path(path).suffix.lower()
        if suffix in _LATER:
            raise ParameterError(f"{path}: {suffix} is not available in this version: use {', '.join(SUFFIXES)}.")
        if suffix not in SUFFIXES:
            raise ParameterError(f"{path}: expected a suffix among {', '.join(SUFFIXES)}, got {suffix or 'none'}")
        is_solid = suffix == ".stl" and making.thickness is not None
        if suffix == SHELLS and making.thickness is None:
            raise ParameterError(f"{path}: expected --thickness with {suffix}, got none")
        if suffix in (BLOCKS, SERIES, SHELLS) and state is not None:
            raise ParameterError(f"{path}: expected no --state for {suffix}, which holds both, got {state}")
        if (suffix in CUTTING or is_solid) and state == "deployed":
            what = "solid" if is_solid else "cut pattern"
            raise ParameterError(f"{path}: expected --state contracted for a {what}, got deployed")
        if making.is_scaled and suffix != ".csv" and not (suffix in CUTTING or is_solid):
            raise ParameterError(
                f"{path}: expected --scale and --fit-sheet with .svg, .dxf and .stl with --thickness only, got {suffix}"
            )


def check_free(paths: Sequence[str | os.PathLike[str]], folder: str | os.PathLike[str], overwrite: bool) -> None:
    """Refuse to replace files that exist, and any of the files that belong to the run itself.

    Raises
    ------
    ParameterError
        With the file that is in the way.
    """
    for path in map(Path, paths):
        _check_pieces(path, overwrite)
        if not path.exists():
            continue
        if path.resolve().parent == Path(folder).resolve():
            raise ParameterError(f"{path}: expected a new file, got one of the run's own; choose another name")
        if not overwrite:
            raise ParameterError(f"{path}: expected a new file, got one that exists; --overwrite replaces it")


def _check_pieces(path: Path, overwrite: bool) -> None:
    if path.suffix.lower() not in (BLOCKS, SERIES):
        return
    folder = pieces_folder(path)
    if not is_replaceable(folder):
        raise ParameterError(f"{folder}: expected a new folder for the pieces of {path.name}, got one with other files")
    if os.path.lexists(folder) and not overwrite:
        raise ParameterError(f"{folder}: expected a new folder, got one that exists; --overwrite replaces it")


def _points(run: Run, state: str) -> np.ndarray:
    return run.deployed if state == "deployed" else run.contracted


def _write_obj(run: Run, path: Path, state: str) -> None:
    comments = [f"kirisurf: {state} state", f"units: {run.spec.units or 'those of the target'}"]
    if np.any(run.origin):
        comments.append(f"origin: {' '.join(repr(value) for value in run.origin.tolist())}")
    write_obj(path, _points(run, state), run.tessellation.tiles, comments)


def _write_vtp(run: Run, path: Path, state: str) -> None:
    vertex = {name: values for (where, name), values in run.fields.items() if where == "vertex"}
    tile = {name: values for (where, name), values in run.fields.items() if where == "tile"}
    about = described_file(state, {*vertex, *tile}, run.spec.units, run.origin)
    write_vtp(path, _points(run, state), run.tessellation.tiles, vertex, tile, about)


def _write_csv(run: Run, path: Path, state: str) -> None:
    holes = {name: values for (where, name), values in run.fields.items() if where == "hole"}
    write_text(path, curvature_csv(holes))


def _write_stl(run: Run, path: Path, state: str) -> None:
    points = _points(run, state)
    points = np.column_stack([points, np.zeros(len(points))]) if points.shape[1] == 2 else points
    faces, _ = triangulated(points, run.tessellation.tiles)
    write_bytes(path, stl_bytes(points[faces]))


_WRITERS: dict[str, Callable[[Run, Path, str], None]] = {
    ".obj": _write_obj,
    ".vtp": _write_vtp,
    ".stl": _write_stl,
    ".csv": _write_csv,
}
SUFFIXES = (*CUTTING, *_WRITERS, BLOCKS, SERIES, SHELLS)
