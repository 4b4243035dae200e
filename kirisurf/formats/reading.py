"""Reading surfaces and polygons of any supported format."""

from __future__ import annotations

import os

import numpy as np
from jaxtyping import Float

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats import gltf, obj, off, ply, stl, vtk_files
from kirisurf.formats.cleaning import surface_of
from kirisurf.formats.polygons import Polygons
from kirisurf.formats.source import LIMIT_MB, load
from kirisurf.formats.vtk_files import PolygonsWithFields
from kirisurf.loops import Loops
from kirisurf.surface import Surface

_READERS = {
    "stl": stl.read,
    "obj": obj.read,
    "ply": ply.read,
    "off": off.read,
    "vtp": vtk_files.read,
    "vtk": vtk_files.read,
    "gltf": gltf.read,
    "glb": gltf.read,
}
_SPLIT_FORMATS = ("stl", "obj", "gltf", "glb")


def read_surface(path: str | os.PathLike[str], *, limit_mb: int | float = LIMIT_MB) -> Surface:
    """Read a target surface from STL, OBJ, PLY, OFF, VTP, VTK or glTF.

    Vertices that the format splits are merged, polygons are cut into triangles, and what carries no
    surface (unused vertices, faces without area, copies of faces) is dropped. Double precision is kept.
    No other file is opened, whatever this one names. The topology is not judged here: see
    :func:`kirisurf.topology.require_disk`.

    Parameters
    ----------
    path : path
    limit_mb : float
        Largest file that is read, in megabytes.

    Returns
    -------
    Surface
        In the units and frame of the file (glTF: meters, y up).

    Raises
    ------
    UnreadableError
        Where the file is missing, unsupported, damaged or unsafe.
    UnusableError
        Where it holds no faces, numbers that are not finite or out of range, or no surface.
    """
    return read_surface_with_notes(path, limit_mb=limit_mb)[0]


def read_surface_with_notes(
    path: str | os.PathLike[str], *, limit_mb: int | float = LIMIT_MB
) -> tuple[Surface, tuple[str, ...]]:
    """Read as :func:`read_surface` does; also return a sentence on everything that was changed or left out."""
    source = load(path, limit_mb)
    try:
        return surface_of(_READERS[source.format](source), source.name, source.format in _SPLIT_FORMATS)
    except MemoryError:
        raise UnreadableError(f"{path}: expected a surface that fits into memory, got a larger one") from None


def read_polygons(
    path: str | os.PathLike[str], *, limit_mb: int | float = LIMIT_MB
) -> tuple[Float[np.ndarray, "n 3"], Loops]:
    """Read the polygons of an OBJ or VTP file as they are: nothing merged, triangulated or reordered.

    Returns
    -------
    vertices : (n, 3)
        In the order of the file, unused ones included; z = 0 where the file has two coordinates.
    loops : Loops
        The polygons in the order of the file.

    Raises
    ------
    UnreadableError, UnusableError
        As :func:`read_surface`; also for other formats and for polygons with fewer than three corners.
    """
    source = load(path, limit_mb)
    if source.format not in ("obj", "vtp"):
        raise UnreadableError(f"{path}: expected OBJ or VTP for polygons, got {source.format.upper()}")
    return checked_polygons(_READERS[source.format](source), source.name)


def read_fields(path: str | os.PathLike[str], *, limit_mb: int | float = LIMIT_MB) -> PolygonsWithFields:
    """Read a VTP or VTK file with its named fields, its polygons as :func:`read_polygons` gives them.

    Raises
    ------
    UnreadableError, UnusableError
        As :func:`read_polygons`.
    """
    source = load(path, limit_mb)
    if source.format not in ("vtp", "vtk"):
        raise UnreadableError(f"{path}: expected VTP or VTK for named fields, got {source.format.upper()}")
    found = vtk_files.read_with_fields(source)
    checked_polygons(found.polygons, source.name)
    return found


def checked_polygons(found: Polygons, name: str) -> tuple[np.ndarray, Loops]:
    """Return vertices and loops of polygons that all have corners and finite coordinates."""
    if not len(found.loops):
        raise UnusableError(f"{name}: expected polygons, got {len(found.vertices)} vertices without any")
    if (found.loops.sizes < 3).any():
        k = int(np.flatnonzero(found.loops.sizes < 3)[0])
        raise UnusableError(f"{name}: expected three corners or more, got {found.loops.sizes[k]} in polygon {k}")
    if not np.isfinite(found.vertices).all():
        k = int(np.flatnonzero(~np.isfinite(found.vertices).all(axis=1))[0])
        raise UnusableError(f"{name}: expected finite coordinates, got {found.vertices[k].tolist()} for vertex {k}")
    return found.vertices, found.loops
