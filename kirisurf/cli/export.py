"""`kirisurf export`: cutting files and interchange formats."""

from __future__ import annotations

import argparse
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command, number

_TEXT = """\
The suffix chooses what is written:

  .svg   the cut pattern to scale, layers cut, hinge and outline
  .obj   the tiles of a state as polygons, full precision
  .vtp   the same with every named field, for ParaView and pyvista
  .stl   the tiles of a state as triangles
  .csv   the curvature of every hole

DXF is not available in this version. OBJ, VTP and STL hold the flat sheet unless --state deployed is given."""

_EXAMPLES = """\
  kirisurf export runs/hood --to hood.svg --hinge-width 0.8
  kirisurf export runs/hood --to hood.stl hood.vtp --state deployed"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "export", "write cutting files and interchange formats of a run", _TEXT, _EXAMPLES)
    parser.add_argument("folder", metavar="RUN", help="run folder")
    parser.add_argument(
        "--to", metavar="FILE", nargs="+", required=True, help="files to write; the suffix is the format"
    )
    parser.add_argument("--state", metavar="NAME", help="contracted (default) or deployed, for OBJ, VTP and STL")
    parser.add_argument("--hinge-width", metavar="LENGTH", type=number, help="material left at every hinge (SVG)")
    parser.add_argument("--units", metavar="UNIT", help="length unit of the coordinates (SVG)")
    parser.add_argument("--overwrite", action="store_true", help="replace files that exist (never those of a run)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.exporting import check_free, check_names, export
    from kirisurf.runs import read_run

    check_names(arguments.to, arguments.state)
    check_free(arguments.to, arguments.folder, arguments.overwrite)
    run_read = read_run(arguments.folder)
    for path in arguments.to:
        export(run_read, path, arguments.state, arguments.hinge_width, arguments.units)
        output.product(path)
    return Outcome(0, {"files": list(arguments.to)})
