"""`kirisurf export`: cutting files and interchange formats."""

from __future__ import annotations

import argparse
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command, number, value, whole
from kirisurf.errors import ParameterError
from kirisurf.sheet import Sheet
from kirisurf.units import UNITS

_TEXT = """\
The suffix chooses what is written:

  .svg   the cut pattern to scale, layers cut, hinge and outline
  .dxf   the same for CAD and laser cutters, layers CUT, OUTLINE and HINGE (off: marks, not cuts)
  .stl   the tiles of a state as triangles; with --thickness a solid to print: thick tiles, thin hinges
  .obj   the tiles of a state as polygons, full precision
  .vtp   the same with every named field, for ParaView and pyvista
  .vtm   tiles, holes, target and flat tiles in one, as named blocks (the blocks lie in a folder beside it)
  .pvd   the sheet opening, as a time series for ParaView (likewise): interpolated between the two states,
         for the eye; every frame says how far from rigid its tiles are
  .csv   the curvature of every hole
  .inp   the flat sheet as elastic shells, slits cut and ligaments left, that is pulled open at its rim: input of
         the finite element program CalculiX; needs --thickness. Forces are over Young's modulus

OBJ, VTP and STL hold the flat sheet unless --state deployed is given. Lengths are those of the finished
part, in the units of the target. --fit-sheet puts the pattern in the middle of the sheet, turned by 90
degrees where only that fits; where it does not fit, nothing is written and the largest scale is named."""

_EXAMPLES = """\
  kirisurf export runs/hood --to hood.svg hood.dxf --hinge-width 0.8 --kerf 0.15
  kirisurf export runs/hood --to hood.dxf --fit-sheet 600x400 --scale max
  kirisurf export runs/hood --to print.stl --thickness 3 --hinge-thickness 0.6
  kirisurf export runs/hood --to hood.stl hood.vtp --state deployed
  kirisurf export runs/hood --to hood.vtm opening.pvd --frames 61
  kirisurf export runs/hood --to hood.inp --thickness 0.5 --hinge-width 2"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "export", "write cutting files and interchange formats of a run", _TEXT, _EXAMPLES)
    parser.add_argument("folder", metavar="RUN", help="run folder")
    parser.add_argument(
        "--to", metavar="FILE", nargs="+", required=True, help="files to write; the suffix is the format"
    )
    parser.add_argument("--state", metavar="NAME", help="contracted (default) or deployed, for OBJ, VTP and STL")
    parser.add_argument("--overwrite", action="store_true", help="replace files that exist (never those of a run)")

    parser.add_argument(
        "--frames", metavar="N", type=whole, help="frames of a time series (PVD), from closed to open; default: 31"
    )

    cutting = parser.add_argument_group("cutting files and solids")
    cutting.add_argument(
        "--hinge-width",
        metavar="LENGTH",
        type=number,
        help="material left at every hinge; default: that of the run, scaled with the pattern",
    )
    cutting.add_argument(
        "--kerf",
        metavar="LENGTH",
        type=number,
        help="width of the cut (SVG, DXF), less than the hinge width; default: that of the run",
    )
    cutting.add_argument(
        "--units", metavar="UNIT", help=f"length unit of the coordinates: {' | '.join(UNITS)}; default: that of the run"
    )
    cutting.add_argument(
        "--scale",
        metavar="X|max",
        type=_scale,
        default=1.0,
        help="factor on the pattern, or max: the largest that fits --fit-sheet; default: 1",
    )
    cutting.add_argument(
        "--fit-sheet", metavar="WxH", type=value(Sheet.parse), help="sheet that the pattern has to fit"
    )
    solid = parser.add_argument_group("solids (STL) and shells (INP)")
    solid.add_argument(
        "--thickness", metavar="LENGTH", type=number, help="height of the tiles: makes the STL a solid; of the shells"
    )
    solid.add_argument(
        "--hinge-thickness", metavar="LENGTH", type=number, help="height of the hinges; default: a third of --thickness"
    )
    solid.add_argument(
        "--gap", metavar="LENGTH", type=number, help="width of the slits; default: half of the hinge width"
    )
    parser.set_defaults(run=run)


@value
def _scale(text: str) -> float | str:
    try:
        return text if text == "max" else float(text)
    except ValueError:
        raise ParameterError(f"value: expected a number or max, got {text!r}") from None


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.exporting import FRAMES, check_free, check_names, export_with_remarks
    from kirisurf.fabrication import Fabrication
    from kirisurf.runs import read_run

    making = Fabrication(
        hinge_width=arguments.hinge_width,
        kerf=arguments.kerf,
        units=arguments.units,
        scale=arguments.scale,
        sheet=arguments.fit_sheet,
        thickness=arguments.thickness,
        hinge_thickness=arguments.hinge_thickness,
        gap=arguments.gap,
    )
    frames = FRAMES if arguments.frames is None else arguments.frames
    check_names(arguments.to, arguments.state, making, frames)
    check_free(arguments.to, arguments.folder, arguments.overwrite)
    run_read = read_run(arguments.folder)
    units = making.units or run_read.spec.units or "mm (assumed)"
    warnings: list[str] = []
    sizes: dict[str, Any] = {}
    for path in arguments.to:
        written = export_with_remarks(run_read, path, arguments.state, making, frames)
        output.product(path)
        if written.placement is not None:
            placed = written.placement
            width, height = placed.size
            turned = ", turned by 90 degrees" if placed.turned else ""
            output.message(f"{path}: {width:.6g} x {height:.6g} {units}, scale {placed.scale:.6g}{turned}")
            sizes[str(path)] = {"size": [width, height], "scale": placed.scale, "turned": placed.turned}
        warnings += [said for said in written.warnings if said not in warnings]
    for said in warnings:
        output.warning(said)
    result = {"files": list(arguments.to), "placements": sizes, "warnings": warnings}
    return Outcome(1 if warnings else 0, result)
