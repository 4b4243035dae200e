"""Every file of a run opens in ParaView: counts, named fields with place and range, units, blocks, times."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kirisurf.exporting import export
from kirisurf.formats import read_fields
from kirisurf.formats.vtk_files import PolygonsWithFields
from kirisurf.runs import Run

Ask = Callable[..., Any]
FILES = ("deployed", "contracted", "holes", "target")

_DESCRIBE = """
def finite_range(array):
    import numpy
    values = vtk_to_numpy(array).ravel()
    values = values[numpy.isfinite(values)]
    return [float(values.min()), float(values.max())] if len(values) else []
def described(data):
    fields = {}
    for where, attributes in (("point", data.GetPointData()), ("cell", data.GetCellData())):
        for k in range(attributes.GetNumberOfArrays()):
            array = attributes.GetArray(k)
            fields[where + " " + array.GetName()] = [array.GetNumberOfComponents(), finite_range(array)]
    said = data.GetFieldData()
    about = {}
    for k in range(said.GetNumberOfArrays()):
        column = said.GetAbstractArray(k)
        if column.IsA("vtkStringArray"):
            about[column.GetName()] = [column.GetValue(i) for i in range(column.GetNumberOfValues())]
        else:
            about[column.GetName()] = vtk_to_numpy(column).tolist()
    return {"points": data.GetNumberOfPoints(), "cells": data.GetNumberOfCells(), "bounds": data.GetBounds(),
            "fields": fields, "about": about}
"""

_READ = (
    _DESCRIBE
    + """
found = []
for path in sys.argv[1:]:
    source = simple.OpenDataFile(path)
    source.UpdatePipeline()
    found.append(described(servermanager.Fetch(source)))
answer(found)
"""
)

_BLOCKS = (
    _DESCRIBE
    + """
source = simple.OpenDataFile(sys.argv[1])
source.UpdatePipeline()
data = servermanager.Fetch(source)
found = {}
for k in range(data.GetNumberOfBlocks()):
    found[data.GetMetaData(k).Get(data.NAME())] = described(data.GetBlock(k))
shown = source.GetDataInformation().DataInformation.GetHierarchy() if hasattr(
    source.GetDataInformation().DataInformation, "GetHierarchy") else None
names = [] if shown is None else [shown.GetNodeName(child) for child in shown.GetChildNodes(0)]
answer({"blocks": found, "shown": names})
"""
)

_SERIES = (
    _DESCRIBE
    + """
source = simple.OpenDataFile(sys.argv[1])
source.UpdatePipelineInformation()
def leaf(data):
    return leaf(data.GetBlock(0)) if data.IsA("vtkMultiBlockDataSet") else data
times = list(source.TimestepValues)
frames = []
for time in times:
    source.UpdatePipeline(time)
    data = servermanager.Fetch(source)
    frames.append({data.GetMetaData(k).Get(data.NAME()): described(leaf(data.GetBlock(k)))
                   for k in range(data.GetNumberOfBlocks())})
answer({"times": times, "frames": frames})
"""
)


def ranges(rows: dict[str, np.ndarray], where: str) -> dict[str, list]:
    found = {}
    for name, values in rows.items():
        finite = values[np.isfinite(values)]
        components = 1 if values.ndim == 1 else values.shape[1]
        found[f"{where} {name}"] = [components, [float(finite.min()), float(finite.max())] if len(finite) else []]
    return found


def agree(seen: dict[str, Any], ours: PolygonsWithFields) -> None:
    vertices, loops = ours.polygons.vertices, ours.polygons.loops
    assert seen["points"] == len(vertices) and seen["cells"] == len(loops)
    assert (
        seen["bounds"][0::2] == vertices.min(axis=0).tolist() and seen["bounds"][1::2] == vertices.max(axis=0).tolist()
    )
    assert seen["fields"] == {**ranges(dict(ours.point_fields), "point"), **ranges(dict(ours.cell_fields), "cell")}


@pytest.fixture(scope="module")
def read(pvpython: Ask, run: Run) -> dict[str, Any]:
    return dict(zip(FILES, pvpython(_READ, *(run.folder / f"{name}.vtp" for name in FILES)), strict=True))


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_a_run_has_its_points_cells_and_fields(read: dict[str, Any], run: Run, name: str) -> None:
    seen = read[name]
    agree(seen, read_fields(run.folder / f"{name}.vtp"))
    about = seen["about"]
    assert about["state"] == [name] and about["unit_of_length"] == ["mm"] and about["origin"] == [[0.0, 0.0, 0.0]]
    assert about["field"] == sorted({key.partition(" ")[2] for key in seen["fields"]})
    units = dict(zip(about["field"], about["field_unit"], strict=True))
    if name == "holes":
        assert units["gaussian_curvature"] == "1/mm²" and units["target_mean_curvature"] == "1/mm"
        assert units["opening_angle"] == "rad" and units["area"] == "mm²" and units["flag"] == ""


@pytest.mark.parametrize("exported", [False, True])
def test_blocks_have_names_and_are_the_files(pvpython: Ask, run: Run, tmp_path: Path, exported: bool) -> None:
    path = export(run, tmp_path / "s & <ü>.vtm") if exported else run.folder / "run.vtm"
    seen = pvpython(_BLOCKS, path)
    files = {"tiles": "deployed", "holes": "holes", "target": "target", "contracted": "contracted"}
    assert list(seen["blocks"]) == list(files) == seen["shown"]
    for block, name in files.items():
        agree(seen["blocks"][block], read_fields(run.folder / f"{name}.vtp"))


def test_a_time_series_goes_from_closed_to_open(pvpython: Ask, run: Run, opening: Path) -> None:
    seen = pvpython(_SERIES, opening)
    assert seen["times"] == [0.0, 0.25, 0.5, 0.75, 1.0]
    for time, frame in zip(seen["times"], seen["frames"], strict=True):
        assert list(frame) == ["tiles", "holes"]
        assert frame["tiles"]["cells"] == run.tessellation.n_tiles
        assert frame["holes"]["cells"] == len(run.tessellation.holes)
        assert frame["tiles"]["about"]["share"] == [time]
        said = frame["tiles"]["about"]["state"][0]
        assert ("interpolated" in said and "not a mechanism" in said) == (0 < time < 1)
    last = seen["frames"][-1]["tiles"]["bounds"]
    assert last[0::2] == run.deployed.min(axis=0).tolist() and last[1::2] == run.deployed.max(axis=0).tolist()
    opened = [frame["holes"]["fields"]["cell opening_angle"][1][0] for frame in seen["frames"]]
    assert opened == sorted(opened) and abs(opened[0]) < 1e-6 < opened[1]


def test_a_far_target_keeps_its_origin(pvpython: Ask, far_run: Run) -> None:
    assert np.abs(far_run.origin).max() > 1e6
    for seen in pvpython(_READ, *(far_run.folder / f"{name}.vtp" for name in FILES)):
        assert seen["about"]["origin"] == [far_run.origin.tolist()]
        assert np.abs(seen["bounds"]).max() < 100
