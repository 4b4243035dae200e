"""The runs of a batch on a Dask cluster: the scheduler hands out orders, every worker keeps hosts as this machine does.

Dask distributed hands out the tasks and gives those of a worker that is lost to another; a run itself is made in a
process of its own there too, so that a crash never ends a worker. All workers must see the folder of the batch and
the targets under the same paths, and have the same versions: both are asked before anything is handed out.
"""

from __future__ import annotations

import atexit
import contextlib
import importlib.util
import queue
import uuid
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from kirisurf.batch.engines import Engine
from kirisurf.batch.hosting import Host
from kirisurf.batch.order import Answer, Order
from kirisurf.errors import ParameterError
from kirisurf.failures import INTERNAL
from kirisurf.provenance import source_digest
from kirisurf.runs.record import versions

PATIENCE = 20.0
"""Seconds in which a scheduler has to answer, and to have a worker."""

_hosts: queue.SimpleQueue[Host] = queue.SimpleQueue()


class ClusterLostError(ParameterError):
    """The scheduler went away while runs were being made."""

    exit_code = 8


def on_cluster(address: str, folder: Path) -> Engine:
    """Return an engine that hands orders to the workers of a scheduler.

    Parameters
    ----------
    address : str
        Of the scheduler, such as tcp://192.0.2.7:8786.
    folder : Path
        Of the batch; it must exist.

    Raises
    ------
    ParameterError
        Where Dask is not installed, no scheduler or worker answers, or a worker has other versions or does not see
        the folder.
    ClusterLostError
        From the engine, where the scheduler goes away.
    """
    if importlib.util.find_spec("distributed") is None:
        raise ParameterError(
            "--scheduler: expected Dask distributed, got none: pip install 'kirisurf[cluster]', here and there"
        )

    # asked before anything is handed out, or any summary written
    client = _connected(address)
    try:
        _check_workers(client, folder)
    except BaseException:
        _leave(client)
        raise

    def answers(orders: Sequence[Order]) -> Iterator[tuple[int, Answer]]:
        from distributed import CancelledError, as_completed

        try:
            # an order is its own, whatever another batch may have asked: no two tasks share a key
            mark = uuid.uuid4().hex[:8]
            futures = {
                client.submit(_answer, order.line(), key=f"kirisurf-{mark}-{k}", pure=False): k
                for k, order in enumerate(orders)
            }
            try:
                for future in as_completed(futures, loop=client.loop):
                    try:
                        # a worker may also be lost with an answer that nobody has fetched yet
                        answer = Answer.of(future.result())
                    except (CancelledError, OSError):
                        raise
                    except Exception as problem:
                        # the worker was lost with it again and again: it is this run that ends workers
                        words = f"crashed: expected a worker that answers, got {type(problem).__name__}"
                        answer = Answer(INTERNAL, words, "crashed")
                    yield futures[future], answer
                    future.release()
            except (CancelledError, OSError) as problem:
                raise ClusterLostError(f"--scheduler: expected {address} to stay, got: {problem}") from None
            finally:
                with contextlib.suppress(Exception):  # a scheduler that is gone has nothing to forget
                    client.cancel(list(futures), force=True)
        finally:
            _leave(client)

    return answers


def _leave(client: Any) -> None:
    """Close a client; a scheduler that does not answer is no reason to lose what was made."""
    with contextlib.suppress(Exception):
        client.close(timeout=5)


def _connected(address: str) -> Any:
    from distributed import Client

    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False, name="kirisurf-batch")
    except (OSError, ValueError, TypeError, ImportError) as problem:
        raise ParameterError(
            f"--scheduler: expected the address of a Dask scheduler such as tcp://127.0.0.1:8786, "
            f"got {address!r}: {problem}"
        ) from None
    return client


def _check_workers(client: Any, folder: Path) -> None:
    """Check that there are workers, which are as we are and see what we see."""
    from distributed import TimeoutError as NoAnswerError

    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except (NoAnswerError, TimeoutError):
        raise ParameterError(f"--scheduler: expected at least one worker within {PATIENCE:g} s, got none") from None
    token = folder / f".kirisurf-{uuid.uuid4().hex}.tmp"
    token.write_text("seen?", encoding="ascii")
    try:
        for worker, seen in client.run(_as_seen, str(token), on_error="return").items():
            if not isinstance(seen, dict):
                raise ParameterError(
                    f"--scheduler: expected kirisurf on every worker, got {type(seen).__name__}: {seen} on {worker}"
                )
            if not seen["folder"]:
                raise ParameterError(
                    f"--scheduler: expected a folder that every worker sees, got {folder}, which {worker} does not"
                )
            ours = {**versions(), "source": source_digest()}
            other = {name: seen["versions"].get(name) for name in ours if seen["versions"].get(name) != ours[name]}
            if other:
                theirs = ", ".join(f"{name} {value} (here {ours[name]})" for name, value in other.items())
                raise ParameterError(f"--scheduler: expected the versions of this machine, got {theirs} on {worker}")
    finally:
        token.unlink(missing_ok=True)


def _as_seen(token: str) -> dict[str, Any]:
    """What a worker is and sees; runs there."""
    return {"folder": Path(token).is_file(), "versions": {**versions(), "source": source_digest()}}


def _answer(line: bytes) -> bytes:
    """Make one run; runs on a worker, which keeps its hosts for the next."""
    try:
        host = _hosts.get_nowait()
    except queue.Empty:
        host = Host()
        atexit.register(host.close)
    try:
        return host.answer(Order.of(line)).line()
    finally:
        _hosts.put(host)
