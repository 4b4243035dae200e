"""`kirisurf report`: pages and numbers of one run or several, and the same from Python."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import kirisurf
from kirisurf.cli import main
from kirisurf.runs import read_run

Captured = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    where = tmp_path_factory.mktemp("cli") / 'a <run> & "more"'
    assert main(["fit", "hypar", "-o", str(where), "--cells", "2x2", "--units", "mm", "--no-pictures", "-q"]) == 0
    return where


def test_numbers_are_written_and_printed(folder: Path, tmp_path: Path, capsys: Captured) -> None:
    path = tmp_path / "numbers.json"
    assert main(["report", str(folder), "-o", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}\n"
    numbers = json.loads(path.read_text(encoding="utf-8"))
    assert numbers["certified"] and numbers["title"] == "hypar" and "NaN" not in path.read_text(encoding="utf-8")
    assert main(["report", str(folder), "-o", str(tmp_path / "page.html"), "--no-pictures", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["numbers"] == numbers
    assert len(numbers["holes"]) == read_run(folder).result["holes"]


def test_names_with_signs_are_escaped_and_no_folder_is_named(folder: Path, tmp_path: Path) -> None:
    assert main(["report", str(folder), str(folder), "-o", str(tmp_path / "both.html"), "--no-pictures", "-q"]) == 0
    text = (tmp_path / "both.html").read_text(encoding="utf-8")
    assert "<run>" not in text and "a &lt;run&gt; &amp; &#34;more&#34;" in text
    assert str(folder.parent) not in text and str(tmp_path) not in text


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["RUN", "-o", "x.pdf"], 2, "expected a suffix among .html, .json"),
        (["RUN", "RUN"], 2, "expected a file for the comparison of 2 runs"),
        (["RUN", "nosuch", "-o", "x.html"], 3, "expected a run folder"),
        (["RUN", "-o", "no/such/folder/x.html"], 7, "x.html"),
    ],
)
def test_mistakes_are_named(
    folder: Path,
    words: list[str],
    code: int,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Captured,
) -> None:
    monkeypatch.chdir(tmp_path)
    given = [str(folder) if word == "RUN" else word for word in words]
    assert main(["report", *given, "--no-pictures"]) == code
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_an_uncertified_run_is_reported_and_compared(folder: Path, tmp_path: Path) -> None:
    short = tmp_path / "short"
    assert main(["fit", "hypar", "-o", str(short), "--cells", "2x2", "--max-steps", "1", "--no-pictures", "-q"]) == 6
    text = (short / "report.html").read_text(encoding="utf-8")
    assert "Not certified" in text
    failures = read_run(short).result["certificate_beside"]["failures"]
    assert failures and all(
        re.sub("'", "&#39;", sentence) and text.count(sentence.split(":")[0]) for sentence in failures
    )
    assert main(["report", str(short), str(folder), "-o", str(tmp_path / "x.html"), "--no-pictures", "-q"]) == 0
    assert "1</data> of" in (tmp_path / "x.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_ten_lines_of_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from viewers import opengl, snapshot

    assert snapshot.probe is opengl.probe
    monkeypatch.setattr(opengl, "probe", lambda: opengl.OpenGL(False, "", "no OpenGL in this test"))
    monkeypatch.chdir(tmp_path)
    lines = """
import kirisurf

design = kirisurf.fit("hypar", cells=(2, 2))
kirisurf.report(design, "hypar.html")
kirisurf.report(design, "hypar.json")
other = kirisurf.fit("hypar", cells=(2, 2), tessellation="kagome")
kirisurf.report([design, other], "both.html")
table = kirisurf.curvature(design, patches="corners_and_normals")
share = table.numbers["gaussian_curvature_target_share"]
table.save("holes.csv")
"""
    names: dict = {}
    exec(compile(lines, "ten lines", "exec"), names)
    assert len(lines.strip().splitlines()) <= 11
    assert {path.name for path in tmp_path.iterdir()} == {"hypar.html", "hypar.json", "both.html", "holes.csv"}
    assert 0.5 < names["share"] <= 1 and len(names["table"].rows) == len(names["design"].holes.cell_data["flag"])
    assert "no OpenGL in this test" in (tmp_path / "hypar.html").read_text(encoding="utf-8")


def test_wrong_things_are_refused(tmp_path: Path) -> None:
    for source, message in ((3, "expected a design, a run or its folder, got int"), ([], "at least one design")):
        with pytest.raises(kirisurf.ParameterError, match=message):
            kirisurf.report(source, tmp_path / "x.html")
    with pytest.raises(kirisurf.ParameterError, match="expected a design, a run or its folder, got int"):
        kirisurf.curvature(3)
    with pytest.raises(kirisurf.UnreadableError):
        kirisurf.report(str(tmp_path / "nothing"), tmp_path / "x.html")
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_pictures_that_a_run_does_not_hold_are_drawn(folder: Path, tmp_path: Path, opengl: None) -> None:
    before = sorted(path.name for path in folder.iterdir())
    assert main(["report", str(folder), "-o", str(tmp_path / "x.html"), "-q"]) == 0
    text = (tmp_path / "x.html").read_text(encoding="utf-8")
    assert text.count("data:image/png") == 4 + 6 + 1 + 2
    assert sorted(path.name for path in folder.iterdir()) == before
    assert "no pictures" not in text
