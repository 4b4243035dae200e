"""The batch's side of a host: starts the program, hands it orders, and starts another where it is gone."""

from __future__ import annotations

import os
import select
import subprocess
import sys
import threading
import time
from collections.abc import Mapping
from pathlib import Path

from kirisurf.batch.host import MOST_GRACE, READY
from kirisurf.batch.order import Answer, Order
from kirisurf.errors import KirisurfError
from kirisurf.failures import INTERNAL

_BEGIN = "import sys; sys.path.append(sys.argv[1]); from kirisurf.batch.host import main; main()"
_START_SECONDS = 120.0
_TRIES = 2


class HostGoneError(KirisurfError):
    """A host ended, or was ended, in the middle of an order."""


class Stopped(Exception):
    """The batch was asked to end."""


class Host:
    """A host process; it is started when it is first needed.

    Parameters
    ----------
    threads : int
        Threads of the linear algebra in one run.
    """

    def __init__(self, threads: int = 1) -> None:
        self._threads = threads
        self._process: subprocess.Popen[bytes] | None = None
        self._waiting = b""
        self._closing = threading.Event()
        self._ending = threading.Lock()

    def answer(self, order: Order) -> Answer:
        """Return how an order went; where the host itself is gone, another one tries once more.

        Raises
        ------
        Stopped
            Where the host was closed from another thread.
        """
        problem: Exception | None = None
        for _ in range(_TRIES):
            try:
                return self._asked(order)
            except HostGoneError as found:
                problem = found
                self._end()
            except Stopped:
                # closed while the process was being started: nobody else knows of it
                self._end()
                raise
        if self._closing.is_set():
            raise Stopped
        return Answer(INTERNAL, f"crashed: {problem}", "crashed")

    def close(self) -> None:
        """End the host and the run that it makes."""
        self._closing.set()
        self._end()

    def _asked(self, order: Order) -> Answer:
        process = self._started()
        orders = process.stdin
        if orders is None:
            raise HostGoneError("expected a process to write to, got none")
        try:
            orders.write(order.line())
            orders.flush()
        except (OSError, ValueError):
            raise HostGoneError(self._words(process)) from None
        # it keeps the time itself; this is for one that does not answer at all
        return Answer.of(self._line(process, order.seconds + MOST_GRACE + 30.0))

    def _started(self) -> subprocess.Popen[bytes]:
        if self._closing.is_set():
            raise Stopped
        process = self._process  # close() may take it away at any time
        if process is None or process.poll() is not None:
            self._end()
            self._waiting = b""
            home = str(Path(__file__).resolve().parents[2])
            process = self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", _BEGIN, home],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env=_environment(self._threads),
                start_new_session=True,
            )
            if self._line(process, _START_SECONDS) != READY:
                raise HostGoneError("expected a process that is ready, got other words")
        return process

    def _line(self, process: subprocess.Popen[bytes], seconds: float) -> bytes:
        out = process.stdout
        if out is None:
            raise HostGoneError("expected a process to read from, got none")
        until = time.monotonic() + seconds
        while b"\n" not in self._waiting:
            left = until - time.monotonic()
            if left <= 0:
                raise HostGoneError(f"expected an answer within {seconds:g} s, got none")
            try:
                ready = select.select([out], [], [], min(left, 1.0))[0]
                more = os.read(out.fileno(), 65536) if ready else None
            except (OSError, ValueError):
                more = b""
            if self._closing.is_set():
                raise Stopped
            if more == b"":
                raise HostGoneError(self._words(process))
            self._waiting += more or b""
        line, _, self._waiting = self._waiting.partition(b"\n")
        return line + b"\n"

    def _words(self, process: subprocess.Popen[bytes]) -> str:
        from kirisurf.formats.child import signal_name

        try:
            code = process.wait(5.0)
        except subprocess.TimeoutExpired:
            return "expected a process that answers, got one that closed its output"
        how = f"death by {signal_name(-code)}" if code < 0 else f"exit code {code}"
        return f"expected the process that keeps the run to stay, got {how}"

    def _end(self) -> None:
        with self._ending:
            process, self._process = self._process, None
            if process is None:
                return
            process.kill()  # its child dies with it
            process.wait()
            for stream in (process.stdin, process.stdout):
                if stream is not None:
                    try:
                        stream.close()
                    except OSError:  # an order that was never taken
                        continue


def _environment(threads: int) -> Mapping[str, str]:
    few = {name: str(threads) for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
    return {**os.environ, **few, "QT_QPA_PLATFORM": "offscreen", "PYTHONUNBUFFERED": "1"}
