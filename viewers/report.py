"""Reports: one self-contained HTML file for a run, or a comparison of several; or all their numbers as JSON.

Pictures are embedded, nothing is loaded from anywhere and no script runs: the file can be mailed, printed
and kept.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kirisurf.errors import ParameterError
from kirisurf.field_units import unit_label
from viewers import charts
from viewers.number_words import BALANCE, CURVED, measures_by_heading
from viewers.parts import ReportParts, certificate_rows, designed_gap, feasibility, is_planar
from viewers.report_charts import balance_chart, residence_chart
from viewers.report_comparison import comparison_html, comparison_numbers
from viewers.report_facts import facts, largest_differences
from viewers.report_numbers import POWERS, good_curvatures, report_numbers
from viewers.report_page import Picture, chart_picture, embed, page_template, shower
from viewers.words import CAPTIONS, OPEN_CAPTIONS, PLANAR_CAPTIONS

__all__ = ["Picture", "ReportParts", "comparison_html", "embed", "report_html", "report_numbers", "write_report"]

SHEET_PICTURES = ("target", "pattern", "deployed", "asked_stretch")
_DISTANCES = ("distance_rms", "distance_max", "reach_rms", "reach_max", "coverage", "coverage_strict")


def write_report(parts: ReportParts | Sequence[ReportParts], path: Path | str) -> Path:
    """Write the report of one run, or the comparison of several, as one HTML file; or its numbers, by the suffix .json.

    Parameters
    ----------
    parts : ReportParts or sequence of ReportParts
    path : path

    Returns
    -------
    Path

    Raises
    ------
    ParameterError
        Where there is no run to report, or a picture is of an unknown kind.
    OutputError
        Where a picture cannot be read or the file cannot be written.
    """
    from kirisurf.formats.atomic import write_text
    from kirisurf.runs.record import json_text

    runs = (parts,) if isinstance(parts, ReportParts) else tuple(parts)
    if not runs:
        raise ParameterError("report: expected at least one run, got none")
    if Path(path).suffix.lower() == ".json":
        text = json_text(report_numbers(runs[0]) if len(runs) == 1 else comparison_numbers(runs))
    else:
        text = report_html(runs[0]) if len(runs) == 1 else comparison_html(runs)
    write_text(Path(path), text)
    return Path(path)


def report_html(parts: ReportParts) -> str:
    """Return the page of one run; see `write_report`."""
    numbers, planar = report_numbers(parts), is_planar(parts)
    show = shower(numbers)
    pictures = parts.pictures
    captions = _captions(parts, planar)
    rows = certificate_rows(parts)
    distance = [row for row in rows if row.name in _DISTANCES and parts.certificate.get(row.name) is not None]
    return page_template("report.html").render(
        parts=parts,
        numbers=numbers,
        show=show,
        planar=planar,
        facts=facts(parts, numbers, show),
        captions=captions,
        sheet_pictures=_sheet_pictures(pictures, captions),
        no_pictures=_no_pictures(parts),
        map_groups=[] if planar else _map_groups(parts, captions),
        charts=[] if planar else _charts(parts),
        largest=None if planar else largest_differences(numbers, show, parts.units),
        balance_chart=None if planar else _balance(parts),
        residence_chart=_residence(numbers),
        residence_picture=_picture(pictures, "residence", captions),
        residuals_picture=_picture(pictures, "residuals", captions),
        deployment_picture=_deployment_picture(parts),
        distance_picture=_picture(pictures, "distance", captions),
        distance_range=_range_words(numbers["maps"].get("distance")),
        distance_rows=[] if planar else distance,
        rows=rows,
        gap=designed_gap(parts),
        feasibility=_feasibility(parts),
        notes=_notes(parts),
        measures={
            heading: found
            for heading, found in measures_by_heading(parts.numbers, parts.units).items()
            if not (planar and heading in CURVED) and not ("balance" in numbers and heading == BALANCE)
        },
        history=chart_picture("history", charts.residual_history(parts.history), "Residuals over the steps")
        if parts.history
        else None,
    )


def _captions(parts: ReportParts, planar: bool) -> dict[str, str]:
    captions = CAPTIONS | (PLANAR_CAPTIONS if planar else {})
    if designed_gap(parts) is not None:
        captions |= {"pattern": OPEN_CAPTIONS["pattern"]}
        captions |= {} if planar else {"deployed": OPEN_CAPTIONS["deployed"]}
    return captions


def _picture(pictures: Mapping[str, Path], name: str, captions: Mapping[str, str]) -> Picture | None:
    return embed(name, Path(pictures[name]), captions.get(name, "")) if name in pictures else None


def _deployment_picture(parts: ReportParts) -> Picture | None:
    file, words = parts.deployment_picture, "Energy between the flat and the deployed sheet, with the sheet on its way"
    return None if file is None or parts.deployment is None else embed("deployment", file, words)


def _sheet_pictures(pictures: Mapping[str, Path], captions: Mapping[str, str]) -> list[tuple[Picture, str, bool]]:
    """Pictures of target and sheet, with captions; of an odd number the deployed sheet leads, across both columns."""
    known = {"overview", "distance", "residuals", "residence"}
    names = [name for name in SHEET_PICTURES if name in pictures]
    names += [name for name in pictures if name not in names and name not in known and "curvature" not in name]
    if len(names) < 2 and "overview" in pictures:
        names = ["overview", *names]
    wide = names[:1] if names[:1] == ["overview"] else []
    if len(names) > 1 and len(names) % 2 and "deployed" in names and not wide:
        names = ["deployed", *(name for name in names if name != "deployed")]
        wide = names[:1]
    made = [(embed(name, Path(pictures[name]), captions.get(name, "")), name) for name in names]
    return [(picture, captions.get(name, name.replace("_", " ")), name in wide) for picture, name in made]


def _no_pictures(parts: ReportParts) -> str:
    if parts.pictures:
        return ""
    reason = parts.no_pictures or "They were not drawn."
    return f"This report has no pictures. {reason} Where they can be drawn, kirisurf report RUN writes it with them."


def _map_groups(parts: ReportParts, captions: Mapping[str, str]) -> list[dict[str, Any]]:
    """Rows of maps: holes, target, difference."""
    groups = []
    for name, title in (("gaussian_curvature", "Gaussian curvature"), ("mean_curvature", "Mean curvature")):
        keys = [key for key in (name, f"target_{name}", f"{name}_difference") if key in parts.pictures]
        texts = {key: f"Map of {key.replace('_', ' ').replace('gaussian', 'Gaussian')}" for key in keys}
        if keys:
            pictures = [(key, embed(key, Path(parts.pictures[key]), texts[key])) for key in keys]
            groups.append({"title": title, "words": captions[name], "pictures": pictures})
    return groups


def _charts(parts: ReportParts) -> list[Picture]:
    """Scatter and histogram of both curvatures."""
    out = []
    for name, symbol in (("gaussian_curvature", "K"), ("mean_curvature", "H")):
        title = f"{'Gaussian' if symbol == 'K' else 'Mean'} curvature {symbol}"
        values = good_curvatures(parts, name)
        if values is None:
            continue
        unit = unit_label(POWERS[name], parts.units)
        for kind, svg in (
            ("scatter", charts.curvature_scatter(*values, title, unit)),
            ("histogram", charts.curvature_histogram(*values, symbol, unit)),
        ):
            out.append(chart_picture(f"{name}_{kind}", svg, f"{symbol} of the holes and of the target: {kind}"))
    return out


def _balance(parts: ReportParts) -> Picture | None:
    fields = parts.fields
    defects = fields.get(("hole", "angle_defect"))
    target = fields.get(("hole", "target_integrated_gaussian_curvature_cell"))
    if defects is None or target is None or not (np.isfinite(defects) & np.isfinite(target)).any():
        return None
    words = "Angle defect of every cell over the integrated curvature of the target"
    return chart_picture("balance", balance_chart(np.asarray(defects, float), np.asarray(target, float)), words)


def _residence(numbers: Mapping[str, Any]) -> Picture | None:
    shares = numbers.get("residence")
    if shares is None:
        return None
    return chart_picture("residence", residence_chart(shares), "Parts of area and curvature in tiles and in holes")


def _range_words(found: Mapping[str, Any] | None) -> str:
    return f"Range of colors: {found['range'].removeprefix('range: ')}." if found and found["range"] else ""


def _feasibility(parts: ReportParts) -> dict[str, str] | None:
    """What was known before the solve: the advice, and the sentence as it was said where its numbers are not all known.

    Where they are, the page says it with them.
    """
    found = feasibility(parts)
    if found is None:
        return None
    told = parts.result["feasibility"]
    known = all(isinstance(told.get(key), (int, float)) for key in ("least", "most", "spread", "outside"))
    more = [f"What the target asks: {found.asked}."] if found.asked else []
    more += [f"What the tessellation gives: {found.possible}."] if found.possible else []
    more += [f"Part of the target that asks for more or less: {found.outside}."] if found.outside else []
    words = "" if known else " ".join([found.sentence or "It was not said.", *more])
    return {"words": words, "advice": found.advice}


def _notes(parts: ReportParts) -> list[str]:
    """The notes, without what the section on feasibility says already."""
    found = feasibility(parts)
    said = () if found is None else (found.sentence, found.advice, f"{found.sentence} {found.advice}".strip())
    return [sentence for sentence in parts.notes if sentence not in said]
