"""`kirisurf deploy`: how the sheet of a run gets from flat to deployed, what it costs, and where it rests."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command, number, whole
from kirisurf.cli.path_progress import PathProgress

_FOLLOWED = ("COMPLETE", "JUMPED")
_TEXT = """\
A design guarantees its two ends. This follows the sheet between them: springs along the sides and diagonals of
every tile, torsional springs in the slits (the model of Choi, Dudte and Mahadevan, 2019), every state in
equilibrium. LAMBDA is the stiffness of the slits over that of the tiles: 0 for hinges without any resistance.

It says for every lambda whether the sheet deploys freely, snaps over a barrier and stays, springs back, or needs
strain; which tiles collide on the way; and from which lambda on it no longer rests open by itself. The folder
RUN/deployment (or DIR) receives, replacing an earlier deployment:

  deployment.csv   a row for every state: fraction, opening, energies, strains, collisions, residual
  deployment.json  verdicts, minima, barriers, mechanisms, options, and the hash of every file
  deployment.png   energy against opening for every lambda, with the sheet on its way
  deployment.pvd   the states of the first lambda as a time series for ParaView, with strain and openings
  deployment.gif   the same as a film

--drive chooses what moves the sheet: free, a load that opens the slits and holds no vertex; rim, its outer
vertices; corners, four of them. Vertices that are moved can hide a barrier.

exit codes: 0 done; 1 done, but at the smallest lambda the sheet springs back or needs strain, tiles collide, or some
state is not in equilibrium: the warnings say which; 2 wrong option; 3 run unreadable; 4 run without certificate;
7 cannot write; 130 interrupted, nothing written"""

_EXAMPLES = """\
  kirisurf deploy runs/hood
  kirisurf deploy runs/disc --lambda 0 1e-4 2e-4 4e-4
  kirisurf deploy runs/disc --hinge-width 2                     lambda from what is left standing at a slit
  kirisurf deploy runs/disc --drive rim --trajectory straight   the paper's own drive
  kirisurf deploy runs/hood --thickness 0.5 -o hood-way --no-animation"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "deploy", "follow a sheet from flat to deployed", _TEXT, _EXAMPLES)
    parser.add_argument("folder", metavar="RUN", help="run folder")
    parser.add_argument("-o", "--output", metavar="DIR", help="folder for the files (default: RUN/deployment)")
    parser.add_argument(
        "--lambda",
        dest="torsion",
        metavar="LAMBDA",
        nargs="+",
        type=number,
        help="stiffness of the slits over that of the tiles, one number or several (default: 0 0.0001 0.001)",
    )
    parser.add_argument(
        "--hinge-width",
        metavar="LENGTH",
        type=number,
        help="width of the ligaments at the ends of slits, in the units of the run: lambda of a sheet that is cut from "
        "one material, beside those of --lambda (here by default 0)",
    )
    parser.add_argument("--steps", metavar="N", type=whole, help="states after the flat one (default: 50)")
    parser.add_argument("--drive", metavar="WHAT", help="free (default) | rim | corners")
    parser.add_argument(
        "--trajectory",
        metavar="HOW",
        help="how vertices are moved: turning evenly with their tiles (default in the plane) | rigid, as rigid tiles "
        "have them (default in space) | straight, as in the paper",
    )
    parser.add_argument(
        "--thickness", metavar="LENGTH", type=number, help="of the sheet, for collisions in space (default: 0)"
    )
    parser.add_argument(
        "--no-contact",
        dest="contact",
        action="store_false",
        default=None,
        help="let tiles overlap at slits in the plane, as in the paper",
    )
    parser.add_argument("--no-animation", action="store_true", help="write no film")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.deploying import checked_options, deploy_with_collisions, save_deployment, torsion_of_run
    from kirisurf.deployment_folder import FIGURE, RECORD, deployment_folder
    from kirisurf.runs import read_run

    names = ("torsion", "steps", "drive", "trajectory", "thickness", "contact")
    given = {name: getattr(arguments, name) for name in names if getattr(arguments, name) is not None}
    checked_options(**given)
    read = read_run(arguments.folder)
    if arguments.hinge_width is not None:
        torsion = torsion_of_run(read, arguments.hinge_width)
        units = read.result["units"]
        output.message(f"ligaments {arguments.hinge_width:g} {units} wide: lambda about {torsion:.3g}")
        given["torsion"] = [*given.get("torsion", [0.0]), torsion]
    with deployment_folder(read, arguments.output) as folder, PathProgress(output) as progress:
        found = deploy_with_collisions(read, progress=progress.state, stage=progress.stage, **given)
        path = save_deployment(found, folder, animation=not arguments.no_animation, stage=progress.stage)
    record = found.record
    warnings = _tell(record, output)
    if arguments.output is None:
        output.message(f"kirisurf report {arguments.folder} shows it in the report of the run")
    output.product(str(path / FIGURE))
    code = 1 if warnings else 0
    return Outcome(code, {**record, "folder": str(path), "record": str(path / RECORD), "warnings": warnings})


def _tell(record: Mapping[str, Any], output: Output) -> list[str]:
    """Print what was found, and return what needs reading."""
    from kirisurf.deployment import Kind

    resting = (Kind.BISTABLE.value, Kind.MULTISTABLE.value)
    ends = record["mechanisms"]
    output.message(f"{record['tiles']} tiles, {record['slit_ends']} slit ends, {record['springs']} springs")
    output.message(f"motions that strain no tile, to first order: {ends['flat']} flat, {ends['deployed']} deployed")
    warnings: list[str] = []
    smallest = min(path["lambda"] for path in record["paths"])
    for path in record["paths"]:
        name = f"lambda {path['lambda']:g}"
        output.message(f"{name}: {path['sentence']}")
        if path["lambda"] == smallest and path["kind"] not in (Kind.FREE.value, *resting):
            warnings.append(f"{name}: the sheet {path['kind']}")
        if path["status"] not in _FOLLOWED:
            warnings.append(f"{name}: {path['status_sentence']}")
        words = _collision_words(path)
        output.message(f"  {words}")
        if not path["collisions"]["is_free"]:
            warnings.append(f"{name}: {words}")
    if record["transition_lambda"] is not None:
        wide = f"ligaments about {record['transition_hinge_width']:.2g} {record['units']} wide"
        output.message(f"it rests open by itself up to lambda {record['transition_lambda']:.3g}: {wide}")
    elif record["rests_open"] is not None:
        which = "any" if record["rests_open"] == "always" else "no"
        output.message(f"it rests open by itself at {which} lambda above 0")
    for words in warnings:
        output.warning(words)
    return warnings


def _collision_words(path: Mapping[str, Any]) -> str:
    """One line on the collisions of a path."""
    met = path["collisions"]
    widest = met["widest_free_opening"]
    if met["is_free"]:
        return f"no tiles collide (they may touch), up to a mean opening of {_degrees(widest)}"
    first, last = (f"{100 * each:.0f} %" for each in met["between"])
    pairs = "1 pair of tiles collides" if met["most"] == 1 else f"{met['most']} pairs of tiles collide"
    free = "in every state" if widest is None else f"widest state without: mean opening {_degrees(widest)}"
    deep = f"at most {100 * met['deepest']:.2g} % of a tile edge deep"
    return f"{pairs} between {first} and {last} of the way, {deep}; {free}"


def _degrees(angle: float) -> str:
    from math import degrees

    return f"{abs(round(degrees(angle)))} degrees"
