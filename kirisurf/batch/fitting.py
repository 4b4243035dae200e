"""The front of a batch: what is asked for and where it goes in, the summary out."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from kirisurf.batch.baseline import baseline_text, read_baseline
from kirisurf.batch.engines import Engine, on_this_machine
from kirisurf.batch.folder import BatchFolder
from kirisurf.batch.reading import BatchSpec, Limits, read_batch
from kirisurf.batch.running import Asking, Told, run_batch
from kirisurf.batch.writing import batch_text
from kirisurf.errors import OutputError, ParameterError
from kirisurf.formats.atomic import write_text
from kirisurf.solvers.team import n_cores

MOST_WORKERS = 1024


def fit_batch(
    batch: str | os.PathLike[str] | BatchSpec,
    folder: str | os.PathLike[str],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    baseline: str | os.PathLike[str] | None = None,
    accept: bool = False,
    pictures: bool = False,
    again: bool = False,
    limits: Limits | None = None,
    told: Told | None = None,
    begun: Callable[[BatchSpec], None] | None = None,
    **options: Any,
) -> dict[str, Any]:
    r"""Fit many targets into one folder, each in a process of its own.

    Started again with the same folder, runs that are finished are kept (see :mod:`kirisurf.batch.folder`).

    Parameters
    ----------
    batch : path or BatchSpec
        A TOML file, a folder of targets, or a table; see :func:`kirisurf.batch.reading.read_batch`.
    folder : path
        New, empty, or that of a batch before.
    workers : int, optional
        Items at a time on this machine; by default one a core.
    scheduler : str, optional
        Address of a Dask scheduler whose workers make the runs instead.
    baseline : path, optional
        What is compared with: a baseline file, or the folder of another batch.
    accept : bool
        Write the file `baseline` anew.
    pictures : bool
        Draw every run's pictures.
    again : bool
        Make also what is finished but did not end as expected.
    limits : Limits, optional
        Of one item, instead of those that the batch gives.
    told : Told, optional
        Receives every outcome.
    begun : callable, optional
        Receives the batch, once it is read.
    **options
        Options of :class:`kirisurf.spec.FitSpec` for all items.

    Returns
    -------
    dict
        The summary, as `summary.json` holds it; `forgotten` names runs in the folder that belong to no item.

    Raises
    ------
    ParameterError, UnreadableError
        Where the batch, an option, the scheduler or the baseline is wrong.
    OutputError
        Where the folder cannot be written, or another batch writes to it.

    Examples
    --------
    >>> import kirisurf, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as made:
    ...     spec = pathlib.Path(made, "batch.toml")
    ...     _ = spec.write_text('targets = ["hypar", "sphere"]\n[options]\ncells = "1x1"\n')
    ...     summary = kirisurf.fit_batch(spec, pathlib.Path(made, "out"))
    >>> [(item["name"], item["certified"]) for item in summary["items"]]
    [('hypar', True), ('sphere', True)]
    """
    spec = batch if isinstance(batch, BatchSpec) else read_batch(batch, options)
    if limits is not None:
        spec = replace(spec, limits=Limits.of(asdict(limits)))
    target = _accepted(baseline) if accept else None
    is_compared = baseline is not None and not (target is not None and not target.exists())
    before = read_baseline(baseline) if is_compared and baseline is not None else None
    asking = Asking(pictures, again, before, "" if baseline is None else Path(baseline).name, spec.source or spec.title)
    _check_workers(workers, scheduler)
    if begun is not None:
        begun(spec)
    with BatchFolder(folder, batch_text(spec)) as opened:
        engine = _engine(workers, scheduler, opened)
        summary = run_batch(spec, opened, engine, asking, told or Told())
        if target is not None:
            write_text(target, baseline_text(summary["items"], before))
        return {**summary, "forgotten": list(opened.forgotten(spec))}


def _accepted(baseline: str | os.PathLike[str] | None) -> Path:
    """The file that is to be written anew."""
    if baseline is None:
        raise ParameterError("--accept: expected together with --baseline FILE, got it alone")
    path = Path(baseline)
    if path.is_dir() or path.suffix.lower() != ".toml":
        raise ParameterError(f"--accept: expected --baseline to name a .toml file, got {str(path)!r}")
    if not path.absolute().parent.is_dir():
        raise OutputError(f"{path}: expected a folder to write to, got one that does not exist")
    return path


def _check_workers(workers: int | None, scheduler: str | None) -> None:
    if scheduler is not None and workers is not None:
        raise ParameterError("--workers: expected without --scheduler, whose workers are its own, got both")
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise ParameterError(f"--workers: expected a whole number from 1 to {MOST_WORKERS}, got {workers}")


def _engine(workers: int | None, scheduler: str | None, folder: BatchFolder) -> Engine:
    """Who makes the runs."""
    if scheduler is None:
        return on_this_machine(n_cores() if workers is None else workers)
    from kirisurf.batch.cluster import on_cluster

    return on_cluster(scheduler, folder.path)
