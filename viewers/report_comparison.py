"""The comparison of several runs: pictures side by side, what differs, and every number with the better one marked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kirisurf.field_units import unit_label
from viewers import charts
from viewers.number_words import measures_by_heading
from viewers.parts import ReportParts, designed_gap, is_planar
from viewers.report_bins import robust_span
from viewers.report_numbers import POWERS, good_curvatures, report_numbers
from viewers.report_page import Picture, chart_picture, embed, formatted, page_template, shower
from viewers.words import CAPTIONS, row_in_words

LOWER = frozenset(
    {
        "distance_rms",
        "distance_max",
        "reach_rms",
        "reach_max",
        "gaussian_curvature_difference_relative",
        "mean_curvature_difference_relative",
        "angle_defect_difference_relative",
        "gauss_image_area_difference_relative",
        "edge_length_spread",
        "tile_area_spread",
        "n_flagged_holes",
        "patch_residual_max",
        "boundary_layer_area",
        "outline_area_difference",
    }
)
"""Where less is better."""

LOWER_ON_ONE_TARGET = frozenset(
    {
        "gaussian_curvature_difference_median",
        "gaussian_curvature_from_fit_median",
        "gaussian_curvature_from_patch_median",
        "mean_curvature_difference_median",
        "mean_curvature_from_fit_median",
        "mean_curvature_from_patch_median",
        "angle_defect_difference_median",
        "gauss_image_area_difference_median",
    }
)
"""The same, of numbers that only compare between designs for one target in one unit."""

HIGHER = frozenset(
    {
        "min_edge",
        "opening_min",
        "coverage",
        "coverage_strict",
        "corner_angle_min",
        "gaussian_curvature_target_share",
        "mean_curvature_target_share",
        "gaussian_curvature_correlation",
        "mean_curvature_correlation",
    }
)
"""Where more is better. Rows of the certificate that must vanish are not ranked: below their limit all is rounding."""

_CARD = ("deployed", "gaussian_curvature", "pattern")
_LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


@dataclass(frozen=True)
class Cell:
    """One cell of the table: markup, its class (pass, fail, unchecked or empty), whether it is the best of its row."""

    value: Any
    kind: str = ""
    is_best: bool = False


@dataclass(frozen=True)
class Row:
    """One line of the table: name, title, unit and a cell for every run."""

    name: str
    title: str
    unit: str
    cells: tuple[Cell, ...]


def comparison_numbers(runs: Sequence[ReportParts]) -> dict[str, Any]:
    """Return what the comparison shows.

    `runs` (the numbers of each run with its letter and seconds), `options` (those that differ), `compares` (one target
    in one unit), `title`, `n_runs`, `n_certified`.
    """
    found = [
        {**report_numbers(run), "letter": _letter(k), "seconds": run.seconds.get("total")} for k, run in enumerate(runs)
    ]
    return {
        "title": _title(runs),
        "n_runs": len(runs),
        "n_certified": sum(run["certified"] for run in found),
        "runs": found,
        "compares": compares(runs),
        "options": differing_options(runs),
    }


def comparison_html(runs: Sequence[ReportParts]) -> str:
    """Return the page that compares several runs, one column each."""
    numbers = comparison_numbers(runs)
    show = shower(numbers)
    return page_template("comparison.html").render(
        runs=runs,
        numbers=numbers,
        show=show,
        cards=[_card(run) for run in runs],
        tables=_tables(runs, numbers, show),
        multiples=_multiples(runs),
        same=numbers["compares"],
        some_stay_open=any(designed_gap(run) is not None for run in runs),
    )


def compares(runs: Sequence[ReportParts]) -> bool:
    """Return whether lengths and curvatures of the runs compare: one target, in one unit."""
    return len({(run.target_name, run.units) for run in runs}) == 1


def differing_options(runs: Sequence[ReportParts]) -> dict[str, list[Any]]:
    """Return the options of the fits that are not the same in all runs: a value for every run, None where not set."""
    names = dict.fromkeys(name for run in runs for name in run.spec)
    values = {name: [run.spec.get(name) for run in runs] for name in names}
    return {name: each for name, each in values.items() if any(value != each[0] for value in each)}


def best_of(name: str, values: Sequence[float | int | None], same: bool) -> set[int]:
    """Return which of the values of a row are the best, to the digits shown; none where all are, or none is better.

    Parameters
    ----------
    name : str
    values : sequence of float or None
    same : bool
        The runs are for one target in one unit.

    Examples
    --------
    >>> best_of("coverage", [0.5, 0.9, None, 0.9001], True), best_of("porosity", [1.0, 2.0], True)
    ({1, 3}, set())
    """
    sign = 1 if name in LOWER or (same and name in LOWER_ON_ONE_TARGET) else -1 if name in HIGHER else 0
    known = [value for value in values if value is not None and np.isfinite(value)]
    if not sign or len(known) < 2:
        return set()
    best = formatted(sign * min(sign * value for value in known))
    found = {k for k, value in enumerate(values) if value is not None and formatted(value) == best}
    return found if len(found) < len(known) else set()


def _tables(runs: Sequence[ReportParts], numbers: dict[str, Any], show: Any) -> dict[str, list[Row]]:
    same = bool(numbers["compares"])

    def row(name: str, title: str, unit: str, *tokens: str, kinds: Sequence[str] = ()) -> Row:
        # what cannot be built is not the best of anything
        best = best_of(name, [_at(run, tokens) if run["certified"] else None for run in numbers["runs"]], same)
        form = "short" if tokens[0] == "certificate" and name not in LOWER | HIGHER else "number"
        shown = [show("runs", k, *tokens, form=form) for k in range(len(numbers["runs"]))]
        cells = [Cell(each, kinds[k] if kinds else "", k in best) for k, each in enumerate(shown)]
        return Row(name, title, unit, tuple(cells))

    tables = {"Design": [row(key, key, "", "design", key) for key in ("tiles", "holes", "iterations")]}
    tables["Design"].append(row("seconds", "seconds", "", "seconds"))
    checks = []
    for name in dict.fromkeys(name for run in runs for name in run.certificate):
        words = [row_in_words(name, run.certificate.get(name), run.limits.get(name), run.failures) for run in runs]
        kinds = [each.verdict for each in words]
        checks.append(row(name, words[0].title, words[0].short_unit, "certificate", name, "value", kinds=kinds))
    tables["Certificate"] = checks
    every = {name: run.numbers[name] for run in runs if not is_planar(run) for name in run.numbers}
    every = {name: run.numbers[name] for run in runs for name in run.numbers} | every
    units = runs[0].units if same or len({run.units for run in runs}) == 1 else "unit"
    for heading, found in measures_by_heading(every, units).items():
        shown = [row(each.name, each.label, each.unit, "measures", each.name, "shown") for each in found]
        shown = [each for each in shown if each.name not in run_names(checks) or heading != "Distance to the target"]
        if shown:
            tables[heading] = shown
    return tables


def run_names(rows: Sequence[Row]) -> set[str]:
    """Return the names of the rows of a table."""
    return {row.name for row in rows}


def _at(document: Any, tokens: Sequence[str]) -> float | int | None:
    for token in tokens:
        document = document.get(token) if isinstance(document, dict) else None
    return document if isinstance(document, (int, float)) and not isinstance(document, bool) else None


def _card(run: ReportParts) -> list[Picture]:
    """Pictures of one run, the overview where it has no others."""
    names = [name for name in _CARD if name in run.pictures and not (is_planar(run) and "curvature" in name)][:2]
    names = names or [name for name in ("overview", *run.pictures) if name in run.pictures][:1]
    return [embed(name, Path(run.pictures[name]), CAPTIONS.get(name, "")) for name in names]


def _multiples(runs: Sequence[ReportParts]) -> list[tuple[str, list[Picture]]]:
    """Scatter and histogram of K for every run that has curvature, on common axes where the runs compare."""
    found = [(k, run, good_curvatures(run, "gaussian_curvature")) for k, run in enumerate(runs)]
    curved = [(k, run, values) for k, run, values in found if values is not None and not is_planar(run)]
    span = None
    if compares(runs) and curved:
        span = robust_span(*(each for _, _, values in curved for each in values))
    rows = []
    for k, run, values in curved:
        unit = unit_label(POWERS["gaussian_curvature"], run.units)
        title = f"{_letter(k)}  {run.title}"
        title = title if len(title) < 30 else f"{title[:28]}\u2026"
        pictures = [
            chart_picture(
                f"scatter_{k}", charts.curvature_scatter(*values, "K", unit, span, title), f"{title}: scatter"
            ),
            chart_picture(f"histogram_{k}", charts.curvature_histogram(*values, "K", unit, span, ""), f"{title}: K"),
        ]
        rows.append((title, pictures))
    return rows


def _title(runs: Sequence[ReportParts]) -> str:
    names = list(dict.fromkeys(run.target_name for run in runs))
    return f"{names[0]}: {len(runs)} designs" if len(names) == 1 else f"{len(runs)} designs for {len(names)} targets"


def _letter(k: int) -> str:
    return _LETTERS[k] if k < len(_LETTERS) else str(k + 1)
