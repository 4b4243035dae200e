"""`kirisurf curvature`: tables for people and programs, files that hold the same numbers, other constructions."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from kirisurf.cli import main
from kirisurf.formats import source
from kirisurf.formats.vtk_files import read_with_fields
from kirisurf.runs import read_run

Captured = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    where = tmp_path_factory.mktemp("cli") / "a <run> & more"
    assert main(["fit", "hypar", "-o", str(where), "--cells", "2x2", "--units", "mm", "--no-pictures", "-q"]) == 0
    return where


@pytest.fixture(scope="module")
def outline(tmp_path_factory: pytest.TempPathFactory) -> Path:
    where = tmp_path_factory.mktemp("cli") / "outline"
    assert main(["fit", "circle", "-o", str(where), "--cells", "2x2", "--no-pictures", "-q"]) == 0
    return where


def cells(path: Path) -> list[dict[str, str]]:
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_files_hold_the_numbers_of_the_run(folder: Path, tmp_path: Path) -> None:
    names = [str(tmp_path / f"holes.{suffix}") for suffix in ("csv", "json", "vtp")]
    assert main(["curvature", str(folder), "--to", *names, "-q"]) == 0
    assert Path(names[0]).read_bytes() == (folder / "curvature.csv").read_bytes()
    found = json.loads(Path(names[1]).read_text())
    measures = read_run(folder).result["measures"]
    assert found["units"] == "mm" and found["numbers"].items() <= measures.items()
    assert all(name in found["numbers"] for name in measures if "curvature" in name)
    rows = cells(Path(names[0]))
    for row, told in zip(rows, found["holes"], strict=True):
        assert all((told[name] is None) == (cell == "") for name, cell in row.items())
        assert all(float(cell) == told[name] for name, cell in row.items() if cell)
    fields = read_with_fields(source.load(Path(names[2]))).cell_fields
    for name in ("gaussian_curvature", "target_gaussian_curvature", "angle_defect"):
        values = [float(row[name] or "nan") for row in rows]
        np.testing.assert_array_equal(fields[name].ravel(), values)


def test_summaries_are_said_in_words_with_units(folder: Path, capsys: Captured) -> None:
    assert main(["curvature", str(folder)]) == 0
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 1 + read_run(folder).result["holes"]
    assert "median of |K of a hole - K of the target|" in err and "1/mm\u00b2" in err
    assert "_" not in err


def test_several_runs_stand_side_by_side(folder: Path, outline: Path, tmp_path: Path, capsys: Captured) -> None:
    both = [str(folder), str(outline)]
    assert main(["curvature", *both, "--to", str(tmp_path / "both.csv"), str(tmp_path / "both.json")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3 and lines[1].startswith("a <run> & more") and lines[2].startswith("outline")
    rows = cells(tmp_path / "both.csv")
    assert {row["run"] for row in rows} == {folder.name, "outline"}
    assert [row["hole"] for row in rows if row["run"] == "outline"] == [
        row["hole"] for row in cells(outline / "curvature.csv")
    ]
    assert [run["name"] for run in json.loads((tmp_path / "both.json").read_text())["runs"]] == [folder.name, "outline"]
    assert main(["curvature", *both, "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["runs"]) == 2
    assert main(["curvature", *both, "--to", str(tmp_path / "both.vtp")]) == 2
    assert "-o DIR" in capsys.readouterr().err and not (tmp_path / "both.vtp").exists()


@pytest.mark.parametrize("how", ["corners", "corners_and_normals"])
def test_other_constructions_change_the_patches_and_nothing_else(folder: Path, tmp_path: Path, how: str) -> None:
    path = tmp_path / "other.csv"
    assert main(["curvature", str(folder), "--patches", how, "--to", str(path), "-q"]) == 0
    usual, other = cells(folder / "curvature.csv"), cells(path)
    for name in ("angle_defect", "gauss_image_area", "target_integrated_gaussian_curvature_cell"):
        a, b = (np.array([float(row[name] or "nan") for row in rows]) for rows in (usual, other))
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-12)
    a, b = (np.array([float(row["gaussian_curvature"]) for row in rows]) for rows in (usual, other))
    assert not np.allclose(a, b, rtol=1e-3)
    if how == "corners":
        # four corners of a square cannot tell a bowl from a plane
        assert (b < 1e-6).all()


def test_a_folder_gets_tables_and_maps(
    folder: Path, outline: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    from viewers import opengl, snapshot

    assert snapshot.probe is opengl.probe
    monkeypatch.setattr(opengl, "probe", lambda: opengl.OpenGL(False, "", "no OpenGL here: install it"))
    assert main(["curvature", str(folder), str(folder), "-o", str(tmp_path / "out")]) == 1
    assert "no OpenGL here" in capsys.readouterr().err
    written = sorted(path.relative_to(tmp_path / "out") for path in (tmp_path / "out").rglob("*.*") if path.is_file())
    names = ("curvature.csv", "curvature.json", "holes.vtp")
    assert written == sorted(Path(run) / name for run in (folder.name, f"{folder.name}-2") for name in names)


@pytest.mark.slow
def test_maps_are_drawn(folder: Path, tmp_path: Path, opengl: None) -> None:
    assert main(["curvature", str(folder), "--maps", str(tmp_path / "maps"), "--patches", "corners", "-q"]) == 0
    drawn = {path.stem for path in (tmp_path / "maps").iterdir()}
    assert {"gaussian_curvature", "target_gaussian_curvature", "gaussian_curvature_difference", "residence"} <= drawn


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--patches", "bezier"], "--patches: expected one of tiles, corners, corners_and_normals, got 'bezier'"),
        (["--to", "x.xlsx"], "expected a suffix among .csv, .json, .vtp, got .xlsx"),
    ],
)
def test_mistakes_are_named_before_anything_is_written(
    folder: Path, more: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["curvature", str(folder), *more]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
    assert main(["curvature", str(folder), "--to", str(tmp_path / "no" / "such.csv"), "-q"]) == 7
