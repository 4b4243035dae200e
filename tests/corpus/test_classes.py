"""The table of the corpus: what it finds fault with, and the hostile half of the corpus itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tests.corpus.child import Ended, run
from tests.corpus.classes import MEMORY_MB, Entry, entries, found_class, judged, judged_corpus, judgement, main
from tests.corpus.launcher import is_own
from tests.kirisurf.mutations import rounds

CORPUS = Path(__file__).resolve().parents[3] / "shared" / "corpus"
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
REFUSED = Ended(3, "", 1.0, "", "reading a.ply ...\nkirisurf: a.ply: expected a PLY header line, got 'x'\n", ())
DONE = Ended(0, "", 1.0, "report.html\n", "certified.\n", ())
RECORD = {"exit_code": 0, "certified": True, "reason": "Converged."}


@pytest.mark.parametrize(
    ("expected", "found", "agrees"),
    [
        ("PARSE", "PARSE", True),
        ("PARSE", "LOADS", False),
        ("PARSE/OK", "TOPO", True),
        ("PARSE/SEC", "UNUSABLE", False),
        ("NONFINITE", "PARSE", True),
        ("NONFINITE", "RANGE", False),
        ("OK?", "LOADS", True),
        ("OK", "PARSE", False),
        ("WARN(drop)", "LOADS", True),
        ("TOPO(components)", "TOPO", True),
        ("TOPO", "LOADS", False),
        ("FIT-HARD", "LOADS", True),
        ("FIT-INFEASIBLE", "TOPO", False),
        ("LOADS", "TOPO", False),
    ],
)
def test_classes_that_an_index_accepts(expected: str, found: str, agrees: bool) -> None:
    assert (found in Entry(Path("a.ply"), expected).classes) == agrees


@pytest.mark.parametrize(
    ("code", "sentence", "name"),
    [
        (0, "", "LOADS"),
        (5, "", "LOADS"),
        (3, "anything", "PARSE"),
        (4, "kirisurf: a.obj: expected finite coordinates, got [nan]", "NONFINITE"),
        (4, "kirisurf: a.obj: expected a surface, got 3 vertices without any face", "NOFACES"),
        (4, "kirisurf: a.obj: expected something else", "UNUSABLE"),
        (70, "kirisurf: internal error", "NONE"),
        (None, "", "NONE"),
    ],
)
def test_classes_of_endings(code: int | None, sentence: str, name: str) -> None:
    assert found_class(code, sentence) == name


def test_what_agrees_has_no_faults() -> None:
    assert judgement(Entry(Path("a.ply"), "PARSE"), REFUSED, None).faults == ()
    assert judgement(Entry(Path("a.ply"), "OK"), DONE, RECORD).faults == ()


@pytest.mark.parametrize(
    ("ended", "record", "fault"),
    [
        (replace(REFUSED, code=None, death="SIGSEGV"), None, "did not end by itself"),
        (replace(REFUSED, messages="Traceback (most recent call last):\n" + REFUSED.messages), None, "a traceback"),
        (replace(REFUSED, messages="kirisurf: it is damaged\n"), None, "one sentence that names the file"),
        (replace(REFUSED, messages=REFUSED.messages * 2), None, "one sentence that names the file"),
        (REFUSED, RECORD, "and yet there is a run"),
        (replace(REFUSED, opened=("open /etc/passwd",)), None, "it did open /etc/passwd"),
        (replace(REFUSED, opened=("socket.connect ('127.0.0.1', 9)",)), None, "it did socket.connect"),
        (DONE, None, "no result.json"),
        (DONE, RECORD | {"certified": False}, "code and certificate disagree"),
        (DONE, RECORD | {"exit_code": 1}, "recorded code 1"),
        (replace(DONE, code=70), None, "expected PARSE"),
    ],
)
def test_faults(ended: Ended, record: dict | None, fault: str) -> None:
    found = judgement(Entry(Path("a.ply"), "PARSE/OK"), ended, record).faults
    assert any(fault in each for each in found) or (fault == "expected PARSE" and found[0] == "expected PARSE/OK")


def test_what_belongs_to_the_installation(tmp_path: Path) -> None:
    assert is_own(__file__)
    assert is_own(str(tmp_path))
    assert not is_own("/etc/passwd")
    assert not is_own("/var/spool/anything")


@pytest.mark.slow
def test_files_are_judged_by_what_becomes_of_them(tmp_path: Path) -> None:
    (tmp_path / "good.obj").write_text(SQUARE + "f 1 2 3 4\n")
    (tmp_path / "bad.obj").write_text(SQUARE + "f 1 2 3 9\n")
    good, bad = Entry(tmp_path / "good.obj", "OK"), Entry(tmp_path / "bad.obj", "OK")
    assert judged(good, tmp_path / "run").faults == ()
    assert judged(bad, tmp_path / "run").faults == ("expected OK",)
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
def test_a_child_that_takes_long_is_ended() -> None:
    assert run(["samples"], 0.01, MEMORY_MB).death == "no end within 0.01 s"
    assert run(["--version"], 60, MEMORY_MB).code == 0


def test_a_folder_without_index_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main([str(tmp_path)])
    assert "expected index.tsv" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus of hostile files did not run: no shared/corpus beside us")
def test_hostile_files_through_the_command_line() -> None:
    """Every fourth file; KIRISURF_MUTATIONS=4 takes all of them."""
    hostile = [entry for entry in entries(CORPUS) if entry.path.parent.name == "nasty"]
    step = max(1, 4 // len(rounds(1)))
    assert [one.cells for one in judged_corpus(hostile[::step]) if one.faults] == []
