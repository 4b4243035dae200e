"""Exchange with pyvista: polygons and fields to PolyData, PolyData to a surface."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from kirisurf.arrays import checked
from kirisurf.errors import UnusableError
from kirisurf.formats.cleaning import surface_of
from kirisurf.formats.polygons import Polygons
from kirisurf.gate import check_indices
from kirisurf.loops import Loops
from kirisurf.surface import Surface

if TYPE_CHECKING:
    import pyvista


def to_polydata(
    points: ArrayLike,
    loops: Loops,
    point_fields: Mapping[str, ArrayLike] | None = None,
    cell_fields: Mapping[str, ArrayLike] | None = None,
    about: Mapping[str, ArrayLike | Sequence[str]] | None = None,
) -> pyvista.PolyData:
    """Build a PolyData of polygons with named fields, in double precision.

    Parameters
    ----------
    points : (n, 2) or (n, 3), any unit
        Planar points get z = 0.
    loops : Loops
        One polygon each.
    point_fields, cell_fields : mapping of str to (n, ...) or (t, ...)
        Numbers or booleans, one row per point or polygon.
    about : mapping of str to numbers or texts
        Field data: what the mesh says about itself, such as its units.

    Raises
    ------
    UnusableError
        Where a shape does not fit or an index is out of range.
    """
    import pyvista

    vertices, points_rows, cells_rows = checked_parts(points, loops, point_fields, cell_fields)
    polygons = np.insert(loops.indices, loops.offsets[:-1], loops.sizes)
    data = pyvista.PolyData(np.array(vertices), faces=polygons) if len(loops) else pyvista.PolyData()
    if not len(loops) and len(vertices):
        data.points = np.array(vertices)
    for key, values in points_rows.items():
        data.point_data[key] = values
    for key, values in cells_rows.items():
        data.cell_data[key] = values
    add_about(data, about or {})
    return data


def checked_parts(
    points: ArrayLike,
    loops: Loops,
    point_fields: Mapping[str, ArrayLike] | None,
    cell_fields: Mapping[str, ArrayLike] | None,
) -> tuple[np.ndarray, dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Check points, polygons and fields against each other; points come back as (n, 3)."""
    vertices = spatial(points)
    check_indices(loops.indices, len(vertices), "polygons")
    return (
        vertices,
        _checked_fields(point_fields or {}, len(vertices), "point"),
        _checked_fields(cell_fields or {}, len(loops), "polygon"),
    )


def add_about(data: Any, about: Mapping[str, ArrayLike | Sequence[str]]) -> None:
    """Add field data to a VTK data set: texts in any script, which pyvista's own door does not let in.

    Raises
    ------
    UnusableError
        Where an entry is neither texts nor numbers.
    """
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkStringArray

    for key, entries in checked_about(about).items():
        if isinstance(entries, list):
            array = vtkStringArray()
            for entry in entries:
                array.InsertNextValue(entry)
        else:
            array = numpy_to_vtk(np.array(entries), deep=True)
        array.SetName(key)
        data.GetFieldData().AddArray(array)


def checked_about(about: Mapping[str, ArrayLike | Sequence[str]]) -> dict[str, np.ndarray | list[str]]:
    """Check what a mesh says about itself: lists of texts, or numbers in rows.

    Raises
    ------
    UnusableError
        Where an entry is neither.
    """
    found: dict[str, np.ndarray | list[str]] = {}
    for key, entries in about.items():
        if isinstance(entries, (list, tuple)) and entries and all(isinstance(entry, str) for entry in entries):
            found[key] = [str(entry) for entry in entries]
            continue
        array = np.asarray(entries)
        if array.dtype.kind not in "iuf" or array.ndim not in (1, 2):
            raise UnusableError(f"{key}: expected texts or rows of numbers, got {array.dtype} of shape {array.shape}")
        found[key] = np.ascontiguousarray(array)
    return found


def spatial(points: ArrayLike) -> np.ndarray:
    """Return points (n, 3), with z = 0 for planar ones (n, 2)."""
    array = np.asarray(points)
    if array.ndim == 2 and array.shape[1] == 2:
        array = np.column_stack([array, np.zeros(len(array))])
    return checked(array, "points", (None, 3))


def _checked_fields(fields: Mapping[str, ArrayLike], rows: int, what: str) -> dict[str, np.ndarray]:
    found = {}
    for key, values in fields.items():
        array = np.asarray(values)
        if array.dtype.kind == "b":
            array = array.astype(np.uint8)
        if array.dtype.kind not in "iuf" or array.ndim not in (1, 2) or len(array) != rows:
            raise UnusableError(
                f"field {key}: expected numbers for each {what}, {rows} rows, got {array.dtype} of shape {array.shape}"
            )
        found[key] = np.ascontiguousarray(array)
    return found


def surface_from_polydata(polydata: Any, name: str = "surface") -> Surface:
    """Turn a pyvista PolyData (or UnstructuredGrid of polygons) into a surface, as a file of it would be read.

    Raises
    ------
    UnusableError
        Where it holds strips, no polygons, or what :func:`kirisurf.formats.read_surface` would refuse.
    """
    if hasattr(polydata, "extract_surface") and not hasattr(polydata, "GetPolys"):
        polydata = polydata.extract_surface(algorithm="dataset_surface")
    if not hasattr(polydata, "GetPolys"):
        raise UnusableError(f"{name}: expected a pyvista PolyData, got {type(polydata).__name__}")
    if polydata.GetNumberOfStrips():
        raise UnusableError(f"{name}: expected polygons, got triangle strips: call .triangulate() first")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if not polydata.GetNumberOfPoints() or not polydata.GetNumberOfPolys():
        raise UnusableError(f"{name}: expected polygons, got {polydata.GetNumberOfPoints()} points and none")
    points = vtk_to_numpy(polydata.GetPoints().GetData()).astype(np.float64)
    cells = polydata.GetPolys()
    offsets = vtk_to_numpy(cells.GetOffsetsArray()).astype(np.int64)
    indices = vtk_to_numpy(cells.GetConnectivityArray()).astype(np.int64)
    check_indices(indices, len(points), name)
    return surface_of(Polygons(points, Loops(offsets, indices)), name, is_split=False)[0]
