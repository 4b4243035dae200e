"""`kirisurf audit --holes` and the exports that write several files: what they write, and what they refuse."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import pyvista

import kirisurf
from kirisurf import cli
from kirisurf.runs import Run

Captured = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return kirisurf.fit("hypar", cells=(2, 2), units="mm").save(tmp_path_factory.mktemp("runs") / "h", pictures=False)


@pytest.mark.parametrize("kind", ["vtp", "obj"])
def test_the_holes_of_two_states(run: Run, tmp_path: Path, kind: str, capsys: Captured) -> None:
    states = [str(run.folder / f"{name}.{kind}") for name in ("deployed", "contracted")]
    words = ["audit", *states, "--target", str(run.folder / "target.vtp"), "--holes", str(tmp_path / "h.vtp")]
    assert cli.main(["--json", *words]) == 0
    assert json.loads(capsys.readouterr().out)["passed"] is True
    holes = pyvista.read(tmp_path / "h.vtp")
    # the run knew the formula of the target, here only its mesh is known
    for name, near in (("gaussian_curvature", 1e-6), ("opening_angle", 1e-6), ("target_gaussian_curvature", 1e-2)):
        assert sorted(holes.cell_data[name]) == pytest.approx(sorted(run.fields["hole", name]), rel=near, abs=1e-9)
    units = dict(zip(holes.field_data["field"], holes.field_data["field_unit"], strict=True))
    assert units["gaussian_curvature"] == ("1/mm²" if kind == "vtp" else "1/unit²")


def test_the_holes_need_a_file_that_can_hold_fields(run: Run, tmp_path: Path, capsys: Captured) -> None:
    states = [str(run.folder / f"{name}.obj") for name in ("deployed", "contracted")]
    assert cli.main(["audit", *states, "--holes", str(tmp_path / "h.obj")]) == 2
    assert "--holes: expected a file that ends in .vtp, got" in capsys.readouterr().err
    assert cli.main(["audit", *states, "--holes", str(tmp_path / "nowhere" / "h.vtp")]) == 7
    assert list(tmp_path.iterdir()) == []


def test_blocks_and_a_series_from_the_command_line(run: Run, tmp_path: Path, capsys: Captured) -> None:
    names = [str(tmp_path / name) for name in ("s.vtm", "o.pvd")]
    words = ["--json", "export", str(run.folder), "--to", *names, "--frames", "3"]
    assert cli.main(words) == 0
    assert json.loads(capsys.readouterr().out)["files"] == names
    assert pyvista.read(names[0]).keys() == ["tiles", "holes", "target", "contracted"]
    assert pyvista.get_reader(names[1]).time_values == [0.0, 0.5, 1.0]
    assert cli.main(words) == 2
    assert "--overwrite replaces it" in capsys.readouterr().err
    assert cli.main([*words, "--overwrite"]) == 0


@pytest.mark.parametrize("frames", ["1", "0", "-3", "1001", "many", "2.5"])
def test_a_wrong_number_of_frames(run: Run, tmp_path: Path, frames: str, capsys: Captured) -> None:
    assert cli.main(["export", str(run.folder), "--to", str(tmp_path / "o.pvd"), f"--frames={frames}"]) == 2
    assert "--frames: expected a" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_meshes_of_a_design_say_their_units() -> None:
    design = kirisurf.fit("hypar", cells=(2, 2), units="cm")
    for state, mesh in (("deployed", design.deployed), ("contracted", design.contracted), ("holes", design.holes)):
        said = mesh.field_data
        assert (
            said["state"][0] == state
            and said["unit_of_length"][0] == "cm"
            and np.array_equal(said["origin"][0], [0] * 3)
        )
        assert sorted(said["field"]) == sorted({*mesh.point_data, *mesh.cell_data})
    assert "1/cm²" in list(said["field_unit"])
