"""Meshes in and out of files, with ParaView's own VTK: what the filters hand to the program and read back."""

from __future__ import annotations

import os
from typing import Any

from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet, vtkMultiBlockDataSet, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter

BLOCKS = {"tiles": "deployed.vtp", "holes": "holes.vtp", "target": "target.vtp", "contracted": "contracted.vtp"}
"""Blocks of a sheet and their files in a run folder."""


class MeshError(Exception):
    """Why a mesh cannot be handed over, in one sentence for the user."""


def write(data: Any, path: str) -> None:
    """Write polygons as VTP.

    Raises
    ------
    MeshError
        Where there are none, or VTK cannot encode them.
    OSError
        Where the file cannot be written.
    """
    if data is None or not data.GetNumberOfCells():
        raise MeshError("expected a surface of polygons, got one without any")
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(data)
    # as text in memory: on a full disk VTK's own writing ends the process, and with it ParaView
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()
    if not writer.Write():
        raise MeshError("expected polygons that VTK can encode, got an error from it")
    with open(path, "w", encoding="utf-8") as file:
        file.write(writer.GetOutputString())


def read(path: str) -> Any:
    """Return the polygons of a VTP file."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    found = vtkPolyData()
    found.ShallowCopy(reader.GetOutput())
    return found


def read_blocks(output: Any, folder: str) -> None:
    """Fill a multiblock with the named blocks of a run folder."""
    output.SetNumberOfBlocks(len(BLOCKS))
    for k, (name, file) in enumerate(BLOCKS.items()):
        output.SetBlock(k, read(os.path.join(folder, file)))
        output.GetMetaData(k).Set(vtkCompositeDataSet.NAME(), name)


def named_blocks(data: Any) -> dict[str, Any]:
    """Return the polygon meshes of a multiblock by name, those within other blocks too."""
    found: dict[str, Any] = {}
    for k in range(data.GetNumberOfBlocks()):
        block = data.GetBlock(k)
        name = data.GetMetaData(k).Get(vtkCompositeDataSet.NAME()) if data.HasMetaData(k) else None
        if isinstance(block, vtkMultiBlockDataSet):
            found.update({key: inner for key, inner in named_blocks(block).items() if key not in found})
        elif isinstance(block, vtkPolyData):
            found[name if name and name not in found else f"block {k}"] = block
    return found


def add_texts(data: Any, texts: dict[str, list[str]]) -> None:
    """Add columns of text to the field data."""
    for name, entries in texts.items():
        column = vtkStringArray()
        column.SetName(name)
        for entry in entries:
            column.InsertNextValue(entry)
        data.GetFieldData().AddArray(column)
