"""`kirisurf curvature`: hole curvature of a run."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command

_MAPS = ("mean_curvature", "gaussian_curvature")
_COLUMNS = (
    "hole",
    "mean_curvature",
    "target_mean_curvature",
    "gaussian_curvature",
    "target_gaussian_curvature",
    "flag",
)
_TEXT = """\
Every hole of the deployed sheet is filled by a smooth (bicubic) patch through the tiles round it. The table
gives its mean and Gaussian curvature at its center, and the target's own at the closest point; curvature.csv
in the run holds the averages over the hole, the areas and the places too. Mean curvature is positive where the
surface bends toward its normal. Flag 1: the vertices round the hole do not determine its curvature.

Vertices off the target by a distance d change the curvature of a hole by about d / (edge length)^2: the summary
says how much of what is seen is the target's curvature and how much the fit's."""

_EXAMPLES = """\
  kirisurf curvature runs/hood                      table and summary
  kirisurf curvature runs/hood --csv holes.csv      the full table as a file
  kirisurf curvature runs/hood --maps pictures      the two maps as PNG"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "curvature", "show the curvature of a run's holes", _TEXT, _EXAMPLES)
    parser.add_argument("folder", metavar="RUN", help="run folder")
    parser.add_argument("--csv", metavar="FILE", help="write the full table")
    parser.add_argument("--maps", metavar="DIR", help="write the maps as pictures into this folder")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.formats.atomic import write_text
    from kirisurf.runs import read_run
    from kirisurf.runs.table import curvature_csv, curvature_rows

    run_read = read_run(arguments.folder)
    fields = {name: values for (where, name), values in run_read.fields.items() if where == "hole"}
    rows = curvature_rows(fields)
    output.product(
        "  ".join(f"{name:>12}" for name in ("hole", "mean", "target mean", "Gaussian", "target Gauss", "flag"))
    )
    for row in rows:
        output.product("  ".join(f"{_cell(row[name]):>12}" for name in _COLUMNS))
    summary = {name: value for name, value in run_read.result["measures"].items() if "curvature" in name}
    for name, value in summary.items():
        output.message(f"{name.replace('_', ' ')}: {_cell(math.nan if value is None else value)}")
    code = 0
    maps: dict[str, Path] = {}
    if arguments.csv is not None:
        write_text(arguments.csv, curvature_csv(fields))
    if arguments.maps is not None:
        from kirisurf.publishing import draw_pictures, run_sheet

        folder = _made(Path(arguments.maps))
        maps, reason = draw_pictures(run_sheet(run_read), folder, _MAPS)
        if reason:
            output.warning(reason)
            code = 1
    return Outcome(code, {"holes": rows, "summary": summary, "maps": {name: str(path) for name, path in maps.items()}})


def _cell(value: float | int) -> str:
    return str(value) if isinstance(value, int) else "-" if math.isnan(value) else f"{value:.5g}"


def _made(folder: Path) -> Path:
    from kirisurf.errors import OutputError

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise OutputError(f"{folder}: expected to make this folder, got: {problem.strerror or problem}") from None
    return folder
