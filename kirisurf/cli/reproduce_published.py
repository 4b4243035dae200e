"""`kirisurf reproduce published`: every published configuration, its certificate, and the table of all."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.reference_audit import audited, checked_reference
from kirisurf.cli.reproduce_results import (
    brief,
    numbers_record,
    opened_folder,
    record_of,
    run_all,
    verdict,
    write_designs,
    write_records,
)
from kirisurf.errors import ParameterError
from kirisurf.published import ANGLES, FREE, Configuration, configurations
from kirisurf.reproducing import Numbers, Reproduced, Wanted
from kirisurf.spec import RECTANGLE

if TYPE_CHECKING:
    from viewers.figures import Panel

NAME = "published"
Audit = tuple[Numbers | None, str]

_LEAD = (
    "Every configuration that Choi, Dudte and Mahadevan published (Nature Materials 18, 999\u20131004, 2019), designed "
    "again: tessellation, target, unit cells and shape of the contracted sheet are theirs. Lengths are over the median "
    "tile edge of the deployed sheet, angles in radians.",
    "Rigid: the largest of slit edges that differ, tile angles that do not sum up to a full turn, corners off their "
    "tile's plane, and changes of a tile between the states. Closure: distance of points that have to meet in the "
    "contracted sheet. Outline: distance of the outer vertices to the outline of the target, and of the contracted "
    "sheet to the shape asked of it. Distance: of the deployed vertices to the target surface.",
)
_AUDITED = (
    "Published: the same certificate of the published files. Contracted points that coincide only roughly there are "
    "taken for one up to the distance at which as many are left as the pattern has; of results from several initial "
    "maps the one with the smallest rigid row is shown. Their distances are to the published target meshes, ours to "
    "finer meshes of the same formulas."
)
_EXACT = (
    "Exact: a certified sheet has every vertex on the smooth target, which goes on beyond the rim of the mesh that "
    "distances are measured to, to 1e-9."
)
_STARRED = (
    "* The contracted hexagons were asked to keep all angles at 2\u03c0/3; here their outline is free, and nothing is "
    "asked of their angles."
)


def reproduce_published(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run every configuration, or those that were chosen, and write the table.

    Raises
    ------
    ParameterError
        Where no configuration has the text asked for in its name.
    UnreadableError
        Where the reference cannot be read.
    OutputError
        Where the folder cannot be written.
    """
    chosen = [c for c in configurations(arguments.only) if arguments.match is None or arguments.match in c.name]
    if not chosen:
        names = ", ".join(c.name for c in configurations(arguments.only)[:3])
        raise ParameterError(f"--match: expected a part of a name such as {names}, ..., got {arguments.match!r}")
    reference = None if arguments.reference is None else checked_reference(arguments.reference)
    folder = opened_folder(arguments.output, arguments.overwrite)
    wanted = [Wanted.of(c) for c in chosen]
    if arguments.closeness is not None:
        wanted = [replace(each, spec=each.spec.changed(closeness=arguments.closeness)) for each in wanted]
    results = run_all(wanted, arguments.jobs, output)
    audits: list[Audit] | None = None
    if reference is not None:
        output.message("auditing the published files ...")
        audits = [audited(reference, c) for c in chosen]
    records = []
    for k, (configuration, result) in enumerate(zip(chosen, results, strict=True)):
        record = {"kind": configuration.kind, **_options(configuration), **record_of(result)}
        if audits is not None:
            record |= {"published_files": audits[k][1], **numbers_record(audits[k][0], "published_")}
        records.append(record)
    write_designs(folder, results)
    write_records(folder, NAME, records, {})
    page = folder / f"{NAME}.html"
    _write_page(page, chosen, results, audits, arguments.closeness == "exact")
    return verdict(results, page, output, "", {"table": str(page)})


def _options(configuration: Configuration) -> dict[str, Any]:
    values = {k: v for k, v in asdict(configuration).items() if k in ("tessellation", "target", "contracted")}
    return {
        **values,
        "cells": "{}x{}".format(*configuration.cells),
        "contracted_option": configuration.contracted_option,
    }


def _write_page(
    page: Path,
    chosen: Sequence[Configuration],
    results: Sequence[Reproduced],
    audits: Sequence[Audit] | None,
    exact: bool,
) -> None:
    from kirisurf.formats.atomic import write_text
    from viewers.figures import planar_figure
    from viewers.figures_table import ColumnGroup, TableRow, table_page

    groups = [
        ColumnGroup("Configuration", ("target", "cells", "contracted", "tiles")),
        ColumnGroup(
            "kirisurf: rows that have to vanish", ("rigid", "closure", "outline deployed", "outline contracted")
        ),
        ColumnGroup("Sheet", ("smallest edge", "distance rms", "distance max", "seconds")),
    ]
    if audits is not None:
        columns = ("rigid", "isometry", "closure", "smallest edge", "distance rms", "distance max")
        groups.append(ColumnGroup("Published files", columns))
    rows = []
    for k, (configuration, result) in enumerate(zip(chosen, results, strict=True)):
        cells = "{}\u00d7{}".format(*configuration.cells)
        values = [(configuration.target, cells, _shape(configuration), result.tiles), *_ours(result)]
        if audits is not None:
            values.append(_theirs(audits[k][0]))
        place = "Outlines" if configuration.kind == "2d" else "Surfaces"
        rows.append(TableRow(f"{place}, {configuration.tessellation}", tuple(values), brief(result.shortcomings)))
    lead: tuple[str, ...] = _LEAD if audits is None else (*_LEAD, _AUDITED)
    lead += (_EXACT,) if exact else ()
    lead += (_STARRED,) if any(c.contracted == ANGLES for c in chosen) else ()
    drawn = [panel_of(result, _title(c)) for c, result in zip(chosen, results, strict=True)]
    panels = [panel for panel in drawn if panel is not None]
    picture = planar_figure(panels, columns=3, dpi=72) if panels else None
    write_text(page, table_page("The published configurations", lead, groups, rows, picture))


def panel_of(result: Reproduced, title: str = "", note: str = "") -> Panel | None:
    """Return the panel of a figure for a design, seen from above; None where there is no design."""
    from viewers.figures import Panel

    shape = result.shape
    if shape is None:
        return None
    words = note or f"{result.tiles} tiles"
    flat = np.ascontiguousarray(shape.deployed[:, :2])
    return Panel(
        title or result.name.replace("_", " "), words, shape.tiles, shape.contracted, flat, shape.outline, shape.tones
    )


def _title(configuration: Configuration) -> str:
    cells = "{}\u00d7{}".format(*configuration.cells)
    return f"{configuration.tessellation}: {configuration.target} {cells}, {_shape(configuration)}"


def _shape(configuration: Configuration) -> str:
    asked = configuration.contracted
    if asked in (FREE, RECTANGLE):
        return asked
    return "angles 2\u03c0/3 *" if asked == ANGLES else f"rectangle {asked}"


def _ours(result: Reproduced) -> list[tuple[float | int | str | None, ...]]:
    n = result.numbers
    if n is None:
        return [(None,) * 4, (None, None, None, result.seconds)]
    return [
        (n.rigid, n.closure, n.boundary, n.contracted_boundary),
        (n.smallest_edge, n.distance_rms, n.distance_max, round(result.seconds, 1)),
    ]


def _theirs(numbers: Numbers | None) -> tuple[float | int | str | None, ...]:
    if numbers is None:
        return (None,) * 6
    n = numbers
    return (n.rigid, n.isometry, n.closure, n.smallest_edge, n.distance_rms, n.distance_max)
