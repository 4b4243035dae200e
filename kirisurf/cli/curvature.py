"""`kirisurf curvature`: hole curvature of runs."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command

if TYPE_CHECKING:
    from kirisurf.hole_table import HoleTable

_COLUMNS = {
    "hole": "hole",
    "mean_curvature": "mean",
    "target_mean_curvature": "target mean",
    "gaussian_curvature": "Gaussian",
    "target_gaussian_curvature": "target Gauss",
    "flag": "flag",
}
_SUMMARY = {
    "gaussian_curvature_difference_median": "|K - target|",
    "gaussian_curvature_difference_relative": "over |K|",
    "gaussian_curvature_target_share": "target's part",
    "mean_curvature_difference_median": "|H - target|",
    "mean_curvature_difference_relative": "over |H|",
    "mean_curvature_target_share": "target's part",
}
_WIDTH = 13
_FILES = ("curvature.csv", "curvature.json", "holes.vtp")
_TEXT = """\
Every hole of the deployed sheet is filled by a smooth (bicubic) patch through the tiles round it. The table
gives its mean and Gaussian curvature at its center, and the target's own at the closest point; the files hold
what is averaged and integrated over the hole, angle defects, areas and places too. Mean curvature is positive
where the surface bends toward its normal. Flag 1: the vertices round the hole do not determine its curvature.

The summary says how much of what is seen is the target's curvature, how much comes from the fit, whose vertices
lie off the target, and how much from too few tiles. Of several runs the summaries stand side by side."""

_EXAMPLES = """\
  kirisurf curvature runs/hood                           table and summary
  kirisurf curvature runs/hood --to holes.csv holes.vtp  every number as files: CSV, JSON, VTP
  kirisurf curvature runs/hood -o curvature              the same and the maps as PNG, into one folder
  kirisurf curvature runs/hood --patches corners         patches through the corners of the holes alone
  kirisurf curvature runs/a runs/b --to both.csv         several runs, the first column names them"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "curvature", "show the curvature of a run's holes", _TEXT, _EXAMPLES)
    parser.add_argument("folders", metavar="RUN", nargs="+", help="run folders")
    parser.add_argument("--to", metavar="FILE", nargs="+", default=[], help="write .csv, .json or .vtp, by suffix")
    parser.add_argument("-o", "--output", metavar="DIR", help=f"write {', '.join(_FILES)} and maps into this folder")
    parser.add_argument("--csv", metavar="FILE", help="short for --to FILE.csv")
    parser.add_argument("--maps", metavar="DIR", help="write the maps alone as pictures into this folder")
    parser.add_argument(
        "--patches",
        metavar="HOW",
        default="tiles",
        help="what a patch is fitted to: tiles (round the hole, as measured in the run), corners, corners_and_normals",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.errors import ParameterError
    from kirisurf.formats.atomic import write_text
    from kirisurf.hole_table import PATCHES, check_suffix, curvature, save_tables, tables_csv
    from kirisurf.runs import read_run

    for path in arguments.to:
        check_suffix(path, len(arguments.folders))
    if arguments.patches not in PATCHES:
        raise ParameterError(f"--patches: expected one of {', '.join(PATCHES)}, got {arguments.patches!r}")
    runs = [read_run(folder) for folder in arguments.folders]
    tables = [curvature(each, arguments.patches) for each in runs]
    if len(tables) == 1:
        _show_holes(tables[0], output)
    else:
        _show_runs(tables, output)
    written = [save_tables(tables, path) for path in arguments.to]
    if arguments.csv is not None:
        write_text(arguments.csv, tables_csv(tables))
        written.append(Path(arguments.csv))
    reason = ""
    for table, each, name in zip(tables, runs, _distinct([table.name for table in tables]), strict=True):
        inner = name if len(tables) > 1 else ""
        if arguments.output is not None:
            folder = _made(Path(arguments.output) / inner)
            written += [save_tables([table], folder / file) for file in _FILES]
        places = [Path(place) / inner for place in (arguments.output, arguments.maps) if place is not None]
        for place in places:
            maps, reason = _draw(table, each, _made(place))
            written += maps
    if reason:
        output.warning(reason)
    for path in written:
        output.message(str(path))
    return Outcome(1 if reason else 0, _result(tables, written))


def _result(tables: Sequence[HoleTable], written: Sequence[Path]) -> dict[str, Any]:
    files = {"files": [str(path) for path in written]}
    maps = {"maps": {path.stem: str(path) for path in written if path.suffix == ".png"}}
    if len(tables) > 1:
        return {"runs": [table.as_dict() for table in tables], **files}
    table = tables[0]
    return {"holes": table.rows, "summary": dict(table.numbers), "patches": table.patches, **maps, **files}


def _show_holes(table: HoleTable, output: Output) -> None:
    """Print a row for every hole, and beside it the summary in words."""
    from viewers.number_words import measures_by_heading

    output.product("  ".join(f"{label:>12}" for label in _COLUMNS.values()))
    for row in table.rows:
        output.product("  ".join(f"{_cell(row[name]):>12}" for name in _COLUMNS))
    for heading, found in measures_by_heading(table.numbers, table.units or "unit").items():
        output.message(f"{heading}:")
        for each in found:
            output.message(f"  {each.label:<58} {each.value:>10} {each.unit}".rstrip())


def _show_runs(tables: Sequence[HoleTable], output: Output) -> None:
    """Print a row for every run."""
    from viewers.number_words import number_in_words

    width = max(3, *(len(table.name) for table in tables))
    output.product("  ".join([f"{'run':<{width}}", f"{'holes':>6}", *(f"{t:>{_WIDTH}}" for t in _SUMMARY.values())]))
    for table in tables:
        words = [number_in_words(name, table.numbers.get(name), table.units or "unit") for name in _SUMMARY]
        cells = [f"{(each.value + ' ' + each.unit).strip():>{_WIDTH}}" for each in words]
        output.product("  ".join([f"{table.name:<{width}}", f"{len(table.holes):>6}", *cells]))


def _draw(table: HoleTable, read: Any, folder: Path) -> tuple[list[Path], str]:
    """Draw the maps of curvature; patches of another construction are colored on the polygons of the holes."""
    from dataclasses import replace

    from kirisurf.hole_table import PATCHES
    from kirisurf.publishing import MAPS, draw_pictures, run_sheet

    drawn = run_sheet(read)
    if table.patches != PATCHES[0]:
        holes = {("hole", name): values for name, values in table.fields.items() if values.ndim == 1}
        drawn = replace(drawn, fields={**drawn.fields, **holes}, patches=None)
    pictures, reason = draw_pictures(drawn, folder, (*(name for name in MAPS if "curvature" in name), "residence"))
    return list(pictures.values()), reason


def _distinct(names: Sequence[str]) -> list[str]:
    """Names of folders: those that are the same get a number."""
    return [name if names.index(name) == k else f"{name}-{names[:k].count(name) + 1}" for k, name in enumerate(names)]


def _cell(value: float | int) -> str:
    return str(value) if isinstance(value, int) else "-" if math.isnan(value) else f"{value:.5g}"


def _made(folder: Path) -> Path:
    from kirisurf.errors import OutputError

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise OutputError(f"{folder}: expected to make this folder, got: {problem.strerror or problem}") from None
    return folder
