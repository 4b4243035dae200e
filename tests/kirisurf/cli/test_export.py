"""`kirisurf export`: files, the sizes it reports, and the exit code of every mistake."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import kirisurf
from kirisurf import cli

Captured = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("runs") / "hypar"
    kirisurf.fit("hypar", cells=(2, 2)).save(made, pictures=False)
    return made


def test_all_files_of_a_laser_and_a_printer_in_one_go(folder: Path, tmp_path: Path, capsys: Captured) -> None:
    names = [str(tmp_path / name) for name in ("cut.svg", "cut.dxf", "print.stl")]
    words = ["--fit-sheet", "300x200", "--scale", "max", "--kerf", "0.15", "--hinge-width", "2", "--thickness", "3"]
    assert cli.main(["--json", "export", str(folder), "--to", *names, *words]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["files"] == names and printed["warnings"] == []
    for name in names:
        assert Path(name).stat().st_size > 1000
        size = printed["placements"][name]["size"]
        assert size[0] <= 300 and size[1] <= 200 and printed["placements"][name]["scale"] > 50
    assert cli.main(["export", str(folder), "--to", *names, *words, "--overwrite"]) == 0
    out, err = capsys.readouterr()
    assert out.split() == names and "mm (assumed), scale " in err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["a.svg", "--fit-sheet", "0.5x0.5"], "the largest --scale that fits is 0."),
        (["a.svg", "--fit-sheet", "10by3"], "expected WxH such as 300x200, got '10by3'"),
        (["a.svg", "--scale", "big"], "expected a number or max, got 'big'"),
        (["a.svg", "--scale", "max"], "expected together with --fit-sheet"),
        (["a.dxf", "--kerf", "0.5"], "--kerf: expected a number from 0 to less than the hinge width"),
        (["a.dxf", "--kerf", "0.2", "--hinge-width", "0.1"], "--kerf: expected less than the hinge width 0.1"),
        (["a.dxf", "--hinge-width", "5"], "--hinge-width: expected more than 0 and at most"),
        (["a.dxf", "--units", "parsec"], "--units: expected one of um, mm, cm, m, in, ft, got 'parsec'"),
        (["a.stl", "--thickness", "-1"], "--thickness: expected a number above 0, got -1.0"),
        (["a.stl", "--thickness", "1", "--gap", "3"], "--gap: expected from"),
        (["a.stl", "--thickness", "1", "--state", "deployed"], "expected --state contracted for a solid"),
        (["a.stl", "--scale", "2"], "expected --scale and --fit-sheet with"),
        (["a.svg", "b.obj", "--scale", "2"], "b.obj: expected --scale and --fit-sheet with"),
        (["a.dxf", "--state", "deployed"], "expected --state contracted for a cut pattern"),
        (["a.pdf"], ".pdf is not available in this version"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_mistake_is_refused_and_nothing_is_written(
    words: list[str], message: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["export", str(folder), "--to", *words]) == 2
    out, err = capsys.readouterr()
    assert out == "" and message in err
    assert not list(tmp_path.iterdir())


def test_narrowed_hinges_are_a_warning_with_its_code(folder: Path, tmp_path: Path, capsys: Captured) -> None:
    words = ["export", str(folder), "--to", str(tmp_path / "a.svg"), "--hinge-width"]
    assert cli.main([*words, "9"]) == 2
    most = capsys.readouterr().err.partition("at most ")[2].partition(" ")[0]
    assert cli.main([*words, str(0.9999 * float(most))]) == 1
    assert "hinges are narrower than" in capsys.readouterr().err


def test_what_is_not_certified_is_never_written_in_silence(folder: Path, tmp_path: Path, capsys: Captured) -> None:
    shutil.copytree(folder, tmp_path / "run")
    record = tmp_path / "run" / "result.json"
    result = json.loads(record.read_text())
    result["certificate_beside"]["failures"] = ["closure 0.1 exceeds 1e-10"]
    record.write_text(json.dumps({**result, "certified": False}))
    names = [str(tmp_path / f"a{suffix}") for suffix in (".svg", ".dxf", ".stl", ".obj", ".inp")]
    assert cli.main(["export", str(tmp_path / "run"), "--to", *names, "--thickness", "0.1"]) == 1
    said = capsys.readouterr().err
    assert said.count("not certified, and what is cut from it may not close or open: closure 0.1 exceeds") == 1
    assert all(Path(name).exists() for name in names)
