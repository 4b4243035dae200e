"""A batch on a real Dask scheduler with workers on loopback."""

from __future__ import annotations

import contextlib
import json
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import kirisurf.batch.cluster as module
import kirisurf.cli as cli
from tests.kirisurf.batch.trees import differences

distributed = pytest.importorskip("distributed", reason="the extra kirisurf[cluster] is not installed")

TEXT = """
targets = ["hypar", "./junk.obj", "circle", "sphere"]
[matrix]
cells = ["1x1", "2x2"]
"""


class Cluster:
    """A scheduler that answers, and its workers, each a process that can be killed."""

    def __init__(self, folder: Path, workers: int) -> None:
        self._folder = folder
        self.workers: list[subprocess.Popen[bytes]] = []
        told = folder / "scheduler.json"
        words = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(told))
        self.scheduler = self._start("scheduler", *words)
        try:
            self.address = self._address(told)
        except BaseException:
            self.close()
            raise
        self.workers += [self.add_worker() for _ in range(workers)]

    def add_worker(self) -> subprocess.Popen[bytes]:
        words = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1", "--memory-limit", "0")
        return self._start("worker", self.address, *words)

    def close(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()

    def _address(self, told: Path) -> str:
        """Address that the scheduler writes into a file as soon as it listens."""
        until = time.monotonic() + 120
        while time.monotonic() < until and self.scheduler.poll() is None:
            try:
                return str(json.loads(told.read_text())["address"])
            except (OSError, ValueError):  # not there, or half written
                time.sleep(0.05)
        raise AssertionError("the scheduler did not start")

    def _start(self, kind: str, *words: str) -> subprocess.Popen[bytes]:
        # the start script of the environment, without its name being looked for on a path
        command = f"import sys; from distributed.cli.dask_{kind} import main; sys.exit(main())"
        return subprocess.Popen(
            [sys.executable, "-c", command, *words],
            cwd=self._folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )


@pytest.fixture
def cluster(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Cluster]:
    monkeypatch.setattr(module, "PATIENCE", 120.0)  # its workers start meanwhile
    (tmp_path / "dask").mkdir()
    found = Cluster(tmp_path / "dask", 2)
    yield found
    found.close()


def batch(folder: Path, out: str, *words: str) -> int:
    (folder / "junk.obj").write_text("v 0 0 0\n")
    (folder / "batch.toml").write_text(TEXT)
    return cli.main(["batch", str(folder / "batch.toml"), "-o", str(folder / out), "-q", *words])


@contextlib.contextmanager
def killed_once_runs_appear(process: subprocess.Popen[bytes], out: Path) -> Iterator[None]:
    """Kill a process from another thread as soon as the batch in a folder has recorded a run, and before its end."""
    is_over, was_amid = threading.Event(), threading.Event()

    def wait_and_kill() -> None:
        while not list((out / "outcomes").glob("hypar*.json")):
            if is_over.wait(0.02):
                return
        process.kill()
        if not is_over.is_set():
            was_amid.set()

    thread = threading.Thread(target=wait_and_kill)
    thread.start()
    try:
        yield
    finally:
        is_over.set()
        thread.join()
    assert was_amid.is_set(), "the batch was over before the process was killed"


@pytest.mark.slow
def test_a_cluster_makes_the_same_bytes_also_where_a_worker_is_killed(cluster: Cluster, tmp_path: Path) -> None:
    assert batch(tmp_path, "serial", "--workers", "1") == 8
    assert batch(tmp_path, "cluster", "--scheduler", cluster.address) == 8
    assert differences(tmp_path / "serial", tmp_path / "cluster") == []

    with killed_once_runs_appear(cluster.workers[0], tmp_path / "killed"):
        assert batch(tmp_path, "killed", "--scheduler", cluster.address) == 8
    assert cluster.workers[0].wait(60) == -signal.SIGKILL
    assert differences(tmp_path / "serial", tmp_path / "killed") == []


def test_a_scheduler_that_is_none_is_a_wrong_parameter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(module, "PATIENCE", 3.0)
    for address in ("tcp://127.0.0.1:1", "nonsense", "tcp://"):
        assert batch(tmp_path, "out", "--scheduler", address) == 2
        assert "--scheduler: expected the address of a Dask scheduler" in capsys.readouterr().err
    assert not (tmp_path / "out" / "summary.json").exists()
    assert batch(tmp_path, "out", "--scheduler", "tcp://127.0.0.1:1", "--workers", "2") == 2


def test_a_scheduler_without_workers_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(module, "PATIENCE", 5.0)
    (tmp_path / "dask").mkdir()
    lonely = Cluster(tmp_path / "dask", 0)
    try:
        assert batch(tmp_path, "out", "--scheduler", lonely.address) == 2
        assert "expected at least one worker within 5 s, got none" in capsys.readouterr().err
    finally:
        lonely.close()


@pytest.mark.slow
def test_a_scheduler_that_goes_away_leaves_what_is_finished(cluster: Cluster, tmp_path: Path) -> None:
    with killed_once_runs_appear(cluster.scheduler, tmp_path / "out"):
        assert batch(tmp_path, "out", "--scheduler", cluster.address) == 8
    assert cluster.scheduler.wait(60) == -signal.SIGKILL
    assert batch(tmp_path, "serial", "--workers", "1") == 8
    assert batch(tmp_path, "out") == 8
    assert differences(tmp_path / "serial", tmp_path / "out") == []
