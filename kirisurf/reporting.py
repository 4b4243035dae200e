"""Reports of finished designs, from Python and for the command line: one page on one design, or comparing several."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kirisurf.deployment_folder import FIGURE, FOLDER, read_deployment
from kirisurf.errors import ParameterError
from kirisurf.publishing import (
    PICTURES,
    draw_pictures,
    numbers_of,
    report_parts,
    run_sheet,
    shared_ranges,
    write_report,
)
from kirisurf.runs import Run, read_run

if TYPE_CHECKING:
    from viewers.report import ReportParts

SUFFIXES = (".html", ".json")
_COMPARED, _COMPARED_IN_PLANE = ("deployed", "gaussian_curvature"), ("deployed", "pattern")


def report(designs: Any, path: str | os.PathLike[str], *, pictures: bool = True) -> Path:
    """Write a report: one self-contained page on a design, or one that compares several; or its numbers as JSON.

    Parameters
    ----------
    designs : Design, Run, path of a run folder, or a sequence of these
    path : path
        Its suffix chooses: .html is the page, .json every number that it shows, in full precision.
    pictures : bool
        Draw the pictures that a run does not hold, where OpenGL works.

    Raises
    ------
    ParameterError
        Where there is nothing to report, or the suffix is another.
    UnreadableError
        Where a run cannot be read.
    OutputError
        Where the file cannot be written.

    Examples
    --------
    >>> import json, kirisurf, tempfile
    >>> design = kirisurf.fit("hypar", cells=(2, 2))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     numbers = json.loads(report(design, f"{folder}/hypar.json").read_text())
    >>> numbers["certified"], 0.5 < numbers["curvature"]["gaussian_curvature"]["target_share"] < 1
    (True, True)
    """
    several = isinstance(designs, Sequence) and not isinstance(designs, (str, bytes))
    sources = list(designs) if several else [designs]
    path = check_report(path, len(sources))
    with tempfile.TemporaryDirectory() as scratch:
        runs, titles = [], []
        for k, source in enumerate(sources):
            folder = Path(scratch) / str(k)
            runs.append(_as_run(source, folder / "run"))
            # a design that is not saved has no name but that of its target
            titles.append("" if runs[-1].folder == folder / "run" else runs[-1].name)
        drawn = Path(scratch) if pictures and path.suffix.lower() != ".json" else None
        parts = compared_parts(runs, titles, drawn) if len(runs) > 1 else [run_parts(runs[0], drawn)]
        return write_report(parts[0] if len(parts) == 1 else parts, path)


def report_numbers(runs: Sequence[Run]) -> dict[str, Any]:
    """Return every number that the report of one run, or the comparison of several, shows."""
    return numbers_of([run_parts(runs[0])] if len(runs) == 1 else compared_parts(runs, [run.name for run in runs]))


def check_report(path: str | os.PathLike[str], n_designs: int = 1) -> Path:
    """Return the path of a report, checked before anything is read; raises as `report`."""
    if not n_designs:
        raise ParameterError("report: expected at least one design, got none")
    if Path(path).suffix.lower() not in SUFFIXES:
        got = Path(path).suffix or "none"
        raise ParameterError(f"{path}: expected a suffix among {', '.join(SUFFIXES)} for a report, got {got}")
    return Path(path)


def run_parts(run: Run, scratch: Path | None = None, title: str = "") -> ReportParts:
    """Return what a report on a run shows: the pictures that it holds, and those that can be drawn.

    Parameters
    ----------
    run : Run
    scratch : path, optional
        Folder for pictures that the run does not hold; without it none are drawn.
    title : str
        By default the name of the target.
    """
    pictures = {name: run.folder / f"{name}.png" for name in PICTURES if (run.folder / f"{name}.png").is_file()}
    reason = "" if pictures else "The run holds none."
    if scratch is not None:
        missing = [name for name in PICTURES if name not in pictures and name != "overview"]
        drawn, problem = draw_pictures(run_sheet(run), _made(scratch / "missing"), missing) if missing else ({}, "")
        found = {**pictures, **drawn}
        pictures, reason = {name: found[name] for name in PICTURES if name in found}, problem or reason
    parts = report_parts(run.result, run.contracted, run.fields, pictures, reason, title, run.spec)
    way, figure = read_deployment(run), run.folder / FOLDER / FIGURE
    return replace(parts, deployment=way, deployment_picture=figure if figure.is_file() else None)


def compared_parts(runs: Sequence[Run], titles: Sequence[str], scratch: Path | None = None) -> list[ReportParts]:
    """Return what a comparison shows; where it can be drawn, K of all designs for one target has one color scale."""
    parts = [run_parts(run, None, title) for run, title in zip(runs, _distinct(runs, titles), strict=True)]
    if scratch is None:
        return parts
    ranges = shared_ranges(parts)
    drawn = []
    for k, (run, part) in enumerate(zip(runs, parts, strict=True)):
        folder = _made(scratch / f"compared-{k}")
        sheet = run_sheet(run)
        names = _COMPARED_IN_PLANE if sheet.is_planar else _COMPARED
        pictures, reason = draw_pictures(sheet, folder, names, ranges)
        drawn.append(replace(part, pictures={**part.pictures, **pictures}, no_pictures=reason or part.no_pictures))
    return drawn


def _distinct(runs: Sequence[Run], titles: Sequence[str]) -> list[str]:
    """Titles of the columns: those that are the same get a number."""
    names = [title or str(run.result["target"]["name"]) for run, title in zip(runs, titles, strict=True)]
    return [name if names.count(name) == 1 else f"{name} ({names[:k].count(name) + 1})" for k, name in enumerate(names)]


def _as_run(source: Any, folder: Path) -> Run:
    """The source as a run: its files are what a report is made from, so that a design is saved."""
    if isinstance(source, Run):
        return source
    if isinstance(source, (str, os.PathLike)):
        return read_run(source)
    if not hasattr(source, "save_into"):
        raise ParameterError(f"report: expected a design, a run or its folder, got {type(source).__name__}")
    run: Run = source.save(folder, pictures=False)
    return run


def _made(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder
