"""One run, one process: whatever becomes of it is told, and the next run is as good as ever."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from pathlib import Path

import pytest

import kirisurf.cli as cli
from kirisurf.batch.host import _judged
from kirisurf.batch.hosting import Host, Stopped
from kirisurf.batch.order import Answer, Order
from tests.kirisurf.batch.conftest import order, record
from tests.kirisurf.batch.trees import differences


def test_lines_are_read_back() -> None:
    sent = Order({"target": "caf\udce9 \n\0'\"", "tiles": 3}, "/x y", True, 1.5, 100.0)
    assert Order.of(sent.line()) == sent and sent.line().count(b"\n") == 1
    answer = Answer(5, "é\n", "crashed", ("a", "b"), 1.25, 3.0)
    assert Answer.of(answer.line()) == answer and answer.line().count(b"\n") == 1


def test_a_run_of_a_batch_is_that_of_the_command_line(host: Host, tmp_path: Path) -> None:
    answers = [host.answer(order(tmp_path / name, cells=(2, 2))) for name in ("a", "b")]
    assert [(each.code, each.end, each.message) for each in answers] == [(0, "", "")] * 2
    assert cli.main(["fit", "hypar", "--cells", "2x2", "--no-pictures", "-q", "-o", str(tmp_path / "c")]) == 0
    assert differences(tmp_path / "a", tmp_path / "b") == []
    assert differences(tmp_path / "a", tmp_path / "c") == []


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        ({"target": "./nothing.stl"}, 3, "expected a file that can be read"),
        ({"target": "hypar", "max_steps": 1}, 6, ""),
        ({"target": "hypar", "solver": "slsqp", "cells": (40, 40)}, 2, "--solver"),
    ],
)
def test_what_the_command_line_says_is_what_a_batch_says(
    host: Host, tmp_path: Path, options: dict, code: int, words: str
) -> None:
    answer = host.answer(order(tmp_path / "run", **options))
    assert answer.code == code and answer.end == "" and words in answer.message


@pytest.mark.usefixtures("poisoned")
@pytest.mark.parametrize(
    ("name", "code", "end", "words"),
    [
        ("segfault", 70, "crashed", "death by SIGSEGV"),
        ("abort", 70, "crashed", "death by SIGABRT"),
        ("exit", 70, "crashed", "exit with 3 and no answer"),
        ("hang", 6, "time limit", "expected an end within 1 s"),
        ("glutton", 6, "memory limit", ""),
        ("raise", 70, "", "internal error: RuntimeError: on purpose"),
        ("killer", 70, "crashed", "expected the process that keeps the run to stay, got death by SIGKILL"),
    ],
)
def test_a_poisonous_run_is_told_and_the_next_is_sound(
    tmp_path: Path, name: str, code: int, end: str, words: str
) -> None:
    host = Host()
    try:
        answer = host.answer(order(tmp_path / name, 1.0 if name == "hang" else 60.0, 500.0))
        assert (answer.code, answer.end) == (code, end) and words in answer.message
        assert host.answer(order(tmp_path / "sound")).code == 0
        assert record(tmp_path / "sound")["certified"] is True
    finally:
        host.close()


def test_a_run_whose_time_is_over_saves_what_it_has(host: Host, tmp_path: Path) -> None:
    answer = host.answer(order(tmp_path / "long", 4.0, tiles=10000, cells=None))
    assert (answer.code, answer.end) == (6, "time limit")
    assert answer.seconds < 4.0 + 60.0
    if (tmp_path / "long" / "result.json").exists():
        assert record(tmp_path / "long")["status"] == "INTERRUPTED"


def test_where_the_batch_is_gone_so_are_its_processes(tmp_path: Path) -> None:
    """The host reads the end of its input, in the middle of a run too, and takes the run with it."""
    host = Host()
    host.answer(order(tmp_path / "first"))
    process = host._process
    assert process is not None and process.stdin is not None
    process.stdin.write(order(tmp_path / "second", tiles=10000, cells=None).line())
    process.stdin.flush()
    until = time.monotonic() + 60
    while not (children := _children(process.pid)) and time.monotonic() < until:
        time.sleep(0.01)
    process.stdin.close()
    process.wait(60)
    while any(_is_alive(child) for child in children) and time.monotonic() < until:
        time.sleep(0.01)
    assert children and not any(_is_alive(child) for child in children)
    host.close()


@pytest.mark.usefixtures("poisoned")
def test_a_host_that_is_killed_takes_its_run_with_it_and_is_replaced(tmp_path: Path) -> None:
    host = Host()
    host.answer(order(tmp_path / "first"))
    found: list[Answer] = []
    thread = threading.Thread(target=lambda: found.append(host.answer(order(tmp_path / "patient"))))
    thread.start()
    process = host._process
    assert process is not None
    until = time.monotonic() + 60
    while not (tmp_path / "patient.pid").exists() and time.monotonic() < until:
        time.sleep(0.01)
    run = int((tmp_path / "patient.pid").read_text())
    assert run in _children(process.pid)
    os.kill(process.pid, signal.SIGKILL)
    thread.join(180)
    assert found and found[0].code == 0, found
    assert not _is_alive(run) and record(tmp_path / "patient")["certified"] is True
    host.close()


def test_a_host_that_is_closed_stops_waiting(tmp_path: Path) -> None:
    host = Host()
    host.answer(order(tmp_path / "first"))
    found: list[object] = []

    def ask() -> None:
        try:
            found.append(host.answer(order(tmp_path / "long", tiles=10000, cells=None)))
        except Stopped:
            found.append("stopped")

    thread = threading.Thread(target=ask)
    thread.start()
    time.sleep(0.5)
    host.close()
    thread.join(60)
    assert found == ["stopped"]
    assert not (tmp_path / "long" / "result.json").exists()


@pytest.mark.parametrize("pause", [0.0, 0.002, 0.02, 0.2])
def test_a_host_that_is_closed_while_it_starts_leaves_no_process(tmp_path: Path, pause: float) -> None:
    host, ended = Host(), threading.Event()

    def ask() -> None:
        with contextlib.suppress(Stopped):
            host.answer(order(tmp_path / "run"))
        ended.set()

    before = set(_children(os.getpid()))
    threading.Thread(target=ask).start()
    time.sleep(pause)
    host.close()
    assert ended.wait(60) and host._process is None
    assert not [child for child in set(_children(os.getpid())) - before if _is_alive(child)]


def _children(process: int) -> list[int]:
    found: list[int] = []
    for path in Path(f"/proc/{process}/task").glob("*/children"):
        with contextlib.suppress(OSError):  # a thread that has just ended
            found += [int(word) for word in path.read_text().split()]
    return found


def _is_alive(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("code", [70, 6, 130])
@pytest.mark.parametrize(
    ("ended", "said", "words"),
    [
        ("memory limit", ("std::bad_alloc",), "memory limit: expected at most"),
        ("time limit", (), "time limit: expected"),
    ],
)
def test_what_ended_a_run_is_told_whatever_it_answered(
    ended: str, said: tuple[str, ...], words: str, code: int
) -> None:
    asked = Order({}, "run", False, 300.0, 500.0)
    judged = _judged(Answer(code, "from inside a library").line(), 0, said, ended, asked)
    assert (judged.code, judged.end) == (6, ended) and judged.message.startswith(words)
    # what came to its end before it could be stopped did so
    assert _judged(Answer(0, "").line(), 0, said, ended, asked).code == 0
