"""`kirisurf reproduce fig1` and the like: the designs of a figure, their numbers, and the picture."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.reproduce_published import panel_of
from kirisurf.cli.reproduce_results import (
    opened_folder,
    record_of,
    run_all,
    sentence,
    verdict,
    write_designs,
    write_records,
)
from kirisurf.design import Design
from kirisurf.published import LARGEST
from kirisurf.reproducing import Reproduced, reproduced
from kirisurf.reproducing_figures import FIGURES, Law, circling

_TITLES = {
    "fig2a": "Squares that open into a disc and into an egg",
    "fig2b": "Rectangles that open into outlines of mixed and of zero curvature",
}
PARTS: Mapping[str, tuple[str, ...]] = {"fig2": ("fig2a", "fig2b", "fig2c")}
"""Figures that are made of others, one below the other."""

_LEAST = 2
_CELLS = 3
_SHOWN = (0.3, 0.7)  # place in the closed sheet of the point that Fig. 1 shows: away from axes of symmetry


@dataclass(frozen=True)
class _Made:
    """What a figure is made of: its designs, its pictures in order, and numbers to print with --json.

    `undrawn` says why a picture is missing; empty where none is.
    """

    results: Sequence[Reproduced]
    pictures: Sequence[Path]
    beside: Mapping[str, Any] = field(default_factory=dict)
    undrawn: str = ""


def reproduce_figure(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Make the designs of a figure and draw it.

    Raises
    ------
    OutputError
        Where the folder cannot be written.
    """
    what: str = arguments.what
    folder = opened_folder(arguments.output, arguments.overwrite)
    parts = PARTS.get(what, (what,))
    made = [_made(part, folder, arguments, output) for part in parts]
    results = [result for part in made for result in part.results]
    pictures = [picture for part in made for picture in part.pictures]
    product = pictures[0] if pictures else folder / f"{parts[0]}.csv"
    if len(pictures) > 1:
        from kirisurf.formats.atomic import write_bytes
        from viewers.figures_stacked import stacked

        product = folder / f"{what}.png"
        write_bytes(product, stacked([picture.read_bytes() for picture in pictures]))
    undrawn = next((part.undrawn for part in made if part.undrawn), "")
    beside = {name: value for part in made for name, value in part.beside.items()}
    return verdict(results, product, output, undrawn, beside)


def _made(what: str, folder: Path, arguments: argparse.Namespace, output: Output) -> _Made:
    if what == "fig1":
        return _first(folder, output)
    if what == "fig2c":
        return _accuracy(folder, arguments.largest or LARGEST, arguments.jobs, output)
    if what == "fig3":
        return _snapping(folder, output)
    if what == "fig4":
        return _curved(folder, output)
    from kirisurf.formats.atomic import write_bytes
    from viewers.figures import planar_figure

    results = run_all(FIGURES[what], arguments.jobs, output)
    _write(folder, what, results, {})
    picture = folder / f"{what}.png"
    panels = [p for result in results if (p := panel_of(result, _title(result), _note(result))) is not None]
    if panels:
        write_bytes(picture, planar_figure(panels, 2, _TITLES[what]))
    return _Made(results, [picture] if panels else [])


def _first(folder: Path, output: Output) -> _Made:
    """Fig. 1: the regular pattern, what a general sheet has to meet, and the way to one."""
    from kirisurf.formats.atomic import write_bytes
    from kirisurf.reproducing_first import meeting_corner, opening_squares
    from viewers.figures_first import first_figure

    (wanted,) = FIGURES["fig1"]
    result, design = reproduced(wanted)
    output.message(sentence(result))
    _write(folder, "fig1", [result], {})
    shape = result.shape
    if design is None or shape is None or shape.outline is None:
        return _Made([result], [])
    rows, picture = design.certificate.rows, folder / "fig1.png"
    stages = (
        ("the regular pattern, where the solve begins", design.result.initial[:, :2]),
        ("the sheet, its outer tips on the outline", design.deployed_points[:, :2]),
        ("the same sheet, closed", design.contracted_points),
    )
    corner, worst = meeting_corner(design, _SHOWN), (float(rows["length"] or 0.0), float(rows["angle"] or 0.0))
    figure = first_figure(opening_squares(_CELLS), corner, shape.tiles, shape.tones, stages, shape.outline, worst)
    write_bytes(picture, figure)
    return _Made([result], [picture])


def _accuracy(folder: Path, largest: int, jobs: int, output: Output) -> _Made:
    """Fig. 2c: circling the square."""
    from kirisurf.formats.atomic import write_bytes
    from viewers.figures import planar_figure
    from viewers.figures_accuracy import accuracy_figure

    results = run_all(circling(largest), jobs, output)
    law, beside, pictures = Law.of(results), {}, []
    if len(law.tiles) >= _LEAST:
        slopes = law.area_exponent, law.base_exponent, law.height_exponent
        beside = dict(zip(("area_exponent", "base_exponent", "height_exponent"), slopes, strict=True))
        for kind in ("png", "svg"):
            write_bytes(
                folder / f"fig2c.{kind}", accuracy_figure(law.tiles, law.area, law.base, law.height, slopes, kind)
            )
        pictures.append(folder / "fig2c.png")
        output.message(
            f"boundary layer ~ tiles^{slopes[0]:.3f} (paper: -1/2); "
            f"base of a gap ~ side^{slopes[1]:.3f}, height ~ side^{slopes[2]:.3f} (paper: -1)"
        )
    _write(folder, "fig2c", results, beside)
    panels = [p for result in results if (p := panel_of(result, _title(result), _note(result))) is not None]
    if panels:
        write_bytes(folder / "fig2c_sheets.png", planar_figure(panels, 3, "Squares that open into the circle"))
    return _Made(results, pictures, beside)


def _snapping(folder: Path, output: Output) -> _Made:
    """Fig. 3a: energy between flat and deployed, at lambdas round the one at which the open state is lost."""
    from kirisurf.deployment_pictures import picture
    from kirisurf.deployment_tables import deployment_csv, deployment_record
    from kirisurf.formats.atomic import write_bytes, write_text
    from kirisurf.reproducing_deployment import snapping

    (wanted,) = FIGURES["fig3"]
    result, design = reproduced(wanted)
    output.message(sentence(result))
    if design is None:
        _write(folder, "fig3", [result], {})
        return _Made([result], [])
    found = snapping(design)
    beside = {"transition_lambda": found.transition}
    _write(folder, "fig3", [result], {**beside, "deployment": deployment_record(found.deployment, found.collisions)})
    write_text(folder / "fig3_paths.csv", deployment_csv(found.deployment, found.collisions))
    for verdict_of_path in found.deployment.verdicts:
        output.message(f"lambda {verdict_of_path.torsion:.3g}: {verdict_of_path.sentence}")
    output.message(f"it rests open by itself up to lambda {found.transition:.3g}")
    title, drawn = "A square that opens into a disc: energy between flat and deployed", folder / "fig3.png"
    ends = design.tessellation, design.deployed_points
    write_bytes(drawn, picture(*ends, found.deployment, found.collisions, title))
    return _Made([result], [drawn], beside)


def _curved(folder: Path, output: Output) -> _Made:
    """Fig. 4: for every target a row: target, contracted and deployed sheet, and the curvature of the holes."""
    results, pictures, undrawn = [], [], ""
    for wanted in FIGURES["fig4"]:
        result, design = reproduced(wanted)
        output.message(sentence(result))
        results.append(result)
        if design is not None:
            picture = folder / f"fig4_{wanted.spec.target}.png"
            reason = _draw(design, picture)
            undrawn = reason or undrawn
            pictures += [] if reason else [picture]
    _write(folder, "fig4", results, {})
    return _Made(results, pictures, {}, undrawn)


def _draw(design: Design, picture: Path) -> str:
    """Draw the standard scenes of a design side by side; return why not, where nothing can be drawn here."""
    from kirisurf.publishing import sheet
    from viewers.opengl import probe
    from viewers.scenes import standard_scenes
    from viewers.snapshot import render_overview

    answer = probe()
    if not answer.available:
        return f"no picture: {answer.reason}"
    fields = {(where, key): v for where in ("vertex", "tile", "hole") for key, v in design.fields(where).items()}
    drawn = sheet(
        design.tessellation,
        design.deployed_points,
        design.contracted_points,
        design.surface,
        fields,
        design.spec.units,
    )
    scenes = standard_scenes(drawn)
    scenes["target"] = replace(scenes["target"], title=f"Target: {design.surface.name}")
    render_overview(scenes, picture, len(scenes), (520, 460))
    return ""


def _write(folder: Path, name: str, results: Sequence[Reproduced], beside: Mapping[str, Any]) -> None:
    measured = (
        "boundary_layer_area",
        "outline_area_difference",
        "gap_base_mean",
        "gap_height_mean",
        "area_magnification",
        "opening_angle_mean",
    )
    records = [
        {**record_of(result), **{measure: result.measures.get(measure) for measure in measured}} for result in results
    ]
    write_records(folder, name, records, beside)
    write_designs(folder, results)


def _title(result: Reproduced) -> str:
    target, _, cells = result.name.rpartition("_")
    return f"{target}, {' × '.join(cells.split('x'))} cells"


def _note(result: Reproduced) -> str:
    n = result.numbers
    if n is None:
        return ""
    words = [f"{result.tiles} tiles", f"rigid rows {n.rigid:.0e}"]
    words += [] if n.boundary is None else [f"outline {n.boundary:.0e}"]
    words += [] if n.contracted_boundary is None else [f"contracted outline {n.contracted_boundary:.0e}"]
    return ", ".join(words).replace("e-0", "e-")
