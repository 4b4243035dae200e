"""From a design to a run folder: files, certificate recomputed from them, pictures, and the record last.

The pictures are asked for inside a function: whoever wants none needs neither VTK's renderer nor matplotlib.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from kirisurf.cuts import Cuts, cuts
from kirisurf.errors import ParameterError
from kirisurf.field_units import described_file
from kirisurf.formats import read_polygons, write_obj, write_vtp
from kirisurf.formats.atomic import write_text
from kirisurf.formats.blocks import vtm_text
from kirisurf.judging import certified, named_fields
from kirisurf.loops import Loops
from kirisurf.pipeline import FitResult
from kirisurf.runs import Run, RunFolder, read_run
from kirisurf.runs.record import SECONDS, plain, versions, write_record
from kirisurf.runs.run import (
    ASKED_STRETCH,
    BLOCKS,
    CELL,
    RUN_BLOCKS,
    SPEC,
    STANDARD_CONTRACTED,
    STANDARD_DEPLOYED,
    WELD,
)
from kirisurf.runs.table import curvature_csv
from kirisurf.spec import FitSpec
from kirisurf.status import Status
from kirisurf.surface import Surface
from kirisurf.svg import svg_text

if TYPE_CHECKING:
    from analysis.certificate import Certificate

_WARNED = 1


@dataclass(frozen=True, eq=False)
class Finished:
    """What a run folder is written from.

    Attributes
    ----------
    spec : FitSpec
    result : FitResult
    origin : (3,)
        Origin of all points in the frame of the target.
    measures : Measures
    """

    spec: FitSpec
    result: FitResult
    origin: Float[np.ndarray, " 3"]
    measures: Any  # analysis.measures.Measures: not imported here

    @property
    def points(self) -> np.ndarray:
        """Deployed points (n, 3)."""
        return self.result.fit.points

    @property
    def flat(self) -> np.ndarray:
        """Contracted points (n, 2)."""
        return self.result.contracted.points

    def fields(self, where: str) -> dict[str, np.ndarray]:
        """Return the named fields of vertex, tile or hole."""
        return named_fields(self.measures, where)


def save(
    design: Finished,
    folder: RunFolder,
    *,
    pictures: bool = True,
    measure_seconds: float = 0.0,
    stage: Callable[[str], None] = lambda name: None,
    provenance: Mapping[str, Any] = MappingProxyType({}),
) -> Run:
    """Write a design into an open run folder and commit it.

    Parameters
    ----------
    design : Finished
    folder : RunFolder
        Entered; it is committed here.
    pictures : bool
        Draw pictures, where OpenGL works.
    measure_seconds : float
        Time that measuring took, for the record.
    stage : callable
        Receives the name of what is done next.
    provenance : mapping
        What the run was made from (:mod:`kirisurf.provenance`), for the record.

    Raises
    ------
    OutputError
        Where a file cannot be written; the folder is then as it was.
    """
    began = time.perf_counter()
    to = folder.staging
    stage("certifying")
    lines, warnings = _cut_lines(design)
    warnings = [*design.result.warnings, *warnings]
    _write_data(design, lines, to)
    certificate = _certificate_of_files(design, to)
    status = design.result.fit.status
    if status is Status.CONVERGED and not certificate.passed:
        status = Status.NOT_CERTIFIED
    analysed = time.perf_counter()

    stage("drawing" if pictures else "writing the report")
    result = _result(design, certificate, status, lines)
    warnings += _publish(design, {**result, "warnings": warnings}, to, pictures)
    seconds = {**dict.fromkeys(SECONDS, 0.0), **design.result.seconds}
    seconds |= {"analyse": measure_seconds + analysed - began, "draw": time.perf_counter() - analysed}
    seconds["total"] = sum(seconds[name] for name in SECONDS if name != "total")
    code = status.exit_code or (_WARNED if warnings else 0)
    made = {"provenance": dict(provenance), "exit_code": code, "warnings": warnings, "seconds": seconds}
    write_record(to, {**result, **made})
    folder.commit()
    return read_run(folder.path)


def _cut_lines(design: Finished) -> tuple[Cuts, list[str]]:
    """The cut lines; a hinge width or kerf that does not fit is replaced and said: the solve must not be lost to it."""
    try:
        lines = cuts(design.result.tessellation, design.flat, design.spec.hinge_width, design.spec.kerf)
        return lines, list(lines.warnings)
    except ParameterError as problem:
        lines = cuts(design.result.tessellation, design.flat)
        drawn = f"pattern.svg was drawn with hinges of {lines.hinge_width:.6g} and for a kerf of 0 instead."
        return lines, [f"{problem}. {drawn}"]


def _write_data(design: Finished, lines: Cuts, to: Path) -> None:
    """Write every file that holds numbers."""
    tessellation, surface = design.result.tessellation, design.result.surface
    points, flat, tiles = design.points, design.flat, tessellation.tiles
    write_text(to / SPEC, design.spec.to_toml())
    comments = _comments(design)
    write_obj(to / "deployed.obj", points, tiles, ["kirisurf: deployed state", *comments])
    write_obj(to / "contracted.obj", flat, tiles, ["kirisurf: contracted state", *comments])

    vertex, tile, hole = (design.fields(where) for where in ("vertex", "tile", "hole"))
    topology = {
        WELD: tessellation.weld,
        STANDARD_DEPLOYED: tessellation.deployed,
        STANDARD_CONTRACTED: tessellation.contracted,
    }

    def about(state: str, *fields: Mapping[str, Any]) -> dict[str, Any]:
        return described_file(state, set().union(*fields), design.spec.units, design.origin)

    write_vtp(to / "deployed.vtp", points, tiles, vertex, tile, about("deployed", vertex, tile))
    at_flat, on_flat = {**vertex, **topology}, {**tile, CELL: tessellation.cells}
    write_vtp(to / "contracted.vtp", flat, tiles, at_flat, on_flat, about("contracted", at_flat, on_flat))
    write_vtp(to / "holes.vtp", points, tessellation.holes, vertex, hole, about("holes", vertex, hole))
    faces = Loops(np.arange(0, 3 * len(surface.faces) + 1, 3), surface.faces.ravel())
    asked = {} if design.result.feasibility is None else {ASKED_STRETCH: design.result.feasibility.asked}
    at_target = {"normal": surface.normals, **asked}
    write_vtp(to / "target.vtp", surface.vertices, faces, at_target, None, about("target", at_target))
    write_text(to / BLOCKS, vtm_text(RUN_BLOCKS))
    write_text(to / "curvature.csv", curvature_csv(hole))
    write_text(to / "pattern.svg", svg_text(lines, design.spec.units, f"{surface.name}: cut pattern"))


def _comments(design: Finished) -> list[str]:
    unit = design.spec.units or "those of the target"
    lines = [f"units: {unit}"]
    if np.any(design.origin):
        place = " ".join(repr(value) for value in design.origin.tolist())
        lines.append(f"origin: {place} (add it to every vertex for the frame of the target)")
    return lines


def _certificate_of_files(design: Finished, folder: Path) -> Certificate:
    """Certify what was written, not what was meant to be written."""
    deployed, tiles = read_polygons(folder / "deployed.obj")
    contracted, _ = read_polygons(folder / "contracted.obj")
    # Before convergence the copies of a vertex do not coincide: without the welding, every row would only say that.
    weld = None if design.result.fit.status is Status.CONVERGED else design.result.tessellation.weld
    prescribed = design.result.boundary, design.result.contracted_boundary
    openings = design.result.tessellation.has_openings
    return certified(design.spec, deployed, contracted, tiles, design.result.surface, weld, prescribed, openings)


def _result(design: Finished, certificate: Certificate, status: Status, lines: Cuts) -> dict[str, Any]:
    """The record, but for what is known last: exit code, warnings, seconds, hashes."""
    fit, surface, tessellation = design.result.fit, design.result.surface, design.result.tessellation
    failures = " ".join(f"{sentence}." for sentence in certificate.failures)
    return {
        "status": status.name,
        "reason": f"{status.value} {failures}".strip(),
        "certified": certificate.passed,
        "certificate": dict(certificate.rows),
        "certificate_beside": {
            "failures": list(certificate.failures),
            "limits": dict(certificate.limits),
            "pieces": certificate.pieces,
            "flipped": certificate.flipped,
            **certificate.extra,
        },
        "measures": dict(design.measures.numbers),
        "iterations": len(fit.history),
        "history": [dict(step.residuals) for step in fit.history],
        "tiles": tessellation.n_tiles,
        "vertices": tessellation.n_vertices,
        "holes": len(tessellation.holes),
        "slits": len(lines.slits),
        "edge_length": certificate.edge_length,
        "hinge_width": lines.hinge_width,
        "kerf": lines.kerf,
        "units": design.spec.units or "mm (assumed)",
        "origin": design.origin,
        "target": _described(surface),
        "freedom": design.result.freedom,
        "feasibility": _feasibility(design),
        "notes": list(design.result.notes),
    }


def _feasibility(design: Finished) -> dict[str, Any] | None:
    """What was known before the solve, in words and numbers."""
    found = design.result.feasibility
    if found is None:
        return None
    least, most = found.given.ends
    return {
        "sentence": found.sentence,
        "advice": found.advice,
        "least": least,
        "most": most,
        "spread": found.spread,
        "outside": found.outside,
    }


def _publish(design: Finished, result: Mapping[str, Any], to: Path, pictures: bool) -> list[str]:
    """Draw the pictures and write the report; return why there are no pictures, where that needs reading."""
    from kirisurf.publishing import REPORT, THUMBNAIL, draw_pictures, report_parts, sheet, write_report, write_thumbnail

    tessellation, points, flat = design.result.tessellation, design.points, design.flat
    fields = {(where, name): v for where in ("vertex", "tile", "hole") for name, v in design.fields(where).items()}
    drawn: dict[str, Path] = {}
    reason = "Pictures were not asked for."
    warnings: list[str] = []
    write_thumbnail(tessellation, points, to / THUMBNAIL)
    if pictures:
        feasibility = design.result.feasibility
        stretch = None if feasibility is None else (feasibility.asked, feasibility.given.ends)
        shown = sheet(tessellation, points, flat, design.result.surface, fields, design.spec.units, stretch)
        drawn, reason = draw_pictures(shown, to)
        warnings = [reason] if reason else []
    record = {**plain(result), "versions": versions()}
    parts = report_parts(record, flat, fields, drawn, reason, spec=design.spec)
    write_report(parts, to / REPORT)
    return warnings


def _described(surface: Surface) -> Mapping[str, Any]:
    return {
        "name": surface.name,
        "vertices": len(surface.vertices),
        "faces": len(surface.faces),
        "area": surface.area,
        "diagonal": surface.diagonal,
        "smooth": None if surface.smooth is None else surface.smooth.formula,
    }
