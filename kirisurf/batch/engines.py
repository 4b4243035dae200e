"""Who makes the runs of a batch: processes of this machine, or the workers of a Dask scheduler."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

from kirisurf.batch.hosting import Host, Stopped
from kirisurf.batch.order import Answer, Order

Engine = Callable[[Sequence[Order]], Iterator[tuple[int, Answer]]]
"""Takes orders; gives the number of an order and its answer, in the order in which they end."""


def on_this_machine(workers: int, threads: int = 1) -> Engine:
    """Return an engine of host processes, one for each of so many orders at a time.

    Threads of the standard library hand out the orders: each waits for a host.
    """

    def answers(orders: Sequence[Order]) -> Iterator[tuple[int, Answer]]:
        if not orders:
            return
        n = min(workers, len(orders))
        hosts = [Host(threads) for _ in range(n)]
        free: queue.SimpleQueue[Host] = queue.SimpleQueue()
        for host in hosts:
            free.put(host)
        stopped = threading.Event()

        def answer(order: Order) -> Answer:
            host = free.get()
            try:
                if stopped.is_set():
                    raise Stopped
                return host.answer(order)
            finally:
                free.put(host)

        pool = ThreadPoolExecutor(n)
        try:
            waiting: dict[Future[Answer], int] = {}
            numbers = iter(range(len(orders)))
            while True:
                # few at a time: a hundred thousand orders need no hundred thousand futures
                while len(waiting) < 2 * n and (number := next(numbers, None)) is not None:
                    waiting[pool.submit(answer, orders[number])] = number
                if not waiting:
                    return
                done = wait(waiting, 0.5, FIRST_COMPLETED).done
                for future in sorted(done, key=lambda each: waiting[each]):
                    yield waiting.pop(future), future.result()
        finally:
            stopped.set()
            for host in hosts:
                host.close()
            pool.shutdown(wait=True, cancel_futures=True)

    return answers
