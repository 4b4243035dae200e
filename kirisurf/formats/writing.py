"""Writing polygons: OBJ as text that reads back to the same doubles, VTP as binary doubles.

Both make the whole file in memory and write it through `atomic`: the libraries' own writers end the
process on a full disk, or leave a truncated file and say nothing.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from kirisurf.errors import OutputError
from kirisurf.formats import atomic
from kirisurf.formats.polydata import add_about, checked_parts, spatial
from kirisurf.gate import check_indices
from kirisurf.loops import Loops

_CACHED = re.compile(r"\s*<InformationKey .*?</InformationKey>", re.DOTALL)


def write_obj(path: str | os.PathLike[str], points: ArrayLike, loops: Loops, comments: Sequence[str] = ()) -> None:
    """Write polygons as OBJ with the shortest decimals that read back to the same doubles.

    Parameters
    ----------
    path : path
    points : (n, 2) or (n, 3), any unit
        Planar points are written with z = 0.
    loops : Loops
    comments : sequence of str
        Lines at the top of the file.

    Raises
    ------
    UnusableError
        Where the points are not finite or an index is out of range.
    OutputError
        Where the file cannot be written; an old one is untouched.
    """
    vertices = spatial(points)
    check_indices(loops.indices, len(vertices), "polygons")
    lines = [f"# {line}" for comment in comments for line in comment.splitlines()]
    lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    numbers = (loops.indices + 1).tolist()
    ends = loops.offsets.tolist()
    lines += ["f " + " ".join(map(str, numbers[a:b])) for a, b in pairwise(ends)]
    atomic.write_text(path, "\n".join(lines) + "\n")


def write_vtp(
    path: str | os.PathLike[str],
    points: ArrayLike,
    loops: Loops,
    point_fields: Mapping[str, ArrayLike] | None = None,
    cell_fields: Mapping[str, ArrayLike] | None = None,
    about: Mapping[str, ArrayLike | Sequence[str]] | None = None,
) -> None:
    """Write polygons with named fields as VTP (VTK XML, base64, double precision).

    Parameters
    ----------
    path : path
    points : (n, 2) or (n, 3), any unit
    loops : Loops
    point_fields, cell_fields : mapping of str to (n, ...) or (t, ...)
    about : mapping of str to numbers or texts
        Field data: what the file says about itself, see :func:`kirisurf.field_units.described_file`.

    Raises
    ------
    UnusableError
        Where shapes do not fit or an index is out of range.
    OutputError
        Where the file cannot be written; an old one is untouched.
    """
    atomic.write_bytes(path, vtp_bytes(points, loops, point_fields, cell_fields, about))


def vtp_bytes(
    points: ArrayLike,
    loops: Loops,
    point_fields: Mapping[str, ArrayLike] | None = None,
    cell_fields: Mapping[str, ArrayLike] | None = None,
    about: Mapping[str, ArrayLike | Sequence[str]] | None = None,
) -> bytes:
    """Return the content that :func:`write_vtp` writes; the same input gives the same bytes."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    vertices, point_rows, cell_rows = checked_parts(points, loops, point_fields, cell_fields)
    data, positions, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    positions.SetDataTypeToDouble()
    positions.SetData(numpy_to_vtk(np.array(vertices), deep=True))
    data.SetPoints(positions)
    cells.SetData(
        numpy_to_vtkIdTypeArray(np.array(loops.offsets), deep=True),
        numpy_to_vtkIdTypeArray(np.array(loops.indices), deep=True),
    )
    data.SetPolys(cells)
    for attributes, rows in ((data.GetPointData(), point_rows), (data.GetCellData(), cell_rows)):
        for key, values in rows.items():
            array = numpy_to_vtk(np.array(values), deep=True)
            array.SetName(key)
            attributes.AddArray(array)
    add_about(data, about or {})
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(data)
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()
    if not writer.Write():
        raise OutputError("expected vtk to encode the polygons, got an error from it")
    # vtk caches ranges in the file, and then cannot read a vector field back whose range is not finite.
    return _CACHED.sub("", writer.GetOutputString()).encode("utf-8")
