"""A file is written whole or not at all, and what was there before is never lost."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from kirisurf.errors import OutputError
from kirisurf.formats import atomic


@pytest.mark.parametrize("name", ["plain.obj", "with space.obj", 'it\'s "quoted".obj', "-dash.obj", "Größe-表面.obj"])
def test_content_arrives_under_any_name(tmp_path: Path, name: str) -> None:
    atomic.write_text(tmp_path / name, "one\r\ntwo\n")
    atomic.write_bytes(tmp_path / name, b"\0\xff" + b"x" * 100_000)
    assert (tmp_path / name).read_bytes() == b"\0\xff" + b"x" * 100_000
    assert os.listdir(tmp_path) == [name]


def test_line_ends_are_kept(tmp_path: Path) -> None:
    atomic.write_text(tmp_path / "a", "one\r\ntwo\n")
    assert (tmp_path / "a").read_bytes() == b"one\r\ntwo\n"


def test_permissions_are_those_of_the_old_file_or_of_a_plain_open(tmp_path: Path) -> None:
    plain, ours = tmp_path / "plain", tmp_path / "ours"
    plain.write_text("x")
    atomic.write_text(ours, "x")
    assert ours.stat().st_mode == plain.stat().st_mode
    ours.chmod(0o640)
    atomic.write_text(ours, "y")
    assert ours.stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("step", ["write", "fsync", "replace"])
def test_a_full_disk_leaves_the_old_file_and_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    target = tmp_path / "result.json"
    target.write_text("old")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    if step != "write":
        monkeypatch.setattr(os, step, full)
    with pytest.raises(OutputError, match=r"result\.json: expected to write this file, got: No space left") as caught:
        if step == "write":
            with atomic.replacing(target):
                full()
        else:
            atomic.write_text(target, "new")
    monkeypatch.undo()
    assert caught.value.exit_code == 7
    assert target.read_text() == "old"
    assert os.listdir(tmp_path) == ["result.json"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the full-disk test did not run: there is no /dev/full")
def test_a_disk_that_is_really_full(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scratch = tmp_path / "scratch"

    def on_full_disk(**_: object) -> tuple[int, str]:
        scratch.write_text("")
        return os.open("/dev/full", os.O_WRONLY), str(scratch)

    monkeypatch.setattr("tempfile.mkstemp", on_full_disk)
    with pytest.raises(OutputError, match="No space left"):
        atomic.write_bytes(tmp_path / "a.obj", b"x" * 1000)
    assert os.listdir(tmp_path) == []


def test_other_exceptions_pass_and_leave_nothing(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), atomic.replacing(tmp_path / "a") as file:
        file.write(b"half")
        raise KeyboardInterrupt
    assert os.listdir(tmp_path) == []


def test_a_missing_folder_and_a_folder_as_target_are_named(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"nowhere.*No such file"):
        atomic.write_text(tmp_path / "nowhere" / "a.obj", "x")
    with pytest.raises(OutputError, match="it is a folder"):
        atomic.write_text(tmp_path, "x")


@pytest.mark.skipif(os.name == "posix" and os.geteuid() == 0, reason="the read-only test did not run: root may write")
def test_a_read_only_folder(tmp_path: Path) -> None:
    tmp_path.chmod(0o555)
    try:
        with pytest.raises(OutputError, match="Permission denied"):
            atomic.write_text(tmp_path / "a.obj", "x")
    finally:
        tmp_path.chmod(0o755)
