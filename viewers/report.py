"""Reports: one self-contained HTML file for a run, or a comparison of several.

Pictures are embedded, nothing is loaded from anywhere and no script runs: the file can be mailed, printed
and kept.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from kirisurf.errors import OutputError, ParameterError
from viewers import charts
from viewers.fields import unit_label
from viewers.number_words import CURVATURE, measures_by_heading
from viewers.parts import (
    CurvatureSummary,
    ReportParts,
    certificate_rows,
    curvature_summary,
    feasibility,
    is_planar,
    passed,
    verdict,
)
from viewers.words import CAPTIONS, PLANAR_CAPTIONS, number, row_in_words

__all__ = ["Picture", "ReportParts", "comparison_html", "embed", "report_html", "write_report"]

_MEDIA = {".png": "image/png", ".svg": "image/svg+xml", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
FIRST_ROWS = 12
_CURVED = ("mean_curvature", "gaussian_curvature")


@dataclass(frozen=True)
class Picture:
    """A picture in the page: a data: address, its caption and the text that stands for it."""

    name: str
    address: str
    caption: str
    wide: bool = False


def write_report(parts: ReportParts | Sequence[ReportParts], path: Path | str) -> Path:
    """Write the report of one run, or the comparison of several, as one HTML file.

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

    html = report_html(parts) if isinstance(parts, ReportParts) else comparison_html(parts)
    write_text(Path(path), html)
    return Path(path)


def report_html(parts: ReportParts) -> str:
    """Return the page of one run; see `write_report`."""
    summary = curvature_summary(parts)
    rows = certificate_rows(parts)
    planar = is_planar(parts)
    return _template("report.html").render(
        parts=parts,
        verdict=verdict(parts),
        passed=passed(parts),
        rows=rows,
        planar=planar,
        feasibility=feasibility(parts),
        pictures=_in_grid(
            [
                _with_share(embed(name, Path(file), planar), summary, parts.units)
                for name, file in _shown(parts.pictures, planar).items()
            ]
        ),
        measures={
            heading: rows
            for heading, rows in measures_by_heading(parts.numbers, parts.units).items()
            if not (planar and heading == CURVATURE)
        },
        charts=[] if planar else _charts(parts),
        summary=summary,
        history=_address("image/svg+xml", charts.residual_history(parts.history).encode()) if parts.history else "",
        table=_table(parts),
        result=parts.result,
    )


def comparison_html(runs: Sequence[ReportParts]) -> str:
    """Return the page that compares several runs, one column each; see `write_report`."""
    runs = tuple(runs)
    if not runs:
        raise ParameterError("report: expected at least one run, got none")
    if len(runs) == 1:
        return report_html(runs[0])
    names = list(dict.fromkeys(name for run in runs for name in run.certificate))
    table = [
        [row_in_words(name, run.certificate.get(name), run.limits.get(name), run.failures) for run in runs]
        for name in names
    ]
    pictures = []
    for run in runs:
        planar = is_planar(run)
        shown = _shown(run.pictures, planar) if planar else run.pictures
        chosen = [name for name in ("deployed", "gaussian_curvature", "overview") if name in shown][:2]
        pictures.append([embed(name, Path(run.pictures[name]), planar) for name in chosen])
    return _template("comparison.html").render(
        runs=runs,
        table=table,
        pictures=pictures,
        verdicts=[verdict(run) for run in runs],
        passed=[passed(run) for run in runs],
        summaries=[curvature_summary(run) for run in runs],
    )


def embed(name: str, file: Path, planar: bool = False) -> Picture:
    """Return a picture file as part of the page.

    Raises
    ------
    ParameterError
        Where the suffix is not .png, .jpg or .svg.
    OutputError
        Where the file cannot be read.
    """
    media = _MEDIA.get(file.suffix.lower())
    if media is None:
        raise ParameterError(f"picture {name}: expected a file of kind {', '.join(_MEDIA)}, got {file.name}")
    try:
        content = file.read_bytes()
    except OSError as problem:
        raise OutputError(f"picture {name}: expected a readable file, got {problem.strerror or problem}") from None
    captions = {**CAPTIONS, **PLANAR_CAPTIONS} if planar else CAPTIONS
    return Picture(name, _address(media, content), captions.get(name, name.replace("_", " ")), name == "overview")


def _shown(pictures: Mapping[str, Path], planar: bool) -> Mapping[str, Path]:
    """The pictures to show: no curvature of a plane, the overview only where it does not repeat what stands below."""
    single = {name: file for name, file in pictures.items() if not (planar and name in _CURVED)}
    alone = {name: file for name, file in single.items() if name != "overview"}
    return alone if len(alone) >= 3 else single


def _in_grid(pictures: list[Picture]) -> list[Picture]:
    """Pictures for a grid of two columns: of an odd number the deployed sheet leads, across both of them."""
    narrow = [picture for picture in pictures if not picture.wide]
    lead = next((picture for picture in narrow if picture.name == "deployed"), None)
    if lead is None or len(narrow) % 2 == 0 or len(narrow) == 1:
        return pictures
    return [replace(lead, wide=True), *(picture for picture in pictures if picture is not lead)]


def _with_share(picture: Picture, summary: CurvatureSummary | None, units: str) -> Picture:
    """Say beside a map of curvature how much of it is the target's and how much the fit's."""
    if summary is None or picture.name not in ("mean_curvature", "gaussian_curvature"):
        return picture
    letter, power = ("H", -1) if picture.name == "mean_curvature" else ("K", -2)
    target, difference = summary.mean if power == -1 else summary.gaussian
    unit = unit_label(power, units)
    share = f" ({100 * difference / target:.2g} %)" if target > 0 else ""
    words = (
        f"{picture.caption} In the median, |{letter}| of the target is {number(target)} {unit}; "
        f"the holes differ from it by {number(difference)} {unit}{share}: that part is the fit."
    )
    return replace(picture, caption=words)


def _address(media: str, content: bytes) -> str:
    return f"data:{media};base64,{base64.b64encode(content).decode('ascii')}"


def _charts(parts: ReportParts) -> list[tuple[str, str]]:
    """Addresses and texts of the curvature charts."""
    out = []
    kinds = (("gaussian_curvature", "Gaussian curvature", -2), ("mean_curvature", "mean curvature", -1))
    for name, label, power in kinds:
        hole, target = parts.fields.get(("hole", name)), parts.fields.get(("hole", f"target_{name}"))
        if hole is None or target is None or not len(hole):
            continue
        flag = np.asarray(parts.fields.get(("hole", "flag"), np.zeros(len(hole))))
        hole, target = np.where(flag == 0, hole, np.nan), np.asarray(target, float)
        unit = unit_label(power, parts.units)
        capital = label[0].upper() + label[1:]
        for svg, words in (
            (charts.curvature_scatter(hole, target, capital, unit), f"{capital} of the holes over that of the target"),
            (charts.curvature_histogram(hole, target, capital, unit), f"How often each {label} occurs"),
        ):
            out.append((_address("image/svg+xml", svg.encode()), words))
    return out


def _table(parts: ReportParts) -> dict[str, Any] | None:
    rows = list(parts.tables.get("curvature", ()))
    if not rows:
        return None
    columns = list(rows[0])
    return {
        "columns": [column.replace("_", " ").replace("gaussian", "Gaussian") for column in columns],
        "rows": [[number(_plain(row.get(column))) for column in columns] for row in rows[:FIRST_ROWS]],
        "total": len(rows),
    }


def _plain(value: object) -> object:
    return value.item() if isinstance(value, np.generic) else value


def _template(name: str) -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("viewers", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = lambda value: number(_plain(value))
    environment.filters["percent"] = lambda value: f"{100 * value:.2g} %"
    environment.filters["unit"] = lambda power, units: unit_label(power, units)
    return environment.get_template(name)
