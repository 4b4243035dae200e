"""The filters, as plain VTK algorithms and in ParaView itself, with the real program behind them."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

from kirisurf.formats import read_surface
from kirisurf.runs import Run, read_run
from viewers.paraview import kirisurf_filters
from viewers.paraview.kirisurf_filters import HoleCurvature, KirigamiFit

Ask = Callable[..., Any]
PLUGIN = Path(kirisurf_filters.__file__).resolve()


@pytest.fixture(scope="session")
def program_path() -> str:
    path = Path(sys.executable).with_name("kirisurf")
    if not path.is_file():
        pytest.skip("the filters did not run: kirisurf is not installed as a program in this environment")
    return str(path)


@pytest.fixture
def log():
    """Catch what VTK says."""
    before, window = vtkOutputWindow.GetInstance(), vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    yield window.GetOutput
    vtkOutputWindow.SetInstance(before)


def hypar() -> pyvista.PolyData:
    x, y = np.meshgrid(np.linspace(-1, 1, 17), np.linspace(-1, 1, 17))
    return pyvista.StructuredGrid(x, y, 0.5 * x * y).extract_surface(algorithm="dataset_surface").triangulate()


def fit(program_path: str, mesh: Any) -> KirigamiFit:
    made = KirigamiFit()
    made.SetProgram(program_path)
    made.SetInputDataObject(mesh)
    made.SetCells(2, 2)
    return made


def field(data: Any, name: str) -> np.ndarray:
    return np.array([data.GetCellData().GetArray(name).GetValue(k) for k in range(data.GetNumberOfCells())])


@pytest.mark.slow
def test_a_fit_and_the_curvature_of_its_holes(program_path: str, tmp_path: Path, log) -> None:
    made = fit(program_path, hypar())
    made.SetUnits("mm")
    made.SetMoreOptions("--min-edge 0.2 --no-pictures")
    made.SetFolder(str(tmp_path / "kept run"))
    shares: list[float] = []
    made.AddObserver("ProgressEvent", lambda *_: shares.append(made.GetProgress()))
    made.Update()
    sheet = made.GetOutputDataObject(0)
    assert log() == ""
    names = [sheet.GetMetaData(k).Get(sheet.NAME()) for k in range(sheet.GetNumberOfBlocks())]
    assert names == ["tiles", "holes", "target", "contracted"]
    assert sheet.GetFieldData().GetAbstractArray("verdict").GetValue(0) == "certified"
    assert shares == sorted(shares) and len(set(shares)) > 2
    run = read_run(tmp_path / "kept run")
    assert run.spec.units == "mm" and run.spec.min_edge == 0.2 and run.result["certified"]
    assert sheet.GetBlock(0).GetNumberOfCells() == run.tessellation.n_tiles == 16

    holes = HoleCurvature()
    holes.SetProgram(program_path)
    holes.SetInputConnection(made.GetOutputPort())
    holes.Update()
    found = holes.GetOutputDataObject(0)
    assert log() == ""
    for name in ("gaussian_curvature", "target_gaussian_curvature", "opening_angle"):
        assert sorted(field(found, name)) == pytest.approx(sorted(run.fields["hole", name]), rel=1e-9, abs=1e-12)


def test_a_sheet_without_names_and_without_target(program_path: str, run: Run, log) -> None:
    blocks = pyvista.MultiBlock([pyvista.read(run.folder / f"{name}.vtp") for name in ("deployed", "contracted")])
    holes = HoleCurvature()
    holes.SetProgram(program_path)
    holes.SetInputDataObject(blocks)
    holes.Update()
    found = holes.GetOutputDataObject(0)
    assert sorted(field(found, "gaussian_curvature")) == pytest.approx(sorted(run.fields["hole", "gaussian_curvature"]))
    assert found.GetCellData().GetArray("target_gaussian_curvature") is None


def sphere() -> pyvista.PolyData:
    return pyvista.Sphere(theta_resolution=12, phi_resolution=12)


@pytest.mark.parametrize(
    ("mesh", "options", "message"),
    [
        (sphere, "", "The surface is closed"),
        (pyvista.PolyData, "", "expected a surface of polygons, got one without any"),
        (hypar, "--min-edge much", "--min-edge: expected a number"),
        (hypar, "'open", "More Options: expected words and quotation marks in pairs"),
    ],
    ids=["closed", "empty", "option", "quotation"],
)
def test_wrong_input_is_one_sentence_in_the_log(program_path: str, mesh, options: str, message: str, log) -> None:
    made = fit(program_path, mesh())
    made.SetMoreOptions(options)
    made.Update()
    assert message in log() and log().count("Kirigami Fit: ") == 1 and "Traceback" not in log()
    assert made.GetOutputDataObject(0).GetNumberOfBlocks() == 0


def test_a_full_disk_is_said(program_path: str, monkeypatch: pytest.MonkeyPatch, log) -> None:
    monkeypatch.setattr(kirisurf_filters.tempfile, "TemporaryDirectory", lambda **_: nullcontext("/dev/full"))
    made = fit(program_path, hypar())
    made.Update()
    assert log().startswith("Kirigami Fit: ") and "/dev/full" in log() and "Traceback" not in log()
    if Path("/dev/full").exists():
        with pytest.raises(OSError, match="No space left"):
            kirisurf_filters.meshes.write(hypar(), "/dev/full")


def test_blocks_that_are_no_sheet(program_path: str, run: Run, log) -> None:
    one = pyvista.read(run.folder / "deployed.vtp")
    for blocks in (pyvista.MultiBlock([one]), pyvista.MultiBlock([one, one, one]), pyvista.MultiBlock()):
        holes = HoleCurvature()
        holes.SetProgram(program_path)
        holes.SetInputDataObject(blocks)
        holes.Update()
        assert holes.GetOutputDataObject(0).GetNumberOfCells() == 0
    assert log().count("expected blocks tiles and contracted, or two blocks in this order, got ") == 3


@pytest.mark.slow
def test_an_abort_keeps_the_best_so_far_or_says_that_there_is_none(program_path: str, log) -> None:
    made = fit(program_path, hypar())
    made.SetCells(40, 40)
    made.AddObserver("ProgressEvent", lambda *_: made.SetAbortExecute(made.GetProgress() > 0.05))
    made.Update()
    sheet = made.GetOutputDataObject(0)
    assert sheet.GetNumberOfBlocks() in (0, 4) and "Kirigami Fit: " in log()
    if sheet.GetNumberOfBlocks():
        assert sheet.GetFieldData().GetAbstractArray("verdict").GetValue(0) == "not certified"


_IN_PARAVIEW = """
simple.LoadPlugin(sys.argv[1], remote=False, ns=globals())
source = simple.OpenDataFile(sys.argv[2])
fit = KirigamiFit(Input=source, Cells=[2, 2], Tessellation="quad", Units="cm", Program=sys.argv[3])
fit.UpdatePipeline()
sheet = servermanager.Fetch(fit)
holes = HoleCurvature(Input=fit, Program=sys.argv[3])
holes.UpdatePipeline()
found = servermanager.Fetch(holes)
names = [found.GetCellData().GetArrayName(k) for k in range(found.GetCellData().GetNumberOfArrays())]
cells = [sheet.GetBlock(k).GetNumberOfCells() for k in range(sheet.GetNumberOfBlocks())]
curvature = vtk_to_numpy(found.GetCellData().GetArray("gaussian_curvature")).tolist()
fit.MoreOptions = "--tolerance never"
fit.UpdatePipeline()
answer({"cells": cells, "verdict": sheet.GetFieldData().GetAbstractArray("verdict").GetValue(0), "names": names,
        "curvature": curvature, "after": servermanager.Fetch(fit).GetNumberOfBlocks(),
        "offered": list(fit.GetProperty("Tessellation").GetAvailable())})
"""


@pytest.mark.slow
def test_the_plugin_in_paraview(pvpython: Ask, program_path: str, tmp_path: Path) -> None:
    hypar().save(tmp_path / "hypar.vtp")
    seen = pvpython(_IN_PARAVIEW, PLUGIN, tmp_path / "hypar.vtp", program_path)
    n_holes = len(seen["curvature"])
    assert seen["verdict"] == "certified" and n_holes == 9
    assert seen["cells"] == [16, n_holes, len(read_surface(tmp_path / "hypar.vtp").faces), 16]
    # z = x y / 2 has K = -1/4 in the middle and K = -1/9 at the corners
    assert -0.3 < min(seen["curvature"]) <= max(seen["curvature"]) < -0.1
    assert {"mean_curvature", "target_gaussian_curvature", "flag"} <= set(seen["names"])
    assert seen["after"] == 0 and "Kirigami Fit: --tolerance: expected a number" in seen["log"]
    assert "Traceback" not in seen["log"]


def test_the_menu_offers_every_tessellation_of_the_catalog() -> None:
    from kirisurf.tessellation_names import tessellation_names

    assert set(kirisurf_filters._TESSELLATIONS) == set(tessellation_names())


_SHOWN = """
import runpy
simple.LoadPlugin(sys.argv[1], remote=False)
show = runpy.run_path(sys.argv[2])
source = simple.OpenDataFile(sys.argv[3])
source.UpdatePipeline()
data = servermanager.Fetch(source)
holes = data.GetBlock(1)
answer({name: show["unit_of"](holes, name) for name in ("gaussian_curvature", "opening_angle", "flag", "nothing")})
"""


def test_the_script_knows_the_units(pvpython: Ask, run: Run) -> None:
    seen = pvpython(_SHOWN, PLUGIN, PLUGIN.with_name("show_run.py"), run.folder / "run.vtm")
    del seen["log"]
    assert seen == {"gaussian_curvature": "1/mm²", "opening_angle": "rad", "flag": "", "nothing": ""}
