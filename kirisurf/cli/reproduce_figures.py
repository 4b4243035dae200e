"""`kirisurf reproduce fig2a` and the like: the designs of a figure, their numbers, and the picture."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
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
_LEAST = 2


def reproduce_figure(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Make the designs of a figure and draw it.

    Raises
    ------
    OutputError
        Where the folder cannot be written.
    """
    what: str = arguments.what
    folder = opened_folder(arguments.output, arguments.overwrite)
    if what == "fig4":
        return _curved(folder, output)
    if what == "fig2c":
        return _accuracy(folder, arguments.largest or LARGEST, arguments.jobs, output)
    from kirisurf.formats.atomic import write_bytes
    from viewers.figures import planar_figure

    results = run_all(FIGURES[what], arguments.jobs, output)
    _write(folder, what, results, {})
    picture = folder / f"{what}.png"
    panels = [p for result in results if (p := panel_of(result, _title(result), _note(result))) is not None]
    if panels:
        write_bytes(picture, planar_figure(panels, 2, _TITLES[what]))
    return verdict(results, picture, output, "", {})


def _accuracy(folder: Path, largest: int, jobs: int, output: Output) -> Outcome:
    """Fig. 2c: circling the square."""
    from kirisurf.formats.atomic import write_bytes
    from viewers.figures import planar_figure
    from viewers.figures_accuracy import accuracy_figure

    results = run_all(circling(largest), jobs, output)
    law, beside, picture = Law.of(results), {}, folder / "fig2c.png"
    if len(law.tiles) >= _LEAST:
        slopes = law.area_exponent, law.base_exponent, law.height_exponent
        beside = dict(zip(("area_exponent", "base_exponent", "height_exponent"), slopes, strict=True))
        for kind in ("png", "svg"):
            write_bytes(
                folder / f"fig2c.{kind}", accuracy_figure(law.tiles, law.area, law.base, law.height, slopes, kind)
            )
        output.message(
            f"boundary layer ~ tiles^{slopes[0]:.3f} (paper: -1/2); "
            f"base of a gap ~ side^{slopes[1]:.3f}, height ~ side^{slopes[2]:.3f} (paper: -1)"
        )
    _write(folder, "fig2c", results, beside)
    panels = [p for result in results if (p := panel_of(result, _title(result), _note(result))) is not None]
    if panels:
        write_bytes(folder / "fig2c_sheets.png", planar_figure(panels, 3, "Squares that open into the circle"))
    return verdict(results, picture, output, "", beside)


def _curved(folder: Path, output: Output) -> Outcome:
    """Fig. 4: target, contracted and deployed sheet, and the curvature of the holes."""
    results, pictures, undrawn = [], [], ""
    for wanted in FIGURES["fig4"]:
        result, design = reproduced(wanted)
        output.message(sentence(result))
        results.append(result)
        if design is not None:
            picture = folder / f"fig4_{wanted.spec.target}.png"
            undrawn = _draw(design, picture) or undrawn
            pictures.append(picture)
    _write(folder, "fig4", results, {})
    return verdict(results, pictures[0] if pictures else folder / "fig4.csv", output, undrawn, {})


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
    render_overview(standard_scenes(drawn), picture, columns=3)
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
