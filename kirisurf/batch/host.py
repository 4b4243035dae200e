"""The program that makes the runs of a batch one after the other, each in a child process of its own.

It has imported all that a run needs, and forks: a child starts in milliseconds, and whatever becomes of it (a crash,
a hang, no memory left) is told as the outcome of that one run. It reads an `Order` a line from standard input and
answers with a line on standard output. Where its input ends, the batch has gone, and so does it, with its child.

Why: pools of the standard library lose all waiting tasks, or hang, when one child dies; a fresh interpreter a run
costs two seconds of imports, ten times what a small fit takes.
"""

from __future__ import annotations

import gc
import os
import select
import signal
import sys
import time
import warnings
from collections.abc import Sequence
from dataclasses import replace

from kirisurf.batch.limiting import adopt_orphans, die_with, end_family, end_orphans, limit_memory
from kirisurf.batch.order import Answer, Order
from kirisurf.failures import INTERNAL, INTERRUPTED, explained

READY = b"ready\n"
LEAST_GRACE, MOST_GRACE = 5.0, 60.0
"""Seconds that a run has to save what it has, once its time is over: a fifth of its limit within these."""

_LIMIT = 6
_KEPT = 8000
_MEMORY_WORDS = ("bad_alloc", "MemoryError", "Cannot allocate memory", "Memory allocation", "out of memory")


def main() -> None:
    """Answer orders until the input ends."""
    from kirisurf.batch.making import warm_up

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C in a terminal is for the batch, which ends its hosts
    answers = os.dup(1)
    os.dup2(2, 1)  # what a library prints is no answer
    adopt_orphans()
    warm_up()
    gc.collect()
    gc.freeze()  # so that children share what is there
    _write(answers, READY)
    waiting = b""
    while True:
        while b"\n" not in waiting:
            more = os.read(0, 65536)
            if not more:
                return
            waiting += more
        line, _, waiting = waiting.partition(b"\n")
        _write(answers, answered(Order.of(line)).line())


def answered(order: Order) -> Answer:
    """Make one run in a child process and return how that went; where the input ends, this process ends."""
    began = time.monotonic()
    answer_out, answer_in = os.pipe()
    said_out, said_in = os.pipe()
    host = os.getpid()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # libraries keep idle threads, which hold nothing
        child = os.fork()
    if child == 0:
        _be_child(order, host, answer_in, said_in)
    os.close(answer_in)
    os.close(said_in)
    spoken, said, ended = _follow(child, answer_out, said_out, began, order.seconds)
    _, status, usage = os.wait4(child, 0)
    end_orphans()
    os.close(answer_out)
    os.close(said_out)
    lines = tuple(said.decode("utf-8", "replace").splitlines()[-20:])
    answer = _judged(spoken, os.waitstatus_to_exitcode(status), lines, ended, order)
    peak = usage.ru_maxrss / (1e3 if sys.platform != "darwin" else 1e6)
    return replace(answer, seconds=round(time.monotonic() - began, 3), peak_mb=round(peak * 1.024, 1), said=lines)


def _be_child(order: Order, host: int, answer_in: int, said_in: int) -> None:
    """Become the process of one run; does not return."""
    code, message = INTERNAL, "the run ended without a word"
    try:
        os.setpgid(0, 0)
        die_with(host)
        nothing = os.open(os.devnull, os.O_RDWR)
        for stream, place in ((nothing, 0), (said_in, 1), (said_in, 2)):
            os.dup2(stream, place)
        for name in ("SIGINT", "SIGTERM", "SIGHUP"):
            signal.signal(getattr(signal, name), signal.default_int_handler)
        gc.unfreeze()
        limit_memory(order.memory_mb)
        from kirisurf.batch.making import make

        code, message = make(order)
    except BaseException as problem:
        code, message = explained(problem)
    finally:
        try:
            _write(answer_in, Answer(code, message).line())
        finally:
            os._exit(0)


def _follow(child: int, answer_out: int, said_out: int, began: float, seconds: float) -> tuple[bytes, bytes, str]:
    """Take what a child says until it ends; ask it to stop when its time is over, and end it soon after."""
    spoken = said = b""
    ended = ""
    asked_at = began + seconds
    killed_at = asked_at + min(max(0.2 * seconds, LEAST_GRACE), MOST_GRACE)
    open_streams = {0, answer_out, said_out}
    while answer_out in open_streams:
        now = time.monotonic()
        if now >= killed_at:
            end_family(child)
            killed_at, ended = float("inf"), ended or "time limit"
        elif now >= asked_at:
            os.kill(child, signal.SIGTERM)
            asked_at, ended = float("inf"), "time limit"
        pause = max(0.0, min(asked_at, killed_at, now + 3600.0) - now)
        for stream in select.select(sorted(open_streams), [], [], pause)[0]:
            content = os.read(stream, 65536)
            if stream == 0 and not content:
                end_family(child)
                os._exit(0)
            if stream == answer_out:
                spoken += content
            elif stream == said_out:
                said = (said + content)[-_KEPT:]
                if not ended and _is_out_of_memory(said.decode("utf-8", "replace").splitlines()):
                    # libraries that say so call exit(), which may wait for ever in a process that was forked
                    ended, asked_at, killed_at = "memory limit", float("inf"), now + LEAST_GRACE
            if not content:
                open_streams.discard(stream)
    return spoken, said, ended


def _judged(spoken: bytes, exit_code: int, said: tuple[str, ...], ended: str, order: Order) -> Answer:
    """How a child ended, from its answer, its exit and what ended it."""
    if spoken.endswith(b"\n"):
        answer = Answer.of(spoken)
        # asked to stop inside a library, that may come out as an error of its own
        if not ended or answer.code not in (INTERRUPTED, _LIMIT, INTERNAL):
            is_memory = answer.code == _LIMIT and "memory" in answer.message
            return replace(answer, end="memory limit") if is_memory else answer
    if ended == "memory limit" or _is_out_of_memory(said):
        words = f"memory limit: expected at most {order.memory_mb:g} MB, got more asked for"
        return Answer(_LIMIT, words, "memory limit")
    if ended:
        return Answer(_LIMIT, f"time limit: expected an end within {order.seconds:g} s, got none", ended)
    from kirisurf.formats.child import signal_name

    how = f"death by {signal_name(-exit_code)}" if exit_code < 0 else f"exit with {exit_code} and no answer"
    return Answer(INTERNAL, f"crashed: expected an answer of the process that makes the run, got {how}", "crashed")


def _is_out_of_memory(said: Sequence[str]) -> bool:
    return any(word in line for line in said for word in _MEMORY_WORDS)


def _write(handle: int, content: bytes) -> None:
    while content:
        content = content[os.write(handle, content) :]
