"""From what a user calls the target (a file, a sample's name, arrays, a pyvista mesh) to a surface.

The one door from computing to `sample_surfaces`, which is imported inside the functions.
"""

from __future__ import annotations

import difflib
import math
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kirisurf import outlines
from kirisurf.arrays import checked
from kirisurf.errors import ParameterError, UnreadableError
from kirisurf.gate import check_indices, check_size
from kirisurf.naming import is_file_name
from kirisurf.outlines import Outline, planar_surface, read_outline
from kirisurf.outlines.reading import FORMATS
from kirisurf.spec import DEFAULT_TILES, RECTANGLE, FitSpec
from kirisurf.surface import Surface
from kirisurf.units import UNITS

if TYPE_CHECKING:
    from sample_surfaces.catalog import SampleSpec

OUTLINE_CELLS = (4, 4)
"""Unit cells of a pattern in a named outline, where no number is given: the size of most of the paper's."""

WINDING = ("letter-s",)
"""Named outlines that no rectangular pattern is bent into: theirs is trimmed."""


def load(target: Any, resolution: int | None = None) -> Surface:
    """Return a target surface.

    Parameters
    ----------
    target : str, path, Surface, (vertices, faces) or pyvista.PolyData
        A mesh file; the name of a sample surface (a file of the same name needs a folder: ./hypar);
        arrays (v, 3) and (f, 3); or a mesh in memory.
    resolution : int, optional
        Of a sample surface.

    Raises
    ------
    UnreadableError
        Where there is no such file or sample, or the file cannot be read.
    UnusableError
        Where it holds no usable surface.
    ParameterError
        Where the target is of another type.

    Examples
    --------
    >>> load("hypar", resolution=10).vertices.shape
    (121, 3)
    """
    if isinstance(target, Surface):
        return _within_range(target)
    if isinstance(target, (str, os.PathLike)):
        return load_with_notes(target_name(target), resolution)[0]
    if isinstance(target, (tuple, list)) and len(target) == 2:
        return _within_range(Surface.from_arrays(target[0], target[1], "arrays"))
    if hasattr(target, "points") and hasattr(target, "n_cells"):
        from kirisurf.formats import surface_from_polydata

        return surface_from_polydata(target, "mesh")
    raise ParameterError(
        "target: expected a file, the name of a sample surface, (vertices, faces), or a pyvista mesh, "
        f"got {type(target).__name__}"
    )


def _within_range(surface: Surface) -> Surface:
    """Return a surface of finite coordinates that can be computed with, its indices within range."""
    checked(surface.vertices, f"vertices of {surface.name}", (None, 3))
    check_indices(surface.faces, len(surface.vertices), surface.name)
    if len(surface.vertices):
        check_size(surface.vertices, surface.name)
    return surface


def target_name(target: str | os.PathLike[str]) -> str:
    """Return a target's name as a spec holds it; a path object is a file even without a suffix."""
    name = os.fspath(target)
    return f"./{name}" if isinstance(target, os.PathLike) and not is_file_name(name) else name


def samples() -> tuple[SampleSpec, ...]:
    """Return what is known of every sample surface, the published ones first.

    Examples
    --------
    >>> [sample.title for sample in samples() if sample.name == "hypar"]
    ['Hyperbolic paraboloid']
    """
    import sample_surfaces

    return tuple(sample_surfaces.spec(name) for name in sample_surfaces.names())


def is_sample(target: str) -> bool:
    """Whether a target's name means a sample surface."""
    import sample_surfaces

    return not is_file_name(target) and target in sample_surfaces.names()


def is_outline_name(target: str) -> bool:
    """Whether a target's name means a planar outline."""
    return not is_file_name(target) and target in outlines.names()


def read_named_outline(name: str, units: str | None = None) -> Outline:
    """Return the outline of a name, or of a file, as the contracted sheet is asked to have it.

    Raises
    ------
    UnreadableError, UnusableError, ParameterError
        As :func:`kirisurf.outlines.read_outline`; or where there is no such name.
    """
    if is_outline_name(name):
        return outlines.outline(name)
    if is_file_name(name):
        return read_outline(name, units)[0]
    near = difflib.get_close_matches(name, outlines.names(), n=1)
    hint = f" (did you mean {near[0]!r}?)" if near else ""
    raise ParameterError(
        f"--contracted: expected free, rectangle, rectangle:RATIO, a file or one of {', '.join(outlines.names())}, "
        f"got {name!r}{hint}"
    )


def resolved(spec: FitSpec, folder: Path | None = None, sized: bool = False) -> FitSpec:
    """Return the spec with nothing left to the place where it is run.

    A file's path becomes absolute (relative paths start at `folder`, by default the current one). A
    sample's own units are taken where none are given, and its own number of tiles where not `sized`; a named
    outline's is `OUTLINE_CELLS`, where it is not `WINDING`.
    """
    if not (spec.contracted == "free" or spec.contracted.startswith(RECTANGLE) or _is_file(spec.contracted)):
        # a name that means nothing is said before anything is read
        read_named_outline(spec.contracted)
    spec = _with_absolute_files(spec, folder or Path())
    if is_sample(spec.target):
        import sample_surfaces

        sample = sample_surfaces.spec(spec.target)
        values: dict[str, Any] = {}
        if not sized:
            values = {"cells": sample.cells} if sample.cells else {"tiles": sample.tiles} if sample.tiles else {}
        if spec.units is None and sample.units in UNITS:
            values["units"] = sample.units
        return spec.changed(**values)
    if is_outline_name(spec.target):
        return spec if sized or spec.target in WINDING else spec.changed(cells=OUTLINE_CELLS)
    path = os.path.abspath(os.path.join(folder or Path(), spec.target))
    # A bare name that is no file may be a sample's name with a typo: it is kept for the message.
    return spec if not is_file_name(spec.target) and not os.path.exists(path) else spec.changed(target=path)


def flat_target(outline: Outline) -> Surface:
    """Return the inside of an outline as a target with z = 0."""
    return replace(planar_surface(outline), outline=outline)


def _with_absolute_files(spec: FitSpec, folder: Path) -> FitSpec:
    """The spec with absolute paths of the files of tessellation and contracted outline."""
    files = {name: getattr(spec, name) for name in ("tessellation", "contracted")}
    files = {name: os.path.abspath(os.path.join(folder, value)) for name, value in files.items() if _is_file(value)}
    return spec.changed(**files) if files else spec


def _is_file(value: str) -> bool:
    return is_file_name(value) and not value.startswith(f"{RECTANGLE}:")


def loaded(spec: FitSpec) -> tuple[FitSpec, Surface, tuple[str, ...]]:
    """Return a resolved spec with the unit of its target, the target, and what its reader said.

    Raises
    ------
    UnreadableError, UnusableError, ParameterError
        As :func:`load`.
    """
    surface, notes = load_with_notes(spec.target, units=spec.units)
    own = surface.outline.units if isinstance(surface.outline, Outline) else None
    return (spec.changed(units=own) if spec.units is None and own in UNITS else spec), surface, notes


def load_with_notes(
    target: str, resolution: int | None = None, units: str | None = None
) -> tuple[Surface, tuple[str, ...]]:
    """Return the surface of a file or a sample, with a sentence on everything that the reader changed.

    Raises
    ------
    UnreadableError, UnusableError, ParameterError
        As :func:`load`.
    """
    notes: tuple[str, ...]
    if is_sample(target):
        import sample_surfaces

        shadowed = os.path.isfile(target)
        notes = (f"{target} is the sample surface; the file of that name is ./{target}.",) if shadowed else ()
        return sample_surfaces.load(target, resolution), notes
    if is_outline_name(target):
        shadowed = os.path.isfile(target)
        notes = (f"{target} is the planar outline; the file of that name is ./{target}.",) if shadowed else ()
        return flat_target(outlines.outline(target)), notes
    if not os.path.exists(target) and not is_file_name(target):
        import sample_surfaces

        known = (*sample_surfaces.names(), *outlines.names())
        near = difflib.get_close_matches(target, known, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"samples and outlines: {', '.join(known)}"
        raise UnreadableError(f"target: expected a mesh file or the name of a sample surface, got {target!r} ({hint})")
    if Path(target).suffix.lower() in FORMATS:
        outline, notes = read_outline(target, units)
        return flat_target(outline), notes
    from kirisurf.formats import read_surface_with_notes
    from kirisurf.formats.source import FORMATS as MESH_FORMATS

    suffix = Path(target).suffix.lower()
    if suffix and suffix not in MESH_FORMATS and os.path.isfile(target):
        wanted = f"a mesh ({', '.join(sorted(MESH_FORMATS))}) or an outline ({', '.join(sorted(FORMATS))})"
        raise UnreadableError(f"{target}: expected {wanted}, got a file called {suffix}")
    return read_surface_with_notes(target)


def prepared(surface: Surface, spec: FitSpec) -> tuple[Surface, tuple[str, ...]]:
    """Return the surface repaired and remeshed as the spec asks, with a sentence on either."""
    if not (spec.repair or spec.remesh):
        return surface, ()
    if surface.outline is not None:
        raise ParameterError("--repair, --remesh: expected with a mesh, got a planar outline")
    from kirisurf.repair import remeshed, repaired_with_notes

    notes: list[str] = []
    if spec.repair:
        surface, done = repaired_with_notes(surface)
        notes += done or ("The target needed no repair.",)
    if spec.remesh:
        # Three faces along a tile's edge: enough for a normal on each side of every vertex of the pattern.
        tiles = 4 * spec.cells[0] * spec.cells[1] if spec.cells else spec.tiles or DEFAULT_TILES
        edge = spec.remesh_edge or math.sqrt(surface.area / tiles) / 3.0
        surface = remeshed(surface, edge)
        notes.append(f"The target was remeshed to edges of {edge:.4g}: {len(surface.faces)} faces now.")
    return surface, tuple(notes)
