"""`kirisurf reproduce`: tables and figures by one command, and what is refused before all work."""

from __future__ import annotations

import csv
import json
import os
from pathlib import Path

import numpy as np
import pytest

import kirisurf.cli as cli
from kirisurf.formats import write_obj
from kirisurf.reproducing import Numbers, Reproduced, Wanted

Captured = pytest.CaptureFixture[str]


@pytest.fixture
def published_pair(tmp_path: Path) -> Path:
    """A folder of reference files with one pair in it: the regular sheet, contracted."""
    from kirisurf.pattern import quad_pattern

    folder = tmp_path / "reference"
    (folder / "2d").mkdir(parents=True)
    pattern = quad_pattern(4, 4)
    stem = folder / "2d" / "quad_circle_w2_h2_i3_f1_r1"
    write_obj(Path(f"{stem}_deployed.obj"), pattern.deployed, pattern.tiles)
    write_obj(Path(f"{stem}_contracted.obj"), pattern.contracted, pattern.tiles)
    return folder


def test_a_published_configuration_is_made_certified_and_tabled(
    tmp_path: Path, published_pair: Path, capsys: Captured
) -> None:
    folder = tmp_path / "made"
    words = ["reproduce", "published", "-o", str(folder), "--match", "quad_circle_2x2"]
    assert cli.main([*words, "--reference", str(published_pair)]) == 0
    out, err = capsys.readouterr()
    assert out.strip() == str(folder / "published.html") and "1 of 1 designs reproduced" in err
    names = {"published.csv", "published.json", "published.html", "designs"}
    assert {path.name for path in folder.iterdir()} == names
    (row,) = csv.DictReader((folder / "published.csv").read_text().splitlines())
    assert row["name"] == "quad_circle_2x2_1" and row["certified"] == "True"
    assert max(float(row[name]) for name in ("rigid", "closure", "boundary", "contracted_boundary")) <= 1e-9
    assert float(row["published_rigid"]) <= 1e-9 and float(row["published_smallest_edge"]) == pytest.approx(1)
    (record,) = json.loads((folder / "published.json").read_text())["designs"]
    assert record["tiles"] == 16 and record["contracted_option"] == "rectangle:1"
    page = (folder / "published.html").read_text()
    assert "1 of 1 configurations certified" in page and "Published files" in page and "data:image/png" in page
    states = [str(folder / "designs" / f"quad_circle_2x2_1_{state}.obj") for state in ("deployed", "contracted")]
    assert cli.main(["audit", *states]) == 0
    # a second time only where the user says so
    assert cli.main(words) == 2
    assert "--overwrite writes there" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["fig9"], 2, "WHAT: expected one of published, fig1, fig2, fig2a, fig2b, fig2c, fig3, fig4, got 'fig9'"),
        (["published", "--only", "4d"], 2, "--only: expected one of 2d, 3d, got '4d'"),
        (["published", "--match", "moon"], 2, "--match: expected a part of a name such as hexagon_anvil"),
        (["published", "--closeness", "near"], 2, "--closeness: expected one of best, exact, got 'near'"),
        (["published", "--jobs", "0"], 2, "--jobs: expected at least 1, got 0"),
        (["published", "--jobs", "all"], 2, "--jobs: expected a whole number, got 'all'"),
        (["published", "--largest", "4"], 2, "--largest: expected with fig2c or fig2 only, got 4 with published"),
        (["fig2a", "--only", "2d"], 2, "--only: expected with published only"),
        (["fig2c", "--largest", "2"], 2, "--largest: expected at least 3, got 2"),
        (["published", "--reference", "nowhere"], 3, "--reference: expected a folder with 2d, 3d and targets"),
        (["published", "--reference", "."], 3, "expected 2d or 3d with files *_deployed.obj, got none"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_mistake_is_refused_before_anything_is_written(
    words: list[str], code: int, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["reproduce", *words, "-o", "made"]) == code
    out, err = capsys.readouterr()
    assert out == "" and message in err.rstrip().splitlines()[-1]
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("what", ["published", "fig1", "fig2", "fig2a", "fig2c", "fig3", "fig4"])
def test_a_folder_that_cannot_be_written_is_told_before_all_work(what: str, tmp_path: Path, capsys: Captured) -> None:
    (tmp_path / "file").write_text("mine")
    assert cli.main(["reproduce", what, "-o", str(tmp_path / "file")]) == 7
    assert cli.main(["reproduce", what, "-o", str(tmp_path / "file" / "below")]) == 7
    assert "expected a folder to write to" in capsys.readouterr().err
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="not tried: root writes everywhere")
def test_a_read_only_folder_is_an_output_error(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        assert cli.main(["reproduce", "fig2a", "-o", str(tmp_path)]) == 7
    finally:
        tmp_path.chmod(0o700)


def test_what_was_not_reproduced_is_listed_with_its_reasons(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    def poor(wanted: list[Wanted], jobs: int) -> object:
        numbers = Numbers(True, 1e-3, 1e-3, 0.0, None, None, 0.5, None, None)
        yield Reproduced(wanted[0].name, "CONVERGED", 16, 1.0, numbers, {}, None)

    monkeypatch.setattr("kirisurf.cli.reproduce_results.all_reproduced", poor)
    words = ["reproduce", "published", "-o", str(tmp_path / "made"), "--match", "quad_circle_2x2", "--json"]
    assert cli.main(words) == 8
    out, err = capsys.readouterr()
    assert "quad_circle_2x2_1: rows: expected at most 1e-09, got 0.001" in err
    printed = json.loads(out)
    assert printed["exit_code"] == 8 and list(printed["failed"]) == ["quad_circle_2x2_1"]
    assert "0 of 1 configurations certified" in (tmp_path / "made" / "published.html").read_text()


def test_missing_published_files_leave_dashes(tmp_path: Path, published_pair: Path) -> None:
    folder = tmp_path / "made"
    words = ["reproduce", "published", "-o", str(folder), "--match", "kagome_rainbow_2x2", "--reference"]
    assert cli.main([*words, str(published_pair)]) == 0
    (record,) = json.loads((folder / "published.json").read_text())["designs"]
    assert record["published_rigid"] is None and "triangle_rainbow_w2_h2_i1_f0_r0" in record["published_files"]


@pytest.mark.slow
def test_circling_the_square_is_drawn_with_its_slopes(tmp_path: Path, capsys: Captured) -> None:
    folder = tmp_path / "made"
    assert cli.main(["reproduce", "fig2c", "-o", str(folder), "--largest", "3"]) == 0
    assert "boundary layer ~ tiles^-0." in capsys.readouterr().err
    rows = list(csv.DictReader((folder / "fig2c.csv").read_text().splitlines()))
    assert [row["tiles"] for row in rows] == ["16", "36"]
    assert float(rows[0]["boundary_layer_area"]) > float(rows[1]["boundary_layer_area"])
    assert json.loads((folder / "fig2c.json").read_text())["area_exponent"] < -0.3
    assert all((folder / name).stat().st_size > 5000 for name in ("fig2c.png", "fig2c.svg", "fig2c_sheets.png"))


@pytest.mark.slow
def test_planar_figures_show_their_designs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured) -> None:
    from kirisurf.reproducing_figures import FIGURES

    small = [Wanted(w.name, w.spec.changed(cells=(2, 2))) for w in FIGURES["fig2a"]]
    monkeypatch.setattr("kirisurf.cli.reproduce_figures.FIGURES", {"fig2a": tuple(small)})
    assert cli.main(["reproduce", "fig2a", "-o", str(tmp_path / "made")]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "made" / "fig2a.png")
    assert (tmp_path / "made" / "fig2a.png").read_bytes().startswith(b"\x89PNG")


def test_the_first_figure_is_one_picture_of_a_certified_sheet(tmp_path: Path, capsys: Captured) -> None:
    folder = tmp_path / "made"
    assert cli.main(["reproduce", "fig1", "-o", str(folder)]) == 0
    assert capsys.readouterr().out.strip() == str(folder / "fig1.png")
    (row,) = csv.DictReader((folder / "fig1.csv").read_text().splitlines())
    assert float(row["rigid"]) <= 1e-9 and float(row["contracted_boundary"]) <= 1e-9
    assert (folder / "fig1.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_the_second_figure_is_its_parts_below_one_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    from PIL import Image

    from kirisurf.reproducing_figures import FIGURES

    small = {k: tuple(Wanted(w.name, w.spec.changed(cells=(2, 2))) for w in FIGURES[k][:1]) for k in ("fig2a", "fig2b")}
    monkeypatch.setattr("kirisurf.cli.reproduce_figures.FIGURES", small)
    folder = tmp_path / "made"
    assert cli.main(["reproduce", "fig2", "-o", str(folder), "--largest", "3"]) == 0
    out, err = capsys.readouterr()
    assert out.strip() == str(folder / "fig2.png") and "4 of 4 designs reproduced" in err
    heights = []
    for name in ("fig2a", "fig2b", "fig2c", "fig2"):
        assert (folder / f"{name}.csv").is_file() is (name != "fig2")
        with Image.open(folder / f"{name}.png") as picture:
            heights.append(picture.height / picture.width)
    assert sum(heights[:3]) < heights[3] < sum(heights[:3]) + 0.1


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
def test_flat_sheets_open_into_surfaces_of_every_curvature(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    """Fig. 4: the contracted outline is a rectangle to 1e-9 where it is asked for, and the sheet lies on the target."""
    from kirisurf.reproducing_figures import FIGURES

    chosen = [Wanted(w.name, w.spec.changed(cells=(3, 3))) for w in FIGURES["fig4"] if w.spec.target != "mexicanhat2"]
    assert [w.spec.target for w in chosen] == ["hypar", "paraboloid", "peaks"]
    monkeypatch.setattr("kirisurf.cli.reproduce_figures.FIGURES", {"fig4": tuple(chosen)})
    folder = tmp_path / "made"
    assert cli.main(["reproduce", "fig4", "-o", str(folder)]) == 0
    assert capsys.readouterr().out.strip() == str(folder / "fig4.png")
    for row in csv.DictReader((folder / "fig4.csv").read_text().splitlines()):
        assert float(row["contracted_boundary"]) <= 1e-9 and float(row["rigid"]) <= 1e-9
        assert float(row["distance_rms"]) < 0.1
    assert all((folder / f"fig4_{wanted.spec.target}.png").stat().st_size > 20000 for wanted in chosen)


@pytest.mark.slow
def test_a_square_that_opens_into_a_disc_is_bistable_up_to_a_stiffness(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    """Fig. 3a: below the lambda that is stated the energy has a second minimum behind a barrier, above it none."""
    from kirisurf.reproducing_figures import FIGURES

    (wanted,) = FIGURES["fig3"]
    small = Wanted(wanted.name, wanted.spec.changed(cells=(2, 2)))
    monkeypatch.setattr("kirisurf.cli.reproduce_figures.FIGURES", {"fig3": (small,)})
    folder = tmp_path / "made"
    assert cli.main(["reproduce", "fig3", "-o", str(folder)]) == 0
    out, err = capsys.readouterr()
    assert out.strip() == str(folder / "fig3.png") and "rests open by itself up to lambda" in err
    record = json.loads((folder / "fig3.json").read_text())
    transition = record["transition_lambda"]
    rows = list(csv.DictReader((folder / "fig3_paths.csv").read_text().splitlines()))
    seen = {}
    for torsion in dict.fromkeys(float(row["lambda"]) for row in rows):
        energies = np.array([float(row["energy"]) for row in rows if float(row["lambda"]) == torsion])
        rises = np.sign(np.diff(energies[1:]))
        seen[torsion / transition] = int((np.diff(rises) != 0).sum()) if torsion else len(energies)
    assert [round(share, 6) for share in seen] == [0.0, 0.5, 1.0, 2.0]
    # up, over the barrier, down, and up again behind the second minimum
    assert seen[0.5] == 2 and seen[2.0] == 0
