"""Tasks shared by the cores of the machine."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait

Task = Callable[[], None]


def n_cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Team:
    """The calling thread and its helpers; a context manager that sends the helpers home.

    Parameters
    ----------
    size : int
        Number of threads, the calling one among them.
    """

    def __init__(self, size: int) -> None:
        self._n_helpers = size - 1
        self._pool = ThreadPoolExecutor(self._n_helpers) if size > 1 else None

    def __enter__(self) -> Team:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown()

    def run(self, tasks: Sequence[Task]) -> None:
        """Do independent tasks; the next one goes to whoever is free. An exception of a task is raised in the end."""
        if self._pool is None or len(tasks) < 2:
            for task in tasks:
                task()
            return
        waiting = deque(tasks)

        def work() -> None:
            while waiting:
                try:
                    task = waiting.popleft()
                except IndexError:  # another took the last one
                    return
                try:
                    task()
                except BaseException:
                    waiting.clear()
                    raise

        helpers = [self._pool.submit(work) for _ in range(min(self._n_helpers, len(tasks) - 1))]
        try:
            work()
        finally:
            wait(helpers)
        for helper in helpers:
            helper.result()
