"""`kirisurf deploy`: files that are complete and read back, the exit code of every mistake, and nothing lost."""

from __future__ import annotations

import csv
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import kirisurf
from kirisurf import cli, deploying
from kirisurf.deployment import deploy_run
from kirisurf.deployment_folder import read_deployment
from kirisurf.deployment_tables import COLUMNS
from kirisurf.formats import read_polygons
from kirisurf.formats.source import load
from kirisurf.formats.vtk_files import read_with_fields
from kirisurf.runs import read_run
from kirisurf.runs.record import sha256

Captured = pytest.CaptureFixture[str]
STEPS, LAMBDAS = 8, ("0", "0.001")
WORDS = ("--steps", str(STEPS), "--lambda", *LAMBDAS)
STATES = STEPS + 1


@pytest.fixture(scope="module")
def disc(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run whose sheet is planar, and no mechanism."""
    made = tmp_path_factory.mktemp("runs") / "disc"
    kirisurf.fit("circle", cells=(2, 2), contracted="rectangle:1").save(made, pictures=False)
    return made


@pytest.fixture(scope="module")
def answer(disc: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, object], Path]:
    """What --json prints, and the folder."""
    import contextlib
    import io

    folder = tmp_path_factory.mktemp("out") / "way"
    with contextlib.redirect_stdout(io.StringIO()) as out:
        code = cli.main(["--json", "-q", "deploy", str(disc), *WORDS, "-o", str(folder)])
    printed = json.loads(out.getvalue())
    assert printed["exit_code"] == code and code in (0, 1)
    assert (code == 1) is bool(printed["warnings"])
    return printed, folder


def test_all_files_are_there_with_their_hashes(answer: tuple[dict[str, object], Path], disc: Path) -> None:
    printed, folder = answer
    record = json.loads((folder / "deployment.json").read_text())
    pieces = {f"deployment_pvd/{k:04d}_{part}.vtp" for k in range(STATES) for part in ("tiles", "holes")}
    names = {"deployment.csv", "deployment.png", "deployment.gif", "deployment.pvd"}
    assert set(record["files"]) == names | pieces
    assert all(sha256(folder / name) == found for name, found in record["files"].items())
    assert {entry.name for entry in folder.iterdir()} == names | {"deployment.json", "deployment_pvd"}
    assert [path["lambda"] for path in record["paths"]] == [0.0, 0.001]
    assert record["paths"] == printed["paths"]
    assert record["key"]["deployed.obj"] == read_run(disc).result["files"]["deployed.obj"]
    assert record["versions"]["kirisurf"] == kirisurf.__version__


def test_the_table_holds_the_very_numbers(answer: tuple[dict[str, object], Path], disc: Path) -> None:
    _, folder = answer
    with open(folder / "deployment.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == COLUMNS and len(rows) == 2 * STATES
    found = deploy_run(read_run(disc), torsion=(0.0, 0.001), steps=STEPS)
    for k, path in enumerate(found.paths):
        mine = rows[k * STATES : (k + 1) * STATES]
        wanted = {
            "fraction": path.fractions,
            "energy": path.stretch_energies + path.torsion_energies,
            "stretch_energy": path.stretch_energies,
            "torsion_energy": path.torsion_energies,
            "largest_strain": path.largest_strains,
            "opening": path.mean_openings,
            "residual": path.residuals,
        }
        for name, values in wanted.items():
            # the command computes on one thread of BLAS, as this run of tests does
            np.testing.assert_allclose([float(row[name]) for row in mine], values, rtol=1e-9, atol=1e-15)
        assert {float(row["lambda"]) for row in mine} == {path.torsion}


def test_the_series_holds_the_states_with_strain_and_openings(
    answer: tuple[dict[str, object], Path], disc: Path
) -> None:
    _, folder = answer
    run = read_run(disc)
    with open(folder / "deployment.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))[:STATES]
    index = (folder / "deployment.pvd").read_text()
    assert index.count("<DataSet ") == 2 * STATES and 'timestep="1.0"' in index
    for k, row in enumerate(rows):
        frame = folder / "deployment_pvd" / f"{k:04d}_tiles.vtp"
        read, (points, tiles) = read_with_fields(load(frame)), read_polygons(frame)
        assert len(points) == run.tessellation.n_vertices and len(tiles) == run.tessellation.n_tiles
        assert np.abs(read.cell_fields["tile_strain"]).max() == float(row["largest_strain"])
        widest = read.point_fields["hinge_opening"]
        assert np.nanmax(widest) >= float(row["opening"]) - 1e-12
    last = points - points.mean(axis=0)
    np.testing.assert_allclose(last, run.deployed - run.deployed.mean(axis=0), atol=1e-6)


def test_figure_and_film_are_pictures(answer: tuple[dict[str, object], Path]) -> None:
    _, folder = answer
    with Image.open(folder / "deployment.png") as figure:
        assert figure.width > 1000 and len(figure.convert("RGB").getcolors(1 << 24)) > 20
    with Image.open(folder / "deployment.gif") as film:
        # there and back, the ends once each
        assert film.n_frames == 2 * STATES - 2


def test_a_second_time_replaces_and_the_run_stays_as_it_was(disc: Path, capsys: Captured) -> None:
    before = {entry.name: sha256(entry) for entry in disc.iterdir() if entry.is_file()}
    assert cli.main(["deploy", str(disc), *WORDS]) in (0, 1)
    out, err = capsys.readouterr()
    folder = disc / "deployment"
    assert out.strip() == str(folder / "deployment.png")
    assert "lambda 0:" in err and "lambda 0.001:" in err and "rests open by itself" in err
    again = ["-q", "deploy", str(disc), "--steps", "3", "--lambda", "0", "--no-animation", "--drive", "rim"]
    assert cli.main([*again, "--trajectory", "straight"]) in (0, 1)
    assert not (folder / "deployment.gif").exists()
    assert len(list((folder / "deployment_pvd").iterdir())) == 2 * 4
    record = read_deployment(read_run(disc))
    assert record is not None and record["options"]["drive"] == "rim" and len(record["paths"]) == 1
    assert {entry.name: sha256(entry) for entry in disc.iterdir() if entry.is_file()} == before
    shutil.rmtree(folder)


def test_a_deployment_of_other_states_is_not_taken_for_the_runs(
    answer: tuple[dict[str, object], Path], disc: Path, tmp_path: Path
) -> None:
    _, folder = answer
    run = read_run(disc)
    assert read_deployment(run, folder) is not None
    assert read_deployment(run, tmp_path) is None
    record = json.loads((folder / "deployment.json").read_text())
    record["key"]["deployed.obj"] = "0" * 64
    (tmp_path / "deployment.json").write_text(json.dumps(record))
    assert read_deployment(run, tmp_path) is None
    (tmp_path / "deployment.json").write_text("{")
    with pytest.raises(kirisurf.UnreadableError, match="expected the record of a deployment"):
        read_deployment(run, tmp_path)


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["--lambda", "-1"], 2, "lambda: expected a number of at least 0, got -1.0"),
        (["--lambda", "nan"], 2, "lambda: expected a number of at least 0, got nan"),
        (["--steps", "0"], 2, "steps: expected a whole number from 2"),
        (["--steps", "two"], 2, "--steps: expected a whole number, got 'two'"),
        (["--drive", "rope"], 2, "drive: expected one of free, rim, corners, got 'rope'"),
        (["--drive", "rim", "--trajectory", "zigzag"], 2, "expected one of turning, rigid, straight, got 'zigzag'"),
        (["--trajectory", "straight"], 2, "trajectory: expected with a drive that moves vertices"),
        (["--thickness", "-2"], 2, "thickness: expected a number of at least 0, got -2.0"),
        (["--thickness", "1e6"], 2, "thickness: expected a number from 0 to"),
        (["--hinge-width", "-1"], 2, "width: expected a number above 0, got -1.0"),
        (["--hinge-width", "100"], 2, "hinge width: expected less than a tile edge"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_wrong_option_is_refused_before_all_work(
    words: list[str], code: int, message: str, disc: Path, capsys: Captured
) -> None:
    assert cli.main(["deploy", str(disc), *words]) == code
    assert message in capsys.readouterr().err
    assert not (disc / "deployment").exists()


def test_a_hinge_has_the_lambda_of_its_width(disc: Path, tmp_path: Path, capsys: Captured) -> None:
    words = ["--hinge-width", "0.01", "--steps", "3", "--no-animation", "-o", str(tmp_path / "way")]
    assert cli.main(["deploy", str(disc), *words]) in (0, 1)
    record = json.loads((tmp_path / "way" / "deployment.json").read_text())
    none, some = (path["lambda"] for path in record["paths"])
    assert none == 0.0 and some > 0.0
    assert f"ligaments 0.01 {record['units']} wide: lambda about {some:.3g}" in capsys.readouterr().err
    # lambda grows as the square of the width
    wide, at = record["transition_hinge_width"], record["transition_lambda"]
    assert wide == pytest.approx(0.01 * (at / some) ** 0.5, rel=1e-9)


def test_a_run_that_is_none_or_has_no_certificate_is_refused(disc: Path, tmp_path: Path, capsys: Captured) -> None:
    assert cli.main(["deploy", str(tmp_path / "nosuch")]) == 3
    assert "expected a run folder" in capsys.readouterr().err
    copy = tmp_path / "copy"
    shutil.copytree(disc, copy)
    record = json.loads((copy / "result.json").read_text())
    record["certified"] = False
    (copy / "result.json").write_text(json.dumps(record))
    assert cli.main(["deploy", str(copy), *WORDS]) == 4
    assert "expected a certified run" in capsys.readouterr().err
    assert not (copy / "deployment").exists()


def _holding_a_file(folder: Path) -> Path:
    folder.mkdir()
    (folder / "thesis.txt").write_text("years")
    return folder


def _a_file(folder: Path) -> Path:
    folder.write_text("years")
    return folder


@pytest.mark.parametrize(("make", "code"), [(_holding_a_file, 2), (_a_file, 7)])
def test_a_folder_that_is_somebody_elses_is_left_alone(
    make: Callable[[Path], Path], code: int, disc: Path, tmp_path: Path, capsys: Captured
) -> None:
    folder = make(tmp_path / "taken")
    assert cli.main(["deploy", str(disc), *WORDS, "-o", str(folder)]) == code
    assert "expected" in capsys.readouterr().err
    kept = folder / "thesis.txt" if folder.is_dir() else folder
    assert kept.read_text() == "years" and len(list(tmp_path.rglob("*"))) == 1 + (kept != folder)


@pytest.mark.skipif(os.geteuid() == 0, reason="did not run: the superuser may write everywhere")
def test_a_folder_that_cannot_be_written_is_told(disc: Path, tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        assert cli.main(["deploy", str(disc), *WORDS, "-o", str(tmp_path / "way")]) == 7
    finally:
        tmp_path.chmod(0o700)


@pytest.mark.parametrize(("problem", "code"), [(KeyboardInterrupt(), 130), (OSError(28, "No space left on device"), 7)])
@pytest.mark.parametrize("where", ["deploy_with_collisions", "save_deployment"])
def test_what_ends_in_the_middle_leaves_the_earlier_deployment(
    problem: BaseException, code: int, where: str, disc: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "way"
    words = ["-q", "deploy", str(disc), "--steps", "2", "--lambda", "0", "--no-animation", "-o", str(folder)]
    assert cli.main(words) in (0, 1)
    before = {entry: entry.read_bytes() for entry in folder.rglob("*") if entry.is_file()}

    def fail(*args: object, **options: object) -> None:
        raise problem

    inner = {"deploy_with_collisions": "deploy_run", "save_deployment": "picture"}[where]
    monkeypatch.setattr(deploying, inner, fail)
    assert cli.main(words) == code
    assert {entry: entry.read_bytes() for entry in folder.rglob("*") if entry.is_file()} == before
