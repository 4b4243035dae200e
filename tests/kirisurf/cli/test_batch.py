"""`kirisurf batch` as a user has it: codes, streams, poison, baselines."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import kirisurf.cli as cli
from tests.kirisurf.batch.trees import POISON, differences

TEXT = """
[[items]]
target = "hypar"
name = "{0}"
cells = "1x1"
"""
POISONS = {
    "segfault": (70, "crashed"),
    "abort": (70, "crashed"),
    "exit": (70, "crashed"),
    "midway": (70, "crashed"),
    "glutton": (6, "memory limit"),
    "raise": (70, "internal error"),
    "hang": (6, "time limit"),
}


@pytest.fixture
def junk(tmp_path: Path) -> Path:
    (tmp_path / "junk.obj").write_text("v 0 0 0\n")
    return tmp_path


@pytest.mark.slow
def test_poison_is_recorded_and_the_rest_is_as_if_alone(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "poison").mkdir()
    (tmp_path / "poison" / "sitecustomize.py").write_text(POISON)
    (tmp_path / "junk.obj").write_text("v 0 0 0\n")
    sound = [f"sound-{k}" for k in range(8)]
    items = "".join(TEXT.format(name) for pair in zip(sound, [*POISONS, ""], strict=True) for name in pair if name)
    items += (
        '[[items]]\ntarget = "./junk.obj"\n[[items]]\ntarget = "nothing"\n[[items]]\ntarget = "hypar"\ntolerance = 7\n'
    )
    (tmp_path / "batch.toml").write_text(f"[limits]\nseconds = 20\nmemory_mb = 600\n{items}")
    paths = os.pathsep.join(filter(None, [str(tmp_path / "poison"), os.environ.get("PYTHONPATH")]))
    environment = {**os.environ, "PYTHONPATH": paths}
    words = ["batch", str(tmp_path / "batch.toml"), "-o", str(tmp_path / "out"), "--json"]
    ended = subprocess.run(
        [sys.executable, "-m", "kirisurf", *words], env=environment, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 8 and "Traceback" not in ended.stderr
    summary = json.loads(ended.stdout)
    assert summary["exit_code"] == 8 and summary["counts"]["unexpected"] == 10
    found = {item["name"]: (item["code"], item["outcome"]) for item in summary["items"]}
    assert {name: found[name] for name in POISONS} == POISONS
    assert found["junk.obj"] == (4, "unusable") and found["nothing"] == (3, "unreadable")
    assert sum(code == 2 for code, _ in found.values()) == 1

    assert cli.main(["fit", "hypar", "--cells", "1x1", "--no-pictures", "-q", "-o", str(tmp_path / "alone")]) == 0
    for name in sound:
        assert found[name] == (0, "done")
        assert differences(tmp_path / "out" / "runs" / name, tmp_path / "alone") == []
    assert sorted(each.name for each in (tmp_path / "out" / "runs").iterdir()) == sound
    capfd.readouterr()


def test_a_baseline_is_accepted_and_a_planted_regression_is_caught(
    junk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    base = junk / "base.toml"
    (junk / "batch.toml").write_text(
        'targets = ["hypar", { target = "./junk.obj", expect = 4 }]\n[options]\ncells="2x2"\n'
    )
    first = ["batch", str(junk / "batch.toml"), "--baseline", str(base)]
    assert cli.main([*first, "-o", str(junk / "a"), "--accept"]) == 0
    assert cli.main([*first, "-o", str(junk / "a")]) == 0
    assert "against base.toml: 2 same" in capsys.readouterr().err

    # the solver is made worse: a bound that is no part of the certificate's usual limits
    assert cli.main([*first, "-o", str(junk / "b"), "--min-angle", "70"]) == 8
    said = capsys.readouterr().err
    assert "worse: hypar\n" in said and "\n    distance_rms " in said
    page = (junk / "b" / "report.html").read_text()
    assert "distance_rms" in page and "worse" in page
    # against the folder of a batch too; and accepted, it is the new baseline
    assert cli.main(["batch", str(junk / "batch.toml"), "-o", str(junk / "b"), "--min-angle", "70", "--baseline",
                     str(junk / "a")]) == 8  # fmt: skip
    assert cli.main([*first, "-o", str(junk / "b"), "--min-angle", "70", "--accept"]) == 0
    assert cli.main([*first, "-o", str(junk / "b"), "--min-angle", "70"]) == 0
    # an item that is not asked for any more is missing, and its run is not taken away
    (junk / "batch.toml").write_text('targets = [{ target = "./junk.obj", expect = 4 }]\n')
    assert cli.main([*first, "-o", str(junk / "b")]) == 1
    said = capsys.readouterr().err
    assert "missing: hypar" in said and "1 runs in" in said
    assert (junk / "b" / "runs" / "hypar" / "result.json").exists()


@pytest.mark.parametrize(
    ("words", "code", "sentence"),
    [
        (["nothing.toml"], 3, "expected a file that can be read"),
        (["nothing"], 3, "expected a batch (TOML, CSV, TSV) or a folder of targets"),
        (["batch.toml", "--workers", "0"], 2, "--workers: expected a whole number from 1"),
        (["batch.toml", "--workers", "two"], 2, "expected a whole number, got 'two'"),
        (["batch.toml", "--limit-seconds", "0"], 2, "limits: expected seconds above 0"),
        (["batch.toml", "--limit-memory", "1"], 2, "limits: expected memory_mb above 16"),
        (["batch.toml", "--accept"], 2, "--accept: expected together with --baseline FILE"),
        (["batch.toml", "--accept", "--baseline", "x.json"], 2, "to name a .toml file"),
        (["batch.toml", "--baseline", "none.toml"], 3, "none.toml: expected a file that can be read"),
        (["batch.toml", "--baseline", "batch.toml"], 2, "expected a baseline with a table for every item"),
        (["batch.toml", "--tiles", "3", "--cells", "2x2"], 0, ""),
    ],
)
def test_mistakes_end_with_a_sentence(
    junk: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: list[str], code: int,
    sentence: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(junk)
    (junk / "batch.toml").write_text('targets = [{ target = "hypar", expect = 2, tolerance = 7 }]\n')
    assert cli.main(["batch", *words, "-o", "out"]) == code
    assert sentence in capsys.readouterr().err


def test_a_folder_that_cannot_be_written_is_said_before_anything_is_made(
    junk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (junk / "batch.toml").write_text('targets = ["hypar"]\n')
    (junk / "file").write_text("x")
    (junk / "other").mkdir()
    (junk / "other" / "x").write_text("x")
    batch = ["batch", str(junk / "batch.toml"), "-o"]
    assert cli.main([*batch, str(junk / "file")]) == 7
    assert cli.main([*batch, str(junk / "file" / "deeper")]) == 7
    assert cli.main([*batch, "/proc/nothing"]) == 7
    assert cli.main([*batch, str(junk / "other")]) == 2
    assert capsys.readouterr().err.count("\n") == 4
    assert [each.name for each in (junk / "other").iterdir()] == ["x"] and (junk / "file").read_text() == "x"


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 64 kB; 'mount -o remount' makes it larger."""
    disk = tmp_path / "disk"
    disk.mkdir()
    words = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(disk)]
    try:
        made = subprocess.run(words, capture_output=True, check=False).returncode == 0
    except OSError:
        made = False
    if not made:
        pytest.skip("a full disk was not tried: this process may not mount one")
    yield disk
    subprocess.run(["umount", "-l", str(disk)], check=True)


@pytest.mark.slow
def test_a_full_disk_ends_a_batch_and_more_room_lets_it_go_on(
    small_disk: Path, junk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (junk / "batch.toml").write_text('targets = ["hypar", "sphere", "circle"]\n[options]\ncells="1x1"\n')
    batch = ["batch", str(junk / "batch.toml"), "--workers", "1", "-q", "-o"]
    assert cli.main([*batch, str(junk / "reference")]) == 0
    # nothing fits; then one run does; then all of them
    assert cli.main([*batch, str(small_disk / "out")]) == 7
    assert "No space left on device" in capsys.readouterr().err
    first = sum(path.stat().st_size + 4096 for path in (junk / "reference" / "runs" / "hypar").iterdir())
    _resize(small_disk, f"{(2 * first) // 1024}k")
    assert cli.main([*batch, str(small_disk / "out")]) == 7
    assert differences(small_disk / "out" / "runs" / "hypar", junk / "reference" / "runs" / "hypar") == []
    written = (small_disk / "out" / "runs" / "hypar" / "result.json").stat().st_mtime_ns
    _resize(small_disk, "64m")
    assert cli.main([*batch, str(small_disk / "out")]) == 0
    assert differences(small_disk / "out", junk / "reference") == []
    assert (small_disk / "out" / "runs" / "hypar" / "result.json").stat().st_mtime_ns == written


@pytest.mark.slow
def test_a_limit_on_files_is_a_disk_that_is_full(junk: Path) -> None:
    (junk / "batch.toml").write_text('targets = ["hypar"]\n[options]\ncells="1x1"\n')
    command = f"ulimit -f 100; exec {sys.executable} -m kirisurf batch batch.toml -o out -q"
    ended = subprocess.run(["bash", "-c", command], cwd=junk, capture_output=True, text=True, check=False)
    assert ended.returncode == 7 and "File too large" in ended.stderr and "Traceback" not in ended.stderr
    assert cli.main(["batch", str(junk / "batch.toml"), "-o", str(junk / "out"), "-q"]) == 0


def _resize(disk: Path, size: str) -> None:
    subprocess.run(["mount", "-o", f"remount,size={size}", str(disk)], check=True)
