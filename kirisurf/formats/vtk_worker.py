"""Script of the child process that reads VTP and legacy VTK through vtk (see `vtk_files`).

    vtk_worker.py vtp|vtk INPUT OUTPUT.npz MEMORY_MB

Prints one JSON object: {"fields": ...} and writes the arrays, or {"error": sentence, "kind":
"damaged" | "wrong"}. Imports nothing of kirisurf: it runs outside the package.
"""

from __future__ import annotations

import json
import re
import sys
from typing import Any


def main(kind: str, path: str, output: str, memory_mb: str) -> dict:
    """Read one file and save its arrays."""
    try:
        import resource

        limit = int(float(memory_mb) * 1e6)
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    except (ImportError, ValueError, OSError):
        pass  # a system without such limits: the wall-clock limit of the parent remains
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    complaints: list[str] = []
    if kind == "vtp":
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

        reader = vtkXMLPolyDataReader()
    else:
        from vtkmodules.vtkIOLegacy import vtkDataSetReader

        reader = vtkDataSetReader()
        reader.ReadAllScalarsOn()
        reader.ReadAllVectorsOn()
        reader.ReadAllNormalsOn()
        reader.ReadAllFieldsOn()
    reader.AddObserver("ErrorEvent", lambda *_: complaints.append("error"))
    reader.SetFileName(path)
    reader.Update()
    if complaints or reader.GetErrorCode() or "ERR" in window.GetOutput() or "error" in window.GetOutput().lower():
        said = re.search(r"\): *([^\n]+)", window.GetOutput())
        return {"kind": "damaged", "error": (said.group(1).strip() if said else "vtk reports an error")[:200]}
    data = reader.GetOutput()
    if data is None:
        return {"kind": "wrong", "error": "no data set"}
    name = data.GetClassName()
    if name not in ("vtkPolyData", "vtkUnstructuredGrid"):
        return {"kind": "wrong", "error": f"a {name[3:]}"}
    n = data.GetNumberOfPoints()
    points = data.GetPoints()
    if points is not None and vtk_to_numpy(points.GetData()).shape != (n, 3):
        return {"kind": "damaged", "error": "points that are not n by 3"}
    arrays: dict[str, Any] = {
        "points": np.zeros((0, 3)) if points is None else vtk_to_numpy(points.GetData()).astype(np.float64)
    }
    if name == "vtkUnstructuredGrid":
        cells = data.GetCells()
        types = set() if not data.GetNumberOfCells() else set(vtk_to_numpy(data.GetCellTypes()).tolist())
        if types - {5, 7, 9}:  # triangle, polygon, quad
            return {"kind": "wrong", "error": f"an unstructured grid with other cells (types {sorted(types)})"}
    else:
        cells = data.GetPolys()
        if data.GetNumberOfStrips():
            return {"kind": "wrong", "error": "triangle strips"}
    arrays["offsets"] = np.zeros(1, np.int64)
    arrays["indices"] = np.zeros(0, np.int64)
    if cells is not None and cells.GetNumberOfCells():
        arrays["offsets"] = vtk_to_numpy(cells.GetOffsetsArray()).astype(np.int64)
        arrays["indices"] = vtk_to_numpy(cells.GetConnectivityArray()).astype(np.int64)
    names: dict[str, dict[str, str]] = {}
    for where, attributes in (("point", data.GetPointData()), ("cell", data.GetCellData())):
        names[where] = {}
        for k in range(attributes.GetNumberOfArrays()):
            array = attributes.GetArray(k)  # None for arrays of text
            if array is not None and array.GetName():
                arrays[f"{where}{k}"] = vtk_to_numpy(array)
                names[where][array.GetName()] = f"{where}{k}"
    texts: dict[str, list[str]] = {}
    names["about"] = {}
    said = data.GetFieldData()
    for k in range(said.GetNumberOfArrays()):
        array, column = said.GetArray(k), said.GetAbstractArray(k)
        if array is not None and array.GetName():
            arrays[f"about{k}"] = vtk_to_numpy(array)
            names["about"][array.GetName()] = f"about{k}"
        elif column is not None and column.GetName() and column.IsA("vtkStringArray"):
            values = [column.GetValue(i) for i in range(column.GetNumberOfValues())]
            if all(isinstance(value, str) for value in values):  # vtk hands out bytes where they are no UTF-8
                texts[column.GetName()] = values
    np.savez(output, **arrays)
    return {"fields": names, "texts": texts}


if __name__ == "__main__":
    try:
        found = main(*sys.argv[1:])
    except MemoryError:
        found = {"kind": "damaged", "error": "more memory than the limit for it"}
    print(json.dumps(found))  # noqa: T201 - standard output is how the child answers
