"""The run folder as a transaction: complete, or as it was, whatever fails."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from kirisurf.errors import OutputError, ParameterError
from kirisurf.runs import RunFolder


def content(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def fill(opened: RunFolder, text: str, names: tuple[str, ...] = ("a.txt", "b.txt")) -> None:
    for name in names:
        (opened.staging / name).write_text(text)
    record = {"files": dict.fromkeys(names, "hash"), "text": text}
    (opened.staging / "result.json").write_text(json.dumps(record))


@pytest.fixture
def old(tmp_path: Path) -> Path:
    folder = tmp_path / "run"
    with RunFolder(folder) as opened:
        fill(opened, "old", ("a.txt", "b.txt", "gone.txt"))
        opened.commit()
    (folder / "mine.txt").write_text("a user's own note")
    return folder


def test_a_committed_run_is_complete_and_nothing_else(tmp_path: Path) -> None:
    with RunFolder(tmp_path / "deep" / "er") as opened:
        fill(opened, "x")
        opened.commit()
    assert sorted(content(tmp_path / "deep" / "er")) == ["a.txt", "b.txt", "result.json"]


@pytest.mark.parametrize("problem", [RuntimeError, KeyboardInterrupt, OutputError])
def test_what_fails_leaves_no_folder(tmp_path: Path, problem: type[BaseException]) -> None:
    with pytest.raises(problem), RunFolder(tmp_path / "deep" / "er") as opened:
        fill(opened, "x")
        raise problem
    assert not list(tmp_path.iterdir())


def test_an_old_run_needs_overwrite(old: Path) -> None:
    before = content(old)
    with (
        pytest.raises(ParameterError, match=r"expected a new or empty folder, got a run .*--overwrite"),
        RunFolder(old),
    ):
        pass
    assert content(old) == before


def test_overwriting_replaces_the_run_and_keeps_other_files(old: Path) -> None:
    with RunFolder(old, overwrite=True) as opened:
        fill(opened, "new")
        opened.commit()
    found = content(old)
    assert sorted(found) == ["a.txt", "b.txt", "mine.txt", "result.json"]
    assert found["a.txt"] == b"new" and found["mine.txt"] == b"a user's own note"


def test_a_failing_move_at_any_place_puts_the_old_run_back(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before, replace = content(old), os.replace
    failures = 0
    for fails_at in range(20):
        calls = 0

        def failing(source: object, target: object, fails_at: int = fails_at) -> None:
            nonlocal calls
            calls += 1
            if calls == fails_at + 1:
                raise OSError(28, "No space left on device")
            replace(source, target)  # type: ignore[arg-type]

        monkeypatch.setattr(os, "replace", failing)
        try:
            with RunFolder(old, overwrite=True) as opened:
                fill(opened, "new")
                opened.commit()
        except OutputError as problem:
            failures += 1
            assert "No space left" in str(problem)
            assert content(old) == before
        else:
            break
        finally:
            monkeypatch.setattr(os, "replace", replace)
    # four old files and three new ones
    assert failures == 7
    assert content(old)["a.txt"] == b"new"


def test_files_that_are_no_run_are_never_overwritten(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    for overwrite in (False, True):
        with pytest.raises(ParameterError, match="other files"), RunFolder(tmp_path, overwrite):
            pass
    assert content(tmp_path) == {"thesis.tex": b"years of work"}


def test_a_run_without_its_record_is_not_committed(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"result\.json"), RunFolder(tmp_path / "run") as opened:
        (opened.staging / "a.txt").write_text("x")
        opened.commit()
    assert not list(tmp_path.iterdir())


def test_a_folder_that_is_being_written_is_locked(tmp_path: Path) -> None:
    pytest.importorskip("fcntl", reason="locks did not run: this system has no fcntl")
    script = "import sys; from kirisurf.runs import RunFolder\nwith RunFolder(sys.argv[1]): print('in')"
    with RunFolder(tmp_path / "run") as opened:
        child = subprocess.run(
            [sys.executable, "-c", script, str(tmp_path / "run")],
            capture_output=True,
            text=True,
            cwd=Path.cwd(),
            check=False,
        )
        fill(opened, "x")
        opened.commit()
    assert "another run is writing" in child.stderr and "in" not in child.stdout
    assert content(tmp_path / "run")["a.txt"] == b"x"


def test_a_folder_is_waited_for_also_where_its_writer_removes_it(tmp_path: Path) -> None:
    pytest.importorskip("fcntl", reason="locks did not run: this system has no fcntl")
    entered = threading.Event()

    def write_nothing() -> None:
        with RunFolder(tmp_path / "run"):
            entered.set()
            time.sleep(0.3)

    writer = threading.Thread(target=write_nothing)
    writer.start()
    assert entered.wait(60)
    with RunFolder(tmp_path / "run", overwrite=True, patience=60.0) as opened:
        writer.join()
        fill(opened, "x")
        opened.commit()
    assert content(tmp_path / "run")["a.txt"] == b"x"


def test_what_a_killed_process_left_is_cleaned_up(old: Path) -> None:
    before = content(old)
    # killed while it staged, and again in the middle of a commit
    (old / ".kirisurf-partial-1").mkdir()
    (old / ".kirisurf-partial-1" / "a.txt").write_text("half")
    (old / ".kirisurf-previous-1").mkdir()
    for name in ("a.txt", "result.json"):
        (old / name).rename(old / ".kirisurf-previous-1" / name)
    with RunFolder(old, overwrite=True):
        pass
    assert content(old) == before


@pytest.mark.parametrize("place", ["file", "file/run", "/proc/run"])
def test_an_impossible_place_is_an_output_error(tmp_path: Path, place: str) -> None:
    if place.startswith("/proc") and not Path("/proc/self").exists():
        pytest.skip("a folder that cannot be made was not tried: there is no /proc here")
    (tmp_path / "file").write_text("x")
    with pytest.raises(OutputError, match="expected"), RunFolder(tmp_path / place):
        pass
    assert content(tmp_path) == {"file": b"x"}
