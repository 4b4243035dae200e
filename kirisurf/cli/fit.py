"""`kirisurf fit`: from a target surface to a run folder."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import Parser, add_command, degrees_or_auto, number, value, whole
from kirisurf.errors import ParameterError
from kirisurf.spec import (
    CLOSENESS,
    DEFAULT_TILES,
    INITIALS,
    PREFERENCES,
    SOLVERS,
    FitSpec,
    parse_cells,
    parse_toml,
)
from kirisurf.tessellation_names import tessellation_names
from kirisurf.units import UNITS

SPEC_MB = 1
"""Largest spec that is read, in megabytes."""

_TEXT = f"""\
TARGET is a mesh file (STL, OBJ, PLY, OFF, VTP, VTK, glTF), a planar outline (SVG, DXF, CSV), or the name of a
sample surface or outline (`kirisurf samples` lists them; a file of the same name is written ./NAME). A mesh
must be one piece with one outline, like a bent sheet. DIR receives the run: the cut pattern (pattern.svg),
both states (deployed.obj, contracted.obj, and .vtp with every field), the holes' curvature (curvature.csv),
the certificate (result.json), pictures, and report.html, which explains them.

Without --cells or --tiles a sample takes its own number of tiles, a file about {DEFAULT_TILES}. On an outline, --cells
bends a rectangular pattern into it, side by side; --tiles trims a pattern to it. Either way the outer tips end
exactly on the outline.
Ctrl-C stops the solver and saves the best point so far; a second Ctrl-C saves nothing.

exit codes: 0 done, 1 done with warnings, 2 wrong parameter, 3 target unreadable, 4 target unusable,
5 not within tolerance (best result saved), 6 limit reached (best so far saved), 7 cannot write,
130 interrupted (best so far saved)."""

_EXAMPLES = """\
  kirisurf fit hypar -o runs/hypar                     a sample surface
  kirisurf fit hood.stl -o runs/hood --tiles 400       a file, about 400 tiles, trimmed to its outline
  kirisurf fit hypar -o runs/x --cells 4x4 --closeness exact
  kirisurf fit face.obj -o runs/face --tessellation kagome
  kirisurf fit circle -o runs/circle --cells 6x6 --contracted rectangle:1
                                                       a square sheet that opens into a disc
  kirisurf fit logo.svg -o runs/logo --tiles 400       any outline
  kirisurf fit --spec runs/hood/run.toml -o runs/again repeat a run
  kirisurf fit -o runs/odd -- -odd-name.obj            after -- nothing is an option"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "fit", "design a kirigami sheet for a surface or an outline", _TEXT, _EXAMPLES)
    parser.add_argument("target", metavar="TARGET", nargs="?", help="mesh or outline file, or a sample's name")
    parser.add_argument("-o", "--output", metavar="DIR", required=True, help="run folder: new or empty")
    parser.add_argument(
        "--overwrite", action="store_true", help="replace an old run in DIR once the new one is complete"
    )
    parser.add_argument("--spec", metavar="RUN.TOML", help="take every option from a file; options given here win")
    parser.add_argument("--no-pictures", action="store_true", help="write no pictures (saves some seconds)")
    add_spec_options(parser)
    parser.set_defaults(run=run)


def add_spec_options(parser: Parser) -> None:
    """Add every option of a fit; those that are not given are absent from the parsed arguments."""
    off = argparse.SUPPRESS

    def add(group: Any, name: str, help_text: str, **options: Any) -> None:
        group.add_argument(name, default=off, help=help_text, **options)

    pattern = parser.add_argument_group("pattern")
    add(
        pattern,
        "--tessellation",
        f"{' | '.join(tessellation_names())}, or the FILE of a unit cell; default: quad",
        metavar="NAME",
    )
    add(
        pattern,
        "--cells",
        "unit cells: 4x4 quad cells are 8x8 tiles, stretched to the target's four corners",
        metavar="WxH",
        type=value(parse_cells),
    )
    add(pattern, "--tiles", "about N tiles, trimmed to the target's outline", metavar="N", type=whole)
    add(
        pattern,
        "--opening",
        "opening of the slits at the start in degrees: 0 closed, 90 fully open; default: auto, "
        "from how much the target stretches",
        metavar="DEGREES",
        type=degrees_or_auto,
    )
    add(
        pattern,
        "--orientation",
        "rotation of the pattern in degrees; default: auto",
        metavar="DEGREES",
        type=degrees_or_auto,
    )

    solve = parser.add_argument_group("solve")
    add(
        solve,
        "--closeness",
        f"{' | '.join(CLOSENESS)}: rigid tiles near the target (default; --prefer nearest: nearer still), or "
        "every vertex on it",
        metavar="MODE",
    )
    add(
        solve,
        "--initial",
        f"start: {' | '.join(INITIALS)}; default: auto",
        metavar="NAME",
    )
    add(
        solve,
        "--contracted",
        "shape of the flat sheet: free (default), rectangle, rectangle:RATIO (width over height), or an outline, whose "
        "size is free: a name or FILE (svg, dxf, csv); needs --cells",
        metavar="SHAPE",
    )
    add(
        solve,
        "--solver",
        f"{' | '.join(SOLVERS)}; default: auto. The last four are slow cross-checks; "
        "ipopt and uno need the extra kirisurf[peers]",
        metavar="NAME",
    )
    add(
        solve,
        "--tolerance",
        "largest rigid row of the certificate, lengths over the tile edge, angles in radians; default: 1e-9",
        metavar="X",
        type=number,
    )
    add(solve, "--max-seconds", "limit of the solve", metavar="S", type=number)
    add(solve, "--max-steps", "limit of the solver's steps", metavar="N", type=whole)
    add(solve, "--min-edge", "smallest tile edge over the median one; default: 0.1", metavar="X", type=number)
    add(
        solve,
        "--min-angle",
        "smallest opening between neighboring tiles in degrees; default: 3",
        metavar="DEGREES",
        type=number,
    )

    add(
        solve,
        "--max-opening",
        "largest opening between neighboring tiles in degrees; default: none",
        metavar="DEGREES",
        type=number,
    )
    add(solve, "--min-corner", "smallest angle of a tile in degrees; default: none", metavar="DEGREES", type=number)
    add(
        solve,
        "--prefer",
        f"which of the sheets that meet every row: {' | '.join(PREFERENCES)}; default: balanced",
        metavar="NAME",
    )

    target = parser.add_argument_group("target")
    add(target, "--repair", "repair the target first: holes, copies, stray pieces", action="store_true")
    add(target, "--remesh", "remesh the target first", action="store_true")
    add(
        target,
        "--remesh-edge",
        "edge length of the remeshed target; default: a third of a tile edge",
        metavar="LENGTH",
        type=number,
    )
    add(
        target,
        "--units",
        f"length unit of the target's coordinates: {' | '.join(UNITS)}; default: mm is assumed for the cut pattern",
        metavar="UNIT",
    )

    cutting = parser.add_argument_group("cutting")
    add(
        cutting,
        "--hinge-width",
        "material left at every hinge, in the target's units; default: 4 %% of a tile edge",
        metavar="LENGTH",
        type=number,
    )
    add(
        cutting,
        "--kerf",
        "width of the cut, less than the hinge width: slits end earlier and the outline runs outside, so that hinges "
        "and part keep their size; default: 0",
        metavar="LENGTH",
        type=number,
    )


def given_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the options of a fit that the user gave."""
    names = set(FitSpec.__dataclass_fields__) - {"target"}
    return {name: found for name, found in vars(arguments).items() if name in names}


def spec_of(arguments: argparse.Namespace) -> FitSpec:
    """Return the resolved spec: the file's options, if any, with the given ones on top.

    Raises
    ------
    ParameterError
        Where no target is given, an option is wrong, or the file is no spec.
    UnreadableError
        Where the spec file cannot be read.
    """
    from kirisurf.errors import UnreadableError
    from kirisurf.formats.source import read_bytes
    from kirisurf.targets import resolved

    given = given_options(arguments)
    if arguments.spec is None:
        if arguments.target is None:
            raise ParameterError(
                "TARGET: expected a mesh file or the name of a sample surface, got none (see: kirisurf fit --help)"
            )
        spec = FitSpec(target=arguments.target, **given)
        return resolved(spec, sized=bool({"cells", "tiles"} & set(given)))
    path = Path(arguments.spec)
    try:
        text = read_bytes(path, SPEC_MB).decode("utf-8")
    except UnicodeDecodeError as problem:
        raise UnreadableError(f"{path}: expected a spec (TOML), got: {problem}") from None
    values = parse_toml(text, str(path))
    for one, other in (("cells", "tiles"), ("tiles", "cells")):
        if one in given and other not in given:
            values.pop(other, None)
    sized = bool({"cells", "tiles"} & (set(values) | set(given)))
    if arguments.target is not None:
        return resolved(FitSpec.from_dict({**values, **given, "target": arguments.target}, str(path)), sized=sized)
    return resolved(FitSpec.from_dict({**values, **given}, str(path)), path.absolute().parent, sized)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.cli.job import run_job

    return run_job(spec_of(arguments), arguments.output, arguments.overwrite, not arguments.no_pictures, output)
