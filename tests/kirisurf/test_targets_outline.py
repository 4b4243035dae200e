"""Planar outlines as targets from names and files, through the command line to a run folder and back."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from kirisurf.cli import main
from kirisurf.design import fit
from kirisurf.errors import ParameterError, UnreadableError
from kirisurf.outlines import outline
from kirisurf.runs import read_run
from kirisurf.spec import FitSpec
from kirisurf.targets import OUTLINE_CELLS, flat_target, load, load_with_notes, loaded, read_named_outline, resolved

QUIET = ["--no-pictures", "-q"]


def ring(path: Path, scale: float = 1.0, shift: tuple[float, float] = (0.0, 0.0)) -> Path:
    """An egg as CSV."""
    points = scale * outline("egg").polyline(0.02) + np.array(shift)
    path.write_text("\n".join(f"{x!r},{y!r}" for x, y in points.tolist()) + "\n")
    return path


def test_names_of_outlines_are_targets() -> None:
    for name in ("circle", "heart", "letter-s"):
        surface, notes = load_with_notes(name)
        assert surface.outline.name == name and notes == ()
        assert surface.area == pytest.approx(surface.outline.area, rel=1e-2)
        assert (surface.vertices[:, 2] == 0).all()
    assert resolved(FitSpec(target="circle")).cells == OUTLINE_CELLS
    assert resolved(FitSpec(target="letter-s")).cells is None
    assert resolved(FitSpec(target="circle", tiles=70), sized=True).tiles == 70


def test_unknown_names_are_refused_with_the_nearest_known() -> None:
    with pytest.raises(UnreadableError, match="did you mean 'circle'"):
        load("circel")
    with pytest.raises(ParameterError, match="did you mean 'heart'"):
        read_named_outline("haert")
    with pytest.raises(ParameterError, match="repair"):
        fit("circle", cells=(1, 1), repair=True)


def test_what_no_reader_knows_is_said_with_all_that_is(tmp_path: Path) -> None:
    (tmp_path / "hood.step").write_text("ISO-10303-21;")
    with pytest.raises(UnreadableError, match=r"\.obj.*\.stl.*\.csv.*\.dxf.*\.svg.*got a file called \.step"):
        load(tmp_path / "hood.step")
    with pytest.raises(ParameterError, match=r"--contracted: expected free, .*circle.*got 'nonsense'"):
        resolved(FitSpec(target="hypar", cells=(2, 2), contracted="nonsense"))


def test_a_file_beside_a_name_needs_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "circle").write_text("not an outline")
    monkeypatch.chdir(tmp_path)
    assert "planar outline" in load_with_notes("circle")[1][0]
    assert resolved(FitSpec(target="./circle")).target == str(tmp_path / "circle")


def test_files_of_tessellation_and_outline_start_at_the_spec(tmp_path: Path) -> None:
    spec = FitSpec(target="a.svg", tessellation="mine.cell", contracted="b.dxf", cells=(2, 2))
    found = resolved(spec, tmp_path, sized=True)
    assert (found.target, found.tessellation, found.contracted) == tuple(
        str(tmp_path / name) for name in ("a.svg", "mine.cell", "b.dxf")
    )
    for shape in ("free", "rectangle", "rectangle:1.5", "egg"):
        assert resolved(spec.changed(contracted=shape), tmp_path, sized=True).contracted == shape


@pytest.mark.parametrize(
    "values",
    [
        {"contracted": "rectangle:1.5"},
        {"contracted": "./x.svg", "max_opening": 70.0, "min_corner": 40.0},
        {"prefer": "open", "tessellation": "kagome"},
    ],
)
def test_specs_read_back(values: dict[str, object]) -> None:
    spec = FitSpec(target="circle", cells=(3, 2), **values)
    assert FitSpec.from_toml(spec.to_toml()) == spec


@pytest.mark.parametrize(
    "values",
    [
        {"contracted": "rectangle:0"},
        {"contracted": "rectangle:wide"},
        {"contracted": "rectangle:nan"},
        {"contracted": ""},
        {"max_opening": 2.0},
        {"max_opening": 181.0},
        {"min_corner": 61.0},
        {"prefer": "best"},
        {"tessellation": "squares"},
    ],
)
def test_wrong_values_are_refused(values: dict[str, object]) -> None:
    with pytest.raises(ParameterError, match="expected"):
        FitSpec(target="circle", cells=(2, 2), **values)


def test_units_of_an_outline_are_taken_where_none_are_given(tmp_path: Path) -> None:
    path = tmp_path / "plate.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">'
        '<path d="M0 0H100V60H0Z"/></svg>'
    )
    spec, surface, _ = loaded(resolved(FitSpec(target=str(path), cells=(2, 2)), sized=True))
    assert spec.units == "mm"
    np.testing.assert_allclose(np.ptp(surface.vertices[:, :2], axis=0), [100, 60])
    assert loaded(spec.changed(units="in"))[0].units == "in"


def test_a_run_in_an_outline_is_saved_judged_and_repeated(tmp_path: Path) -> None:
    """Target and contracted outline are files given by relative paths in the spec."""
    ring(tmp_path / "egg.csv", 40.0, (7.0, -3.0))
    spec = 'target = "egg.csv"\ncells = "2x2"\ncontracted = "egg.csv"\nunits = "mm"\n'
    (tmp_path / "mine.toml").write_text(spec)
    words = ["fit", "--spec", str(tmp_path / "mine.toml"), "-o"]
    # done with a warning: an egg has no corners for those of the flat sheet
    assert main([*words, str(tmp_path / "one"), *QUIET]) == 1
    run = read_run(tmp_path / "one")
    assert any("4 outer vertices of the flat sheet lie outside" in said for said in run.result["warnings"])
    assert run.result["certified"] and run.result["freedom"] > 0
    assert 0 <= run.certificate["boundary"] <= 1e-9 and 0 <= run.certificate["contracted_boundary"] <= 1e-9
    assert run.spec.target == run.spec.contracted == str(tmp_path / "egg.csv")
    # moved to another place, the written spec still finds its files, and gives the same bytes
    again = ["fit", "--spec", str(tmp_path / "one" / "run.toml"), "-o", str(tmp_path / "two"), *QUIET]
    assert main(again) == 1
    for name in ("deployed.obj", "contracted.obj", "pattern.svg", "run.toml"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


def test_far_outlines_are_moved_and_fitted_as_near_ones(tmp_path: Path) -> None:
    shift = (3e6, -2e6)
    near, far = (fit(str(ring(tmp_path / f"{s[0]:g}.csv", shift=s)), cells=(2, 2)) for s in ((0.0, 0.0), shift))
    assert far.certificate.passed, far.certificate.failures
    assert np.abs(far.origin[:2] - shift).max() < 10
    place = far.deployed_points[:, :2] + (far.origin[:2] - shift)
    # the coordinates of the file itself were rounded there
    np.testing.assert_allclose(place, near.deployed_points[:, :2], atol=1e-6)


def test_an_svg_goes_through_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "disc.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="80mm" viewBox="0 0 80 80">'
        '<circle cx="40" cy="40" r="30"/></svg>'
    )
    words = ["fit", str(path), "-o", str(tmp_path / "run"), "--tiles", "40", "--no-pictures", "--json"]
    assert main(words) in (0, 1)
    printed = json.loads(capsys.readouterr().out)
    assert printed["status"] == "CONVERGED" and printed["certificate"]["boundary"] <= 1e-9
    run = read_run(tmp_path / "run")
    outer = run.deployed[run.tessellation.outline]
    assert run.spec.units == "mm"
    assert np.abs(np.linalg.norm(outer[:, :2] - outer[:, :2].mean(axis=0), axis=1)).max() < 31


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["circle", "--tiles", "40", "--contracted", "rectangle"], 2),
        (["circle", "--cells", "2x2", "--contracted", "nosuch"], 2),
        (["circle", "--cells", "2x2", "--contracted", "./nosuch.svg"], 3),
        (["circle", "--cells", "2x2", "--prefer", "best"], 2),
        (["circle", "--cells", "2x2", "--max-opening", "1"], 2),
        (["./nosuch.svg"], 3),
        (["circle", "--cells", "2x2", "--remesh"], 2),
        (["circle", "--cells", "2x2", "--tessellation", "./nosuch.cell"], 3),
    ],
)
def test_mistakes_are_told_without_a_traceback(
    words: list[str], code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["fit", *words, "-o", str(tmp_path / "run"), *QUIET]) == code
    error = capsys.readouterr().err
    assert "expected" in error and "Traceback" not in error and "internal" not in error
    assert not (tmp_path / "run").exists()


def test_an_outline_is_a_surface_too() -> None:
    surface = flat_target(outline("disc"))
    assert surface.outline is not None and load(surface) is surface
