"""Export of a run to cutting files and interchange formats, chosen by suffix."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from kirisurf.cuts import cuts
from kirisurf.errors import ParameterError
from kirisurf.formats import write_obj, write_vtp
from kirisurf.formats.atomic import write_bytes, write_text
from kirisurf.loops import Loops
from kirisurf.runs import Run
from kirisurf.runs.table import curvature_csv
from kirisurf.svg import svg_text

STATES = ("contracted", "deployed")
_LATER = (".dxf", ".pdf", ".step", ".stp", ".3mf", ".ply")


def export(
    run: Run,
    path: str | os.PathLike[str],
    state: str | None = None,
    hinge_width: float | None = None,
    units: str | None = None,
) -> Path:
    """Write one file of a run; its suffix chooses the format.

    =======  ==============================================================
    .svg     cut pattern to scale, layers cut, hinge and outline
    .obj     polygons of a state (contracted, unless `state` says deployed)
    .vtp     the same with every named field
    .stl     triangles of a state (binary, single precision)
    .csv     curvature of every hole
    =======  ==============================================================

    Parameters
    ----------
    run : Run
    path : path
        Replaced as a whole, or left alone where writing fails.
    state : str, optional
        contracted (default) or deployed.
    hinge_width : float, optional
        Of the SVG; by default that of the run.
    units : str, optional
        Of the SVG; by default those of the run.

    Raises
    ------
    ParameterError
        Where the suffix or the state is unknown.
    OutputError
        Where the file cannot be written.
    """
    check_names([path], state)
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".svg":
        width = hinge_width if hinge_width is not None else run.result["hinge_width"]
        lines = cuts(run.tessellation, run.contracted, width)
        write_text(path, svg_text(lines, units or run.spec.units, f"{run.result['target']['name']}: cut pattern"))
    else:
        _WRITERS[suffix](run, path, state or STATES[0])
    return path


def check_names(paths: Sequence[str | os.PathLike[str]], state: str | None) -> None:
    """Check suffixes and state before anything is read or written.

    Raises
    ------
    ParameterError
        Where one is unknown, or they do not go together.
    """
    if state is not None and state not in STATES:
        raise ParameterError(f"--state: expected one of {', '.join(STATES)}, got {state!r}")
    for path in paths:
        suffix = Path(path).suffix.lower()
        if suffix in _LATER:
            raise ParameterError(f"{path}: {suffix} is not available in this version: use {', '.join(SUFFIXES)}.")
        if suffix not in SUFFIXES:
            raise ParameterError(f"{path}: expected a suffix among {', '.join(SUFFIXES)}, got {suffix or 'none'}")
        if suffix == ".svg" and state == "deployed":
            raise ParameterError(f"{path}: expected --state contracted for a cut pattern, got deployed")


def check_free(paths: Sequence[str | os.PathLike[str]], folder: str | os.PathLike[str], overwrite: bool) -> None:
    """Refuse to replace files that exist, and any of the files that belong to the run itself.

    Raises
    ------
    ParameterError
        With the file that is in the way.
    """
    for path in map(Path, paths):
        if not path.exists():
            continue
        if path.resolve().parent == Path(folder).resolve():
            raise ParameterError(f"{path}: expected a new file, got one of the run's own; choose another name")
        if not overwrite:
            raise ParameterError(f"{path}: expected a new file, got one that exists; --overwrite replaces it")


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
    write_vtp(path, _points(run, state), run.tessellation.tiles, vertex, tile)


def _write_csv(run: Run, path: Path, state: str) -> None:
    holes = {name: values for (where, name), values in run.fields.items() if where == "hole"}
    write_text(path, curvature_csv(holes))


def _write_stl(run: Run, path: Path, state: str) -> None:
    points = _points(run, state)
    points = np.column_stack([points, np.zeros(len(points))]) if points.shape[1] == 2 else points
    write_bytes(path, stl_bytes(points, run.tessellation.tiles))


def stl_bytes(points: np.ndarray, tiles: Loops) -> bytes:
    """Return convex tiles as a binary STL of triangles, each tile as a fan from its first vertex.

    Parameters
    ----------
    points : (n, 3)
    tiles : Loops
    """
    fans = [np.stack([np.full(len(t) - 2, t[0]), t[1:-1], t[2:]], axis=1) for t in tiles]
    corners = points[np.concatenate(fans)] if fans else np.zeros((0, 3, 3))
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    record = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    record["normal"] = normal / np.where(length > 0, length, 1.0)
    record["corners"] = corners
    return b"kirisurf".ljust(80) + np.uint32(len(corners)).tobytes() + record.tobytes()


_WRITERS: dict[str, Callable[[Run, Path, str], None]] = {
    ".obj": _write_obj,
    ".vtp": _write_vtp,
    ".stl": _write_stl,
    ".csv": _write_csv,
}
SUFFIXES = (".svg", *_WRITERS)
