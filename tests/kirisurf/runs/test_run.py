"""Run folders of real designs: every file present and true, read back exactly, refused when damaged."""

from __future__ import annotations

import csv
import json
import math
import shutil
from dataclasses import fields as dataclass_fields
from pathlib import Path

import numpy as np
import pytest

import kirisurf
from analysis.certificate import certify
from analysis.limits import ROWS
from kirisurf.design import Design, fit_loaded
from kirisurf.errors import UnreadableError
from kirisurf.formats import read_polygons
from kirisurf.loops import Loops
from kirisurf.runs import Run, read_run
from kirisurf.runs.record import SECONDS, sha256
from kirisurf.spec import FitSpec
from kirisurf.surface import Surface

DATA = {
    "run.toml",
    "deployed.obj",
    "contracted.obj",
    "deployed.vtp",
    "contracted.vtp",
    "holes.vtp",
    "target.vtp",
    "run.vtm",
    "curvature.csv",
    "thumbnail.png",
    "pattern.svg",
    "report.html",
}


@pytest.fixture(scope="module")
def design() -> Design:
    return kirisurf.fit("hypar", cells=(2, 2), units="cm")


@pytest.fixture(scope="module")
def run(design: Design, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return design.save(tmp_path_factory.mktemp("runs") / "hypar", pictures=False)


@pytest.fixture
def copy(run: Run, tmp_path: Path) -> Path:
    shutil.copytree(run.folder, tmp_path / "copy")
    return tmp_path / "copy"


def test_the_folder_holds_every_file_with_its_hash(run: Run) -> None:
    assert set(run.result["files"]) == DATA
    assert {path.name for path in run.folder.iterdir()} == DATA | {"result.json"}
    for name, value in run.result["files"].items():
        assert sha256(run.folder / name) == value


def test_the_record_says_what_the_interface_promises(run: Run) -> None:
    result = run.result
    assert result["status"] == "CONVERGED" and result["exit_code"] == 0 and result["certified"]
    assert tuple(result["certificate"]) == ROWS
    assert tuple(result["seconds"]) and set(SECONDS) <= set(result["seconds"])
    parts = sum(result["seconds"][name] for name in SECONDS if name != "total")
    assert result["seconds"]["total"] == pytest.approx(parts)
    assert (result["tiles"], result["vertices"]) == (16, run.tessellation.n_vertices)
    assert result["holes"] == len(run.tessellation.holes) and result["iterations"] == len(result["history"])
    assert {"kirisurf", "numpy", "scipy", "libigl", "python"} <= set(result["versions"])


def test_the_certificate_is_what_the_files_give(run: Run, design: Design) -> None:
    deployed, tiles = read_polygons(run.folder / "deployed.obj")
    contracted, same = read_polygons(run.folder / "contracted.obj")
    assert np.array_equal(tiles.indices, same.indices)
    again = certify(deployed, contracted, tiles, design.surface)
    assert dict(again.rows) == run.certificate
    assert again.edge_length == run.result["edge_length"]


def test_the_run_reads_back_to_the_last_bit(run: Run, design: Design) -> None:
    assert run.spec == design.spec
    assert np.array_equal(run.deployed, design.deployed_points)
    assert np.array_equal(run.contracted, design.contracted_points)
    assert np.array_equal(run.target.vertices, design.surface.vertices)
    assert np.array_equal(run.target.faces, design.surface.faces)
    for field in dataclass_fields(design.tessellation):
        saved, meant = getattr(run.tessellation, field.name), getattr(design.tessellation, field.name)
        if isinstance(meant, Loops):
            saved, meant = (saved.offsets, saved.indices), (meant.offsets, meant.indices)
        if field.name == "sides":
            assert saved.keys() == meant.keys()
            saved, meant = tuple(saved.values()), tuple(meant.values())
        if isinstance(meant, tuple):
            assert all(np.array_equal(a, b) for a, b in zip(saved, meant, strict=True)), field.name
        else:
            assert np.array_equal(saved, meant), field.name


def test_every_measured_field_is_in_the_files(run: Run, design: Design) -> None:
    for key, values in design.measures.fields.items():
        assert np.array_equal(run.fields[key], values, equal_nan=True), key


def test_the_table_has_a_row_for_every_hole(run: Run, design: Design) -> None:
    with open(run.folder / "curvature.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(design.tessellation.holes)
    for row, meant in zip(rows, design.measures.tables["holes"], strict=True):
        for name, value in meant.items():
            read = float(row[name]) if row[name] else math.nan
            assert read == value or (math.isnan(read) and math.isnan(value)), name


def test_the_same_input_gives_the_same_bytes(run: Run, design: Design, tmp_path: Path) -> None:
    again = kirisurf.fit(run.spec).save(tmp_path / "again", pictures=False)
    for name in DATA:
        assert (again.folder / name).read_bytes() == (run.folder / name).read_bytes(), name
    first, second = dict(run.result), dict(again.result)
    del first["seconds"], second["seconds"]
    assert first == second


@pytest.mark.parametrize("name", ["run.toml", "deployed.obj", "contracted.obj", "holes.vtp", "target.vtp"])
def test_a_changed_or_missing_file_is_refused(copy: Path, name: str) -> None:
    with open(copy / name, "a") as file:
        file.write(" ")
    with pytest.raises(UnreadableError, match=rf"{name}.*changed since"):
        read_run(copy)
    (copy / name).unlink()
    with pytest.raises(UnreadableError, match=rf"{name}.*got none, or no plain file"):
        read_run(copy)


def test_what_is_no_run_is_refused(copy: Path, tmp_path: Path) -> None:
    with pytest.raises(UnreadableError, match="does not exist"):
        read_run(tmp_path / "nowhere")
    with pytest.raises(UnreadableError, match="got a file"):
        read_run(copy / "run.toml")
    record = copy / "result.json"
    for text, message in (("{", "record of a run"), ("[]", "another file"), ('{"files": {}}', "another file")):
        record.write_text(text)
        with pytest.raises(UnreadableError, match=message):
            read_run(copy)
    record.unlink()
    with pytest.raises(UnreadableError, match="no finished run"):
        read_run(copy)


def test_a_target_far_away_is_moved_to_a_round_origin(tmp_path: Path) -> None:
    near = kirisurf.load("hypar", resolution=30)
    offset = np.array([3.0e6, -2.0e6, 1.0e5])
    far = Surface.from_arrays(near.vertices + offset, near.faces, "far")
    spec = FitSpec("far.obj", cells=(2, 2))
    moved = fit_loaded(spec, far).save(tmp_path / "far", pictures=False)
    assert moved.origin.tolist() == offset.tolist()
    assert moved.result["certified"]
    assert "# origin: 3000000.0 -2000000.0 100000.0" in (tmp_path / "far" / "deployed.obj").read_text()
    # the same rounded coordinates, but near the origin from the start
    plain = fit_loaded(spec, Surface.from_arrays(far.vertices - offset, near.faces, "near"))
    assert not plain.origin.any()
    assert np.array_equal(moved.deployed, plain.deployed_points)
    # the audit of the files against the far target finds the origin in the comment
    audited = kirisurf.audit(
        tmp_path / "far" / "deployed.obj", tmp_path / "far" / "contracted.obj", (far.vertices, far.faces)
    )
    assert audited.passed and audited.rows["distance_max"] == pytest.approx(moved.certificate["distance_max"], rel=1e-6)


def test_a_solve_that_was_stopped_is_saved_with_its_reason(tmp_path: Path) -> None:
    run = kirisurf.fit("hypar", cells=(2, 2), max_steps=1).save(tmp_path / "limit", pictures=False)
    assert run.result["status"] == "STEP_LIMIT" and run.result["exit_code"] == 6 and not run.result["certified"]
    assert run.certificate["closure"] is not None and run.certificate["closure"] < 1
    stopped = kirisurf.fit("hypar", cells=(2, 2), should_stop=lambda: True).save(tmp_path / "stop", pictures=False)
    assert stopped.result["status"] == "INTERRUPTED" and stopped.result["exit_code"] == 130


def test_a_hinge_width_that_does_not_fit_is_said_and_nothing_is_lost(tmp_path: Path) -> None:
    run = kirisurf.fit("hypar", cells=(2, 2), hinge_width=5.0).save(tmp_path / "wide", pictures=False)
    assert run.result["exit_code"] == 1 and "--hinge-width" in run.result["warnings"][0]
    assert (run.folder / "pattern.svg").stat().st_size > 0


def test_without_opengl_the_report_says_so(tmp_path: Path, design: Design, monkeypatch: pytest.MonkeyPatch) -> None:
    from viewers import opengl, snapshot

    # loaded before the patch, so that it keeps the true probe afterwards
    assert snapshot.probe is opengl.probe

    monkeypatch.setattr(opengl, "probe", lambda: opengl.OpenGL(False, "", "Pictures cannot be drawn: no OpenGL here."))
    run = design.save(tmp_path / "dark")
    assert run.result["exit_code"] == 1 and run.result["certified"]
    assert run.result["warnings"] == ["Pictures cannot be drawn: no OpenGL here."]
    assert [path.name for path in run.folder.glob("*.png")] == ["thumbnail.png"]
    assert "no OpenGL here" in (run.folder / "report.html").read_text()


@pytest.mark.slow
def test_pictures_are_drawn_and_listed(tmp_path: Path, design: Design, opengl: None) -> None:
    run = design.save(tmp_path / "bright")
    from kirisurf.publishing import PICTURES

    names = set(PICTURES)
    assert set(run.result["files"]) == DATA | {f"{name}.png" for name in names}
    assert json.loads((run.folder / "result.json").read_text())["exit_code"] == 0
