"""A fit computes with BLAS on one thread, and leaves the caller's threads as they were."""

from __future__ import annotations

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

import kirisurf
from kirisurf.judging import certified
from kirisurf.one_thread import on_one_thread
from kirisurf.states import Step


def threads() -> set[int]:
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_a_fit_runs_on_one_thread_and_gives_the_threads_back() -> None:
    seen: list[set[int]] = []

    def watch(step: Step) -> None:
        seen.append(threads())

    with threadpool_limits(2, user_api="blas"):
        before = threads()
        kirisurf.fit("hypar", cells=(2, 2), progress=watch)
        assert threads() == before
    assert seen and all(found == {1} for found in seen)


def test_what_is_raised_inside_passes_and_gives_the_threads_back() -> None:
    @on_one_thread
    def broken() -> None:
        assert threads() == {1}
        raise ZeroDivisionError

    with threadpool_limits(2, user_api="blas"):
        before = threads()
        try:
            broken()
        except ZeroDivisionError:
            assert threads() == before
        else:
            raise AssertionError("expected what was raised inside")


def test_the_name_and_the_words_stay() -> None:
    assert certified.__name__ == "certified" and "Certify a design" in (certified.__doc__ or "")
    assert on_one_thread(np.add)(1, 2) == 3
